// SPDX-License-Identifier: GPL-3.0-or-later
// How many patches a deformer's graph has, the graph, and how far off its poses are.
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/deformer.h>
#include <vcg_ext/patches/given_nodes.h>
#include <vcg_ext/solve/discretisation_error.h>
#include <vcg_ext/solve/patch_number.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace vcg {
namespace fcd {

namespace {

// Its systems take some hundred numbers a node, and a pose of so many takes minutes.
constexpr Index mostNodes = 200000;

} // namespace

double Deformer::DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress) const {
    NodeConstraints given = ConstraintsOf(pose);
    given.motion = pose.nodeMotion; // the motions of single nodes have become those of the surface around them
    SolverParam steps = solver;
    steps.follow = true;
    const double error = vcg::fcd::DiscretisationError(graph, nodeArea, given, pose.solved, param.graphWeights,
                                                       StepsOf(steps), param.shape, progress);
    if (!(error > 0)) // also without any nodes
        return error;
    const Eigen::Matrix3Xf &rest = graph.graph.position;
    return error / double((rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm());
}

void Deformer::MakeGraph(const PositionsRef &rest, int count, bool rough, KeptClusters &kept,
                         const Progress &progress) {
    GraphParam p = param.graph;
    p.initialPatches = count;
    if (rough) // asked once for all seeds, so that they have as many
        p.randomSeed = GraphParam().randomSeed;
    latest = nullptr;
    D = TargetRadius(surface, p, param.shape.patchRadius);
    if (param.nodes.cols() == 0)
        patches = SampleSurface(surface, held.tag, p, D, progress.Slice(0, 0.9), rough, &kept);
    else {
        const std::vector<Index> nodes =
            detail::NearestNodes(rest, surface, slotTag, held.tag, param.nodes, placedNodes);
        patches = GrowPatches(surface.graph, held.tag, nodes, progress.Slice(0, 0.9));
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
    holding.clear();
    for (Index j = 0; j < graph.Size(); ++j)
        if (const Index t = held.tag[patches.center[j]];
            t != 1 && (!HeldNodes::IsSingle(t) || held.original[-1 - t] >= 0))
            holding.push_back(HeldNodes::IsSingle(t) ? held.original[-1 - t] : t);
    std::sort(holding.begin(), holding.end());
    holding.erase(std::unique(holding.begin(), holding.end()), holding.end());
    nodeArea.assign(graph.Size(), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (patches.patchOf[u] >= 0)
            nodeArea[patches.patchOf[u]] += surface.nodeArea[u];
}

HeldMotions Deformer::Probe(int axis) const {
    const double turn = double(EIGEN_PI) / 3, way = 0.1; // as far as one step leads; a tenth of the diagonal
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    const Eigen::Affine3d move(Eigen::Translation3d(way * along));
    HeldMotions m;
    m.motion[0].setIdentity();
    for (const auto &[tag, middle] : center) {
        const Eigen::Vector3d about = surface.frame.ToFrame(middle);
        Eigen::Affine3d moved(detail::RotationBy(turn, along));
        moved.translation() = about - moved.linear() * about;
        const bool turns = lone.count(tag) == 0;
        m.motion[tag] = surface.frame.FromFrame(turns ? move * moved : move);
        m.rotates[tag] = turns;
    }
    for (std::size_t i = 0; i < point.size(); ++i)
        MovePoint(m, i, surface.frame.FromFrame(move));
    HoldOriginals(m);
    return m;
}

double Deformer::TurnError(const Progress &progress) const {
    std::array<double, 3> error;
    error.fill(std::numeric_limits<double>::quiet_NaN()); // what cannot be solved cannot be told
    SolverParam solver;
    solver.tolerance = coarseError / 200; // at rest to a small part of what most surfaces are off
    solver.maxIterations = 100;
    solver.follow = true;
    ParallelTasks(progress, "Estimating the error", error.size(), [&](std::size_t axis, const Progress &each) {
        try {
            const Pose probe = Solve(Probe(int(axis)), solver, nullptr, each.Slice(0, 0.5));
            error[axis] = DiscretisationError(probe, solver, each.Slice(0.5, 1));
        } catch (const Unsolvable &) { // said to whoever poses it
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

void Deformer::BuildGraph(const PositionsRef &rest, const Progress &progress) {
    KeptClusters kept;
    if (param.graph.initialPatches > 0 || !beyond.refinement || param.nodes.cols() > 0 ||
        param.graph.targetRadius > 0) {
        MakeGraph(rest, param.graph.Patches(), false, kept, progress);
        return;
    }
    std::map<Index, Index> vertices;
    for (const int tag : slotTag)
        if (tag > 1)
            ++vertices[tag];
    for (const auto &[tag, count] : vertices)
        if (count == 1)
            lone.insert(tag);
    MakeGraph(rest, fewPatches, true, kept, progress.Slice(0, 0.2));
    const int patches = PatchesFor(fewPatches, TurnError(progress.Slice(0.2, 0.3)));
    MakeGraph(rest, patches, false, kept, progress.Slice(0.3, 0.6));
    if (patches <= believedPatches * fewPatches)
        return;
    const int more = PatchesFor(patches, TurnError(progress.Slice(0.6, 0.7)));
    if (more > patches)
        MakeGraph(rest, more, false, kept, progress.Slice(0.7, 1));
}

} // namespace fcd
} // namespace vcg
