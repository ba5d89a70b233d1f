// SPDX-License-Identifier: GPL-3.0-or-later
// The deformation graph of a region: its number of patches, and the error of its poses.
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/region_deformer.h>
#include <vcg_ext/solve/discretisation_error.h>
#include <vcg_ext/solve/patch_number.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace vcg::fcd {

namespace {

// The most nodes of a region: a pose of so many takes minutes.
constexpr Index mostNodes = 200000;

} // namespace

double RegionDeformer::DiscretisationError(const Pose &pose, const SolverParam &solver,
                                           const Progress &progress) const {
    std::unique_lock<std::mutex> guard(keptLock);
    std::shared_ptr<KeptPose> same;
    if (kept && kept->solver == solver && kept->pose.given == pose.given &&
        kept->pose.solved.position == pose.solved.position && kept->pose.solved.linear == pose.solved.linear)
        same = kept;
    if (same && same->error != -1)
        return same->error;
    guard.unlock();
    NodeConstraints given = ConstraintsOf(pose);
    given.motion = pose.nodeMotion; // the motions of single nodes have become those of the surface around them
    SolverParam steps = solver;
    steps.follow = true;
    const double error = vcg::fcd::DiscretisationError(graph, graph.area, given, pose.solved, param.graphWeights,
                                                       StepsOf(steps), param.shape, progress);
    guard.lock();
    if (same)
        same->error = error;
    return error;
}

void RegionDeformer::MakeGraph(const ReadRegion &read, int count, bool rough, KeptClusters &clusters,
                               const Progress &progress) {
    GraphParam p = param.graph;
    p.initialPatches = count;
    if (rough) // the automatic number shall not depend on the seed
        p.randomSeed = GraphParam().randomSeed;
    latest = nullptr;
    D = vcg::fcd::TargetRadius(surface, p, param.shape.patchRadius);
    if (!read.hasGivenNodes)
        patches = SampleSurface(surface, held.tag, p, D, progress.Slice(0, 0.9), rough, &clusters);
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
    WeighFalloff(graph, PartOfNodes(), param.falloff);
}

std::vector<Index> RegionDeformer::PartOfNodes() const {
    std::vector<Index> part;
    part.reserve(patches.center.size());
    for (Index center : patches.center) { // an open patch around a small held part counts as held
        const Index tag = held.tag[std::size_t(center)], before = held.Original(tag);
        part.push_back(before >= 0 ? before : tag); // a point handle keeps its own tag
    }
    return part;
}

HeldMotions RegionDeformer::Probe(int axis) const {
    const double turn = double(EIGEN_PI) / 3, shift = 0.1; // the turn of one step; a tenth of the diagonal
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    const Eigen::Affine3d move(Eigen::Translation3d(shift * along));
    HeldMotions m;
    m.motion[0].setIdentity();
    for (const auto &[tag, region] : holding) {
        if (tag == 0)
            continue;
        const bool turns = region.count > 1; // single vertices do not turn, nor do point handles
        Eigen::Affine3d moved(turns ? detail::RotationBy(turn, along) : Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
        moved.translation() = region.middle - moved.linear() * region.middle;
        m.motion[tag] = surface.frame.FromFrame(move * moved);
        m.rotates[tag] = turns;
    }
    for (Index tag : held.pointTag)
        m.motion[tag] = surface.frame.FromFrame(move);
    HoldOriginals(m);
    return m;
}

double RegionDeformer::TurnError(const Progress &progress) const {
    std::array<double, 3> error;
    error.fill(std::numeric_limits<double>::quiet_NaN()); // unknown, if it cannot be solved
    const Eigen::Matrix3Xf &rest = graph.graph.position;
    const double diagonal =
        rest.cols() > 0 ? double((rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm()) : 0;
    SolverParam solver;
    solver.tolerance = coarseError / 200; // far below the error of most surfaces
    solver.maxIterations = 100;
    solver.follow = true;
    solver.quasiNewton = false; // the number of patches was chosen by what local and global steps tell
    ParallelTasks(progress, "Estimating the error", error.size(), [&](std::size_t axis, const Progress &each) {
        try {
            const Pose probe = Solve(Probe(int(axis)), solver, nullptr, each.Slice(0, 0.5));
            const double off = DiscretisationError(probe, solver, each.Slice(0.5, 1));
            error[axis] = off > 0 ? off / diagonal : off;
        } catch (const Unsolvable &) { // a later Solve throws it
        }
    });
    double product = 1;
    int told = 0;
    for (double e : error)
        if (e >= 0) {
            product *= e;
            ++told;
        }
    const double mean = product > 0 ? detail::Power(product, 1.0 / std::max(told, 1)) : 0;
    return told > 0 ? mean : std::numeric_limits<double>::quiet_NaN();
}

void RegionDeformer::BuildGraph(const ReadRegion &read, const Progress &progress) {
    KeptClusters clusters;
    if (param.graph.initialPatches > 0 || !beyond.refinement || read.hasGivenNodes || param.graph.targetRadius > 0) {
        MakeGraph(read, param.graph.Patches(), false, clusters, progress);
        reach = D;
        return;
    }
    const auto patchesFor = [&](int made, double error) {
        const int wanted = PatchesFor(made, error);
        isLimited = isLimited || wanted > read.most;
        return std::min(wanted, read.most);
    };
    MakeGraph(read, fewPatches, true, clusters, progress.Slice(0, 0.2));
    const int count = patchesFor(fewPatches, TurnError(progress.Slice(0.2, 0.3)));
    MakeGraph(read, count, false, clusters, progress.Slice(0.3, 0.6));
    reach = D;
    if (count <= believedPatches * fewPatches)
        return;
    const int more = patchesFor(count, TurnError(progress.Slice(0.6, 0.7)));
    if (more > count)
        MakeGraph(read, more, false, clusters, progress.Slice(0.7, 1));
}

} // namespace vcg::fcd
