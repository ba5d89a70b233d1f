// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/region_deformer.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>
#include <utility>

namespace vcg::fcd {

void DeformationParam::Validate() const {
    graph.Validate();
    if (!(smoothness >= 0) || std::isinf(smoothness))
        throw BadInput("The smoothness must be a finite number, 0 or more; useful are 0.001 to 0.1.");
    if (maxIterations < 1)
        throw BadInput("The maximum number of iterations must be at least 1.");
    if (!(tolerance > 0) || std::isinf(tolerance))
        throw BadInput("The tolerance must be a positive, finite number.");
    if (!(influence > 1) || std::isinf(influence))
        throw BadInput("The influence must be a finite number above 1: each node has to reach beyond its own patch.");
    if (!(rigidity >= 0 && rigidity <= 1))
        throw BadInput("The rigidity must be from 0 to 1.");
    if (rigidity > 0.999 && rigidity < 1) // each step would be a thousandth of the way to rest
        throw BadInput("A rigidity between 0.999 and 1 hardly comes to rest. Take 1, which is solved otherwise, or "
                       "0.999.");
    if (rigidity < 1 && elastic)
        throw BadInput("A rigidity below 1 lets the surface stretch, and elastic keeps its volume; take one of them.");
    if (rigidity < 1 && graphWeights == GraphWeights::Printed)
        throw BadInput("A rigidity below 1 does not go with the method as printed; take other graph weights.");
    if (!std::isfinite(pose))
        throw BadInput("The pose must be a finite number of percent.");
    if (steps < 1 || steps > 1000)
        throw BadInput("The pose can be reached in 1 to 1000 steps.");
    if (!(weldDistance >= 0 && float(weldDistance) <= 1e-3f)) // hosts give it in single precision
        throw BadInput("The weld distance must be from 0 to 0.001 (of the bounding box diagonal).");
}

RegionDeformer::RegionDeformer(ReadRegion read, const DeformerParam &param, std::vector<Index> &nodeOf,
                               const Progress &progress)
    : MovingRegion(std::move(read.surface), std::move(read.held), read.first), askedPatches(param.graph.initialPatches),
      most(read.most), point(std::move(read.point)), param(param), beyond(param.graphWeights) {
    this->param.nodes = {};
    weights = beyond.surfaceBalls ? param.weights : MappingWeights::Euclidean;
    nodeOf = std::move(surface.nodeOf);
    FindHolding();
    BuildGraph(read, progress.Slice(0, 0.7));
    mapping =
        std::make_unique<GraphMapping>(surface.graph, held.tag, patches, graph, weights, param.influence,
                                       param.shape.blendWidth * D, progress.Slice(0.7, 0.95), param.shape, beyond);
    if (param.elastic) {
        volume = std::make_unique<const KeptVolume>(read.faces, surface.graph, held.tag, patches);
        surface.report.unenclosed = volume->Open();
    }
    ListVertices(nodeOf, progress.Slice(0.95, 1));
    surface.slots = {};
    const auto toMesh = [&](std::uint32_t &slot) { slot = read.slotOf[slot]; };
    if (!read.slotOf.empty())
        for (std::vector<Bent> *list : {&bent, &beside})
            for (Bent &vertex : *list)
                toMesh(vertex.slot);
}

void RegionDeformer::FindHolding() {
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (const Index tag = held.Original(held.tag[std::size_t(u)]); tag != 1 && tag >= 0) {
            Holding &one = holding[tag];
            one.middle += surface.graph.position.col(u).cast<double>();
            ++one.count;
        }
    for (auto &each : holding)
        each.second.middle /= each.second.count;
}

HeldMotions RegionDeformer::OwnOf(const HeldMotions &all) const {
    HeldMotions m;
    m.motion[0].setIdentity();
    const auto take = [](const auto &from, Index tag, auto &to) {
        if (const auto found = from.find(tag); found != from.end())
            to[tag] = found->second;
    };
    for (const auto &each : holding) {
        const Index tag = each.first;
        m.motion[tag] = all.motion.at(tag);
        take(all.rotates, tag, m.rotates);
        take(all.turn, tag, m.turn);
    }
    for (std::size_t i = 0; i < point.size(); ++i)
        m.motion[held.pointTag[i]] = all.pointMotion.at(point[i]);
    HoldOriginals(m);
    return m;
}

void RegionDeformer::HoldOriginals(HeldMotions &m) const {
    for (std::size_t s = 0; s < held.original.size(); ++s)
        if (held.original[s] >= 0) {
            m.motion[-1 - Index(s)] = Eigen::Matrix4d(m.motion.at(held.original[s]));
            if (const auto turns = m.rotates.find(held.original[s]); turns != m.rotates.end())
                m.rotates[-1 - Index(s)] = bool(turns->second);
        }
}

NodeConstraints RegionDeformer::ConstraintsOf(const Pose &pose) const {
    NodeConstraints given = detail::ConstrainNodes(graph, held.tag, patches, small, pose.given, pose.motion);
    if (!held.original.empty())
        detail::TurnTogether(graph, held.tag, patches, given);
    if (!beyond.compliance)
        given.compliant.assign(given.compliant.size(), false);
    return given;
}

SolverParam RegionDeformer::StepsOf(SolverParam solver) const {
    solver.accelerated = solver.accelerated && beyond.acceleration;
    solver.follow = solver.follow && beyond.steps;
    return solver;
}

RegionPose RegionDeformer::Solve(HeldMotions motions, const SolverParam &solver, const Pose *last,
                                 const Progress &progress) const {
    Pose pose;
    pose.given = std::move(motions);
    for (const auto &each : pose.given.motion)
        pose.motion[each.first] = surface.frame.ToFrame(each.second);
    NodeConstraints given = ConstraintsOf(pose);
    const SolverParam steps = StepsOf(solver);
    const std::shared_ptr<const System> system = SystemOf(given, steps, progress.Slice(0, 0));
    pose.solved = system->parts.Solve(given, steps, progress, last ? &last->solved : nullptr,
                                      last ? last->nodeMotion : std::vector<Eigen::Affine3d>());
    pose.iterations = pose.solved.iterations;
    pose.graph = pose.solved;
    std::vector<bool> hasMotion(graph.Size());
    for (Index j = 0; j < graph.Size(); ++j)
        hasMotion[j] = given.constrained[j] && !given.compliant[j];
    const auto fit = [&](GraphPose &fitted) {
        if (beyond.linearMaps && !fitted.affine)
            FitLinear(graph, hasMotion, fitted, param.shape.openness);
    };
    if (volume && !pose.graph.affine) // affine maps stretch on purpose
        pose.volumeOff = volume->Keep(graph, system->parts, *mapping, pose.motion, fit, pose.graph);
    fit(pose.graph);
    for (Index j = 0; j < graph.Size(); ++j) {
        const Index t = held.tag[patches.center[j]];
        if (HeldNodes::IsSingle(t) && given.compliant[j]) { // the blend runs over into the surface's own motion there
            Eigen::Affine3d &there = pose.motion[t];
            there.linear() = pose.graph.linear[j];
            there.translation() =
                pose.graph.position.col(j) - pose.graph.linear[j] * graph.graph.position.col(j).cast<double>();
        }
    }
    pose.nodeMotion = std::move(given.motion);
    return pose;
}

RegionPose RegionDeformer::SolveAlong(const Path &path, const SolverParam &solver, int least, const Pose *begin,
                                      const Progress &progress) const {
    HeldMotions end = path(1, 1);
    const bool followsPath = beyond.steps && solver.rigidity > 0; // at 0, the pose does not depend on the path
    const int turns = followsPath ? StepsTo(end, begin ? &begin->given : nullptr) : 1, steps = std::max(least, turns);
    std::vector<HeldMotions> motions;
    for (int step = 1; step < steps; ++step)
        motions.push_back(path(step, steps));
    motions.push_back(std::move(end));
    if (!begin) {
        const std::lock_guard<std::mutex> guard(keptLock);
        if (kept && kept->solver == solver && kept->path == motions)
            return kept->pose;
    }
    SolverParam last = solver;
    last.follow = true;
    // After a large turn, a quasi-Newton step may be so long that the shape lets go of a full turn.
    last.quasiNewton = last.quasiNewton && turns == 1;
    // On the path of a large turn: for each 60 degrees, so few iterations bring stiff parts to rest, but buckling,
    // which begins slowly, does not begin. 4 to 8 end in the same shape.
    const int few = 6;
    SolverParam passing = last;
    if (turns > 1) {
        passing.follow = false;
        passing.maxIterations = std::min(solver.maxIterations, (few * turns + steps - 1) / steps);
    }
    Pose pose;
    for (int step = 1; step <= steps; ++step) {
        const bool isLast = step == steps, hasJumped = pose.path.jumps;
        Pose next = Solve(motions[std::size_t(step) - 1], isLast ? last : passing, step > 1 ? &pose : begin,
                          progress.Slice(double(step - 1) / steps, double(step) / steps));
        next.iterations += pose.iterations;
        pose = std::move(next);
        pose.path = {steps, hasJumped || !pose.solved.followed, pose.solved.unstable};
    }
    if (!begin) {
        auto found = std::make_shared<KeptPose>(KeptPose{solver, std::move(motions), pose, -1});
        const std::lock_guard<std::mutex> guard(keptLock);
        kept = std::move(found);
    }
    return pose;
}

std::shared_ptr<const RegionPose> RegionDeformer::Kept(const HeldMotions &motions) const {
    const std::lock_guard<std::mutex> guard(keptLock);
    if (!kept || !(kept->path.back() == motions))
        return nullptr;
    return {kept, &kept->pose};
}

int RegionDeformer::StepsTo(const HeldMotions &motions, const HeldMotions *begin) const {
    // Each tag turns about its axis at an even rate, so two of them turn against each other by no more than the
    // difference of their rates.
    std::set<std::array<double, 3>> rates;
    for (const auto &each : holding) {
        const Eigen::Vector3d &turn = motions.turn.at(each.first);
        const Eigen::Vector3d rate = begin ? Eigen::Vector3d(turn - begin->turn.at(each.first)) : turn;
        rates.insert({rate[0], rate[1], rate[2]});
    }
    double turn = 0;
    if (rates.size() <= 1000) {
        for (auto a = rates.begin(); a != rates.end(); ++a)
            for (auto b = rates.begin(); b != a; ++b)
                turn = std::max(
                    turn, (Eigen::Map<const Eigen::Vector3d>(a->data()) - Eigen::Map<const Eigen::Vector3d>(b->data()))
                              .norm());
    } else { // an upper bound
        Eigen::AlignedBox3d box;
        for (const std::array<double, 3> &rate : rates)
            box.extend(Eigen::Map<const Eigen::Vector3d>(rate.data()));
        turn = box.diagonal().norm();
    }
    const double steps = std::ceil(turn / (double(EIGEN_PI) / 3) - 1e-6); // 60 degrees are one step, to rounding
    return int(std::min(std::max(steps, 1.0), 1000.0));
}

RegionDeformer::System::System(const RegionDeformer &deformer, const NodeConstraints &given, const SolverParam &solver,
                               const Progress &progress)
    : compliant(given.compliant), solver(solver),
      parts(deformer.graph, deformer.graph.area, given, deformer.param.shape.heldDepth, progress, solver) {}

bool RegionDeformer::System::Serves(const NodeConstraints &given, const SolverParam &wanted) const {
    const bool needsSmoothness = wanted.rigidity < 1 || wanted.IsQuasiNewton();
    return compliant == given.compliant && solver.rigidity == wanted.rigidity &&
           (!needsSmoothness ||
            (solver.smoothness == wanted.smoothness && solver.IsQuasiNewton() == wanted.IsQuasiNewton()));
}

std::shared_ptr<const RegionDeformer::System>
RegionDeformer::SystemOf(const NodeConstraints &given, const SolverParam &solver, const Progress &progress) const {
    std::unique_lock<std::mutex> guard(lock, std::defer_lock);
    while (!guard.try_lock()) { // another thread is about to make it
        progress(0, "Deforming the graph");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (!latest || !latest->Serves(given, solver))
        latest = std::make_shared<const System>(*this, given, solver, progress);
    return latest;
}

} // namespace vcg::fcd
