// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/deformer.h>
#include <vcg_ext/surface/part_removal.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <utility>

namespace vcg {
namespace fcd {

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
    if (!std::isfinite(pose))
        throw BadInput("The pose must be a finite number of percent.");
    if (steps < 1 || steps > 1000)
        throw BadInput("The pose can be reached in 1 to 1000 steps.");
    if (!(weldDistance >= 0 && float(weldDistance) <= 1e-3f)) // hosts give it in single precision
        throw BadInput("The weld distance must be from 0 to 0.001 (of the bounding box diagonal).");
}

Deformer::Deformer(SurfaceGraph surface, HeldNodes heldNodes, LooseSurface looseSurface, std::vector<int> slotTag,
                   const std::vector<std::size_t> &point, const PositionsRef &rest, const DeformerParam &param,
                   const Progress &progress)
    : MovingSurface(std::move(surface), std::move(heldNodes), std::move(looseSurface), std::move(slotTag)),
      point(point), param(param), beyond(param.graphWeights) {
    weights = beyond.surfaceBalls ? param.weights : MappingWeights::Euclidean;
    Stopwatch watch;
    for (std::size_t i : point)
        pointRest.emplace_back(rest.col(Eigen::Index(i)));
    center = HandleCenters(this->slotTag, [&](std::size_t i) { return rest.col(Eigen::Index(i)); });
    BuildGraph(rest, progress.Slice(0, 0.7));
    secondsGraph = watch.Seconds();
    watch = {};
    mapping =
        std::make_unique<GraphMapping>(this->surface.graph, held.tag, patches, graph, weights, param.influence,
                                       param.shape.blendWidth * D, progress.Slice(0.7, 0.95), param.shape, beyond);
    following = param.looseParts == LooseParts::Follow
                    ? FollowNearest(rest, this->slotTag, this->surface.frame, loose, 2 * D, progress.Slice(0.95, 1))
                    : LooseFollowing{std::vector<std::size_t>(loose.parts, LooseFollowing::none), {}, {}};
    for (std::size_t i : following.leader)
        leaderRest.push_back(i == LooseFollowing::none ? Eigen::Vector3d::Zero()
                                                       : Eigen::Vector3d(rest.col(Eigen::Index(i))));
    FindMoving(point, progress.Slice(1, 1));
    secondsMap = watch.Seconds();
}

HeldMotions Deformer::MotionsOf(const Handles &handles, double percent) const {
    assert(handles.point.size() == point.size());
    HeldMotions m;
    m.motion[0].setIdentity();
    m.turn[0].setZero();
    for (const auto &[tag, middle] : center) {
        const auto given = handles.motion.find(tag);
        const Motion motion = given == handles.motion.end() ? Motion() : given->second;
        m.motion[tag] = handles.ToMesh(motion.At(percent, handles.world * middle));
        detail::ExpectNear(surface.frame, m.motion[tag], "Handle " + std::to_string(tag));
        m.rotates[tag] = motion.Turns();
        m.turn[tag] = motion.Rotation() * (percent / 100);
    }
    for (std::size_t i = 0; i < point.size(); ++i) {
        const std::string name = "Point handle " + std::to_string(i + 1);
        if (!handles.point[i].target.allFinite())
            throw BadInput(name + " has a target that is not finite.");
        Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
        motion.topRightCorner<3, 1>() = (handles.point[i].target - pointRest[i]) * (percent / 100);
        detail::ExpectNear(surface.frame, motion, name);
        MovePoint(m, i, motion);
    }
    HoldOriginals(m);
    return m;
}

void Deformer::MovePoint(HeldMotions &m, std::size_t i, const Eigen::Matrix4d &motion) const {
    (HeldNodes::IsSingle(held.pointTag[i]) ? m.motion[held.pointTag[i]] : m.pointMotion[point[i]]) = motion;
}

void Deformer::HoldOriginals(HeldMotions &m) const {
    for (std::size_t s = 0; s < held.original.size(); ++s)
        if (held.original[s] >= 0) {
            m.motion[-1 - Index(s)] = Eigen::Matrix4d(m.motion.at(held.original[s]));
            m.rotates[-1 - Index(s)] = m.rotates[held.original[s]];
        }
}

NodeConstraints Deformer::ConstraintsOf(const Pose &pose) const {
    NodeConstraints given = detail::ConstrainNodes(graph, held.tag, patches, small, pose.given, pose.motion);
    if (!held.original.empty())
        detail::TurnTogether(graph, held.tag, patches, given);
    if (!beyond.compliance)
        given.compliant.assign(given.compliant.size(), false);
    return given;
}

SolverParam Deformer::StepsOf(SolverParam solver) const {
    solver.accelerated = solver.accelerated && beyond.acceleration;
    solver.follow = solver.follow && beyond.steps;
    return solver;
}

Deformer::Pose Deformer::Solve(HeldMotions motions, const SolverParam &solver, const Pose *last,
                               const Progress &progress) const {
    Pose pose;
    pose.given = std::move(motions);
    for (const auto &each : pose.given.motion)
        pose.motion[each.first] = surface.frame.ToFrame(each.second);
    NodeConstraints given = ConstraintsOf(pose);
    const std::shared_ptr<const System> system = SystemOf(given, progress.Slice(0, 0));
    pose.solved = system->parts.Solve(given, StepsOf(solver), progress, last ? &last->solved : nullptr,
                                      last ? last->nodeMotion : std::vector<Eigen::Affine3d>());
    pose.iterations = pose.solved.iterations;
    pose.graph = pose.solved;
    std::vector<bool> hasMotion(graph.Size());
    for (Index j = 0; j < graph.Size(); ++j)
        hasMotion[j] = given.constrained[j] && !given.compliant[j];
    if (beyond.linearMaps)
        FitLinear(graph, hasMotion, pose.graph, param.shape.openness);
    for (Index j = 0; j < graph.Size(); ++j) {
        const Index t = held.tag[patches.center[j]];
        if (HeldNodes::IsSingle(t) && given.compliant[j]) { // run over into the motion that the surface makes there
            Eigen::Affine3d &there = pose.motion[t];
            there.linear() = pose.graph.linear[j];
            there.translation() =
                pose.graph.position.col(j) - pose.graph.linear[j] * graph.graph.position.col(j).cast<double>();
        }
    }
    pose.nodeMotion = std::move(given.motion);
    return pose;
}

Deformer::Pose Deformer::Solve(const Handles &handles, const DeformationParam &param, const Progress &progress) const {
    const auto way = [&](int step, int steps) {
        return MotionsOf(handles, step == steps ? param.pose : param.pose * step / steps);
    };
    return SolveAlong(way, param, nullptr, progress);
}

Deformer::Pose Deformer::SolveAlong(const Way &way, const DeformationParam &param, const Pose *begin,
                                    const Progress &progress) const {
    HeldMotions motions = way(1, 1);
    const int turns = beyond.steps ? StepsTo(motions, begin ? &begin->given : nullptr) : 1,
              steps = std::max(param.steps, turns);
    SolverParam last = param;
    last.follow = true;
    // On the way of a large turn, so few iterations for each 60 degrees of it bring what is stiff to rest, while the
    // ways in which the shape might give way, which begin slowly, do not begin. 4 to 8 end in the same shape.
    const int few = 6;
    SolverParam passing = last;
    if (turns > 1) {
        passing.follow = false;
        passing.maxIterations = std::min(param.maxIterations, (few * turns + steps - 1) / steps);
    }
    Pose pose;
    for (int step = 1; step <= steps; ++step) {
        const bool isLast = step == steps, hasJumped = pose.way.jumps;
        if (steps > 1)
            motions = way(step, steps);
        Pose next = Solve(motions, isLast ? last : passing, step > 1 ? &pose : begin,
                          progress.Slice(double(step - 1) / steps, double(step) / steps));
        next.iterations += pose.iterations;
        pose = std::move(next);
        pose.way = {steps, hasJumped || !pose.solved.followed, pose.solved.unstable};
    }
    return pose;
}

int Deformer::StepsTo(const HeldMotions &motions, const HeldMotions *begin) const {
    // Each turns about its axis at an even rate: what they turn against each other grows by no more than the
    // difference of these rates.
    std::set<std::array<double, 3>> rates;
    for (Index tag : holding) {
        const Eigen::Vector3d &turn = motions.turn.at(tag);
        const Eigen::Vector3d rate = begin ? Eigen::Vector3d(turn - begin->turn.at(tag)) : turn;
        rates.insert({rate[0], rate[1], rate[2]});
    }
    double turn = 0;
    if (rates.size() <= 1000) {
        for (auto a = rates.begin(); a != rates.end(); ++a)
            for (auto b = rates.begin(); b != a; ++b)
                turn = std::max(
                    turn, (Eigen::Map<const Eigen::Vector3d>(a->data()) - Eigen::Map<const Eigen::Vector3d>(b->data()))
                              .norm());
    } else { // no less than that
        Eigen::AlignedBox3d box;
        for (const std::array<double, 3> &rate : rates)
            box.extend(Eigen::Map<const Eigen::Vector3d>(rate.data()));
        turn = box.diagonal().norm();
    }
    const double steps = std::ceil(turn / (double(EIGEN_PI) / 3) - 1e-6); // 60 degrees are one step, to rounding
    return int(std::min(std::max(steps, 1.0), 1000.0));
}

Deformer::System::System(const Deformer &deformer, const NodeConstraints &given, const Progress &progress)
    : compliant(given.compliant),
      parts(deformer.graph, deformer.nodeArea, given, deformer.param.shape.heldDepth, progress) {}

std::shared_ptr<const Deformer::System> Deformer::SystemOf(const NodeConstraints &given,
                                                           const Progress &progress) const {
    std::unique_lock<std::mutex> guard(lock, std::defer_lock);
    while (!guard.try_lock()) { // another thread is about to make it
        progress(0, "Deforming the graph");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (!latest || latest->compliant != given.compliant)
        latest = std::make_shared<const System>(*this, given, progress);
    return latest;
}

bool HasNodes(const Deformer &deformer, const Eigen::Matrix3Xd &nodes) {
    const Frame &frame = deformer.surface.frame;
    if (nodes.cols() != deformer.graph.Size())
        return false;
    for (Index j = 0; j < deformer.graph.Size(); ++j) {
        const Eigen::Vector3d own = deformer.surface.graph.position.col(deformer.patches.center[j]).cast<double>();
        const Eigen::Vector3d p = nodes.col(j);
        if (!((frame.ToFrame(p) - own).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= defaultWeldDistance))
            return false;
    }
    return true;
}

TagCount CountHandles(const Handles &handles, std::size_t slots, const char *deleted, unsigned threads) {
    ExpectTags(handles.tag, slots);
    TagCount tags = CountTags(handles.tag, deleted, threads);
    tags.handle += Index(handles.point.size());
    tags.free -= Index(handles.point.size());
    if (tags.handle == 0)
        throw BadInput("There is no handle: no vertex has a tag of 2 or more. Mark the part to move with tag 2.");
    if (tags.free <= 0)
        throw BadInput("There is nothing to deform: no vertex is free. Mark the part that may bend with tag 1.");
    return tags;
}

std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress) {
    assert(handles.tag.size() == mesh.vertexSlots);
    std::vector<std::size_t> point;
    for (const PointHandle &p : handles.point) {
        if (p.vertex >= mesh.vertexSlots || mesh.IsDeleted(p.vertex))
            throw BadInput("Point handle " + std::to_string(point.size() + 1) + " is at vertex " +
                           std::to_string(p.vertex) + ", which does not exist.");
        point.push_back(p.vertex);
    }
    std::vector<int> slotTag;
    AssignLarge(slotTag, mesh.vertexSlots, 0);
    ParallelFor(progress.threads, mesh.vertexSlots, 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            slotTag[i] = mesh.IsDeleted(i) ? noVertex : std::max(-1, handles.tag[i]);
    });
    const Eigen::Matrix3d metric = handles.world.linear();
    SurfaceGraph surface = ReadFreeSurface(mesh, handles.tag, {}, metric, progress.Slice(0, 0.25), param.weldDistance);
    HeldNodes held = HoldNodes(surface, slotTag, point, progress.Slice(0.25, 0.25));
    const double patch = surface.area / param.graph.Patches();
    LooseSurface loose = FindLoose(slotTag, point, surface, held.tag, progress.Slice(0.25, 0.3),
                                   param.bendsUnheld ? patch : std::numeric_limits<double>::infinity());
    if (loose.isPartOfSurface) {
        if (!RemoveParts(mesh, loose.partOf, progress.Slice(0.3, 0.3), surface))
            surface =
                ReadFreeSurface(mesh, handles.tag, loose.partOf, metric, progress.Slice(0.3, 0.4), param.weldDistance);
        held = HoldNodes(surface, slotTag, point, progress.Slice(0.4, 0.4));
    }
    surface.componentOf = std::vector<Index>(); // as large as the surface, and not needed any more
    return std::make_unique<Deformer>(std::move(surface), std::move(held), std::move(loose), std::move(slotTag), point,
                                      mesh.Positions(), param, progress.Slice(0.4, 1));
}

} // namespace fcd
} // namespace vcg
