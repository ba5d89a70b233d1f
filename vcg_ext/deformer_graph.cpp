// SPDX-License-Identifier: GPL-3.0-or-later
// How many patches a region's graph has, the graph, and how far off its poses are.
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/region_deformer.h>
#include <vcg_ext/solve/discretisation_error.h>

#include <algorithm>
#include <array>
#include <string>

namespace vcg {
namespace fcd {

namespace {

// So many times the patches: the error falls eightfold, with their number to the power of 3 / 4 (DiscretisationError).
// That is what an estimate which is low by three, as it may be where the surface is thin or torn, leaves room for.
constexpr int finer = 16;
// Its systems take some hundred numbers a node, and a pose of so many takes minutes.
constexpr Index mostNodes = 200000;

} // namespace

double RegionDeformer::DiscretisationError(const Pose &pose, const SolverParam &solver,
                                           const Progress &progress) const {
    std::shared_ptr<const KeptPose> same;
    {
        const std::lock_guard<std::mutex> guard(lock);
        if (kept && kept->solver == solver && kept->pose.given == pose.given &&
            kept->pose.solved.position == pose.solved.position && kept->pose.solved.linear == pose.solved.linear)
            same = kept;
    }
    if (same && same->error != -1)
        return same->error;
    NodeConstraints given = ConstraintsOf(pose);
    given.motion = pose.nodeMotion; // the motions of single nodes have become those of the surface around them
    SolverParam steps = solver;
    steps.follow = true;
    const double error = vcg::fcd::DiscretisationError(graph, nodeArea, given, pose.solved, param.graphWeights,
                                                       StepsOf(steps), param.shape, progress);
    if (same) {
        auto known = std::make_shared<KeptPose>(*same);
        known->error = error;
        const std::lock_guard<std::mutex> guard(lock);
        if (kept == same)
            kept = std::move(known);
    }
    return error;
}

double DiagonalOf(const DeformationGraph &graph) {
    const Eigen::Matrix3Xf &rest = graph.graph.position;
    return rest.cols() > 0 ? double((rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm()) : 0;
}

void RegionDeformer::MakeGraph(const ReadRegion &read, const Progress &progress) {
    D = vcg::fcd::TargetRadius(surface, param.graph, param.shape.patchRadius);
    if (!read.hasGivenNodes)
        patches = SampleSurface(surface, held.tag, param.graph, D, progress.Slice(0, 0.9));
    else {
        patches = GrowPatches(surface.graph, held.tag, read.center, progress.Slice(0, 0.9));
        D = 0;
        for (float radius : patches.radius)
            D = std::max(D, double(radius));
    }
    small = detail::FindSmallParts(surface.graph, held.tag, D, param.shape);
    detail::OpenSmallParts(surface.graph, held.tag, small, patches, progress.Slice(0.9, 0.9));
    AddHeldPatches(surface.graph, held.tag, patches, progress.Slice(0.9, 0.9));
    if (patches.Size() > mostNodes)
        throw BadInput("The deformation graph would have " + std::to_string(patches.Size()) + " nodes; " +
                       std::to_string(mostNodes) +
                       " are the most. Raise the target radius or take fewer patches, and " +
                       "hold regions rather than many single vertices.");
    graph = MakeDeformationGraph(surface.graph, held.tag, surface.nodeArea, patches, param.graphWeights,
                                 progress.Slice(0.9, 1), param.shape);
    nodeArea.assign(graph.Size(), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (patches.patchOf[u] >= 0)
            nodeArea[patches.patchOf[u]] += surface.nodeArea[u];
}

HeldMotions RegionDeformer::Probe(int axis) const {
    const double turn = double(EIGEN_PI) / 3, way = 0.1; // as far as one step leads; a tenth of the diagonal
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    const Eigen::Affine3d move(Eigen::Translation3d(way * along));
    HeldMotions m;
    m.motion[0].setIdentity();
    for (const auto &[tag, about] : holding) {
        if (tag == 0)
            continue;
        Eigen::Affine3d moved(detail::RotationBy(turn, along));
        moved.translation() = about - moved.linear() * about;
        m.motion[tag] = surface.frame.FromFrame(move * moved);
        m.rotates[tag] = true;
    }
    for (Index tag : held.pointTag)
        m.motion[tag] = surface.frame.FromFrame(move);
    HoldOriginals(m);
    return m;
}

double RegionDeformer::TurnError(const Progress &progress) const {
    std::array<double, 3> error{};
    const double diagonal = DiagonalOf(graph);
    SolverParam solver;
    solver.tolerance = coarseError / 200; // at rest to a twentieth of what is looked for
    solver.maxIterations = 100;
    solver.follow = true;
    ParallelTasks(progress, "Estimating the error", error.size(), [&](std::size_t axis, const Progress &each) {
        try {
            const Pose probe = Solve(Probe(int(axis)), solver, nullptr, each.Slice(0, 0.5));
            error[axis] = DiscretisationError(probe, solver, each.Slice(0.5, 1)) / diagonal;
        } catch (const Unsolvable &) { // for whoever poses it
        }
    });
    double most = 0;
    for (double e : error)
        most = e > most ? e : most; // not a number: it cannot be told
    return most;
}

void RegionDeformer::BuildGraph(const ReadRegion &read, const Progress &progress) {
    if (param.graph.initialPatches > 0 || !beyond.refinement || read.hasGivenNodes || param.graph.targetRadius > 0) {
        MakeGraph(read, progress);
        return;
    }
    // Whether so few are enough is asked once for all seeds: shapes of few and of many patches may differ by more than
    // those of two seeds.
    const unsigned seed = param.graph.randomSeed;
    param.graph.randomSeed = GraphParam().randomSeed;
    MakeGraph(read, progress.Slice(0, 0.3));
    const bool isCoarse = TurnError(progress.Slice(0.3, 0.4)) > coarseError;
    if (!isCoarse && seed == param.graph.randomSeed)
        return;
    if (isCoarse)
        param.graph.initialPatches = finer * param.graph.Patches();
    param.graph.randomSeed = seed;
    latest = nullptr;
    MakeGraph(read, progress.Slice(0.4, 1));
}

} // namespace fcd
} // namespace vcg
