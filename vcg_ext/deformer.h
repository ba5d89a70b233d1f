// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMER_H
#define VCG_FCD_DEFORMER_H

#include "carrier.h"
#include "deformation_param.h"
#include "given_nodes.h"
#include "graph_parts.h"
#include "graph_deformer.h"
#include "graph_pose.h"
#include "patch_sampling.h"

namespace vcg {
namespace fcd {

namespace detail {

/// D in frame units.
inline double TargetRadius(const SurfaceGraph &surface, const GraphParam &param, double patchRadius) {
    if (param.targetRadius > 0)
        return param.targetRadius / surface.frame.scale;
    const double automatic = patchRadius * std::sqrt(surface.area / param.initialPatches);
    return automatic > 0 ? automatic : surface.averageEdge > 0 ? surface.averageEdge : 1; // no surface
}

/// The patches of the nodes of tag 1 (no tags: of all).
inline Patches Sample(const SurfaceGraph &surface, const std::vector<Index> &tag, const GraphParam &param, double D,
                      const Progress &progress) {
    PatchParam p;
    p.targetRadius = D;
    p.initialPatches = param.initialPatches;
    p.maxIterations = param.maxIterations;
    p.tolerance = param.tolerance;
    p.randomSeed = param.randomSeed;
    static const std::vector<float> none;
    return SamplePatches(surface.graph, tag, param.measure == PatchMeasure::Area ? surface.nodeArea : none, p,
                         progress);
}

} // namespace detail

/// A surface that is prepared to be deformed: built once from the surface and its regions (tags, places of point
/// handles, parameters), it owns patches, graph, factorisation and mapping. Then each pose is solved from the motions
/// alone, and carried to the vertices.
class Deformer : public MovingSurface {
  public:
    using Pose = SurfacePose;

    /// \param surface the free surface without its loose parts, and what holds it
    /// \param slotTag one per vertex slot, noVertex where it is deleted \param point slots of the point handles
    /// \param rest 3 x vertex slots, mesh units
    /// \throw Error nodes that belong elsewhere, or a graph that cannot be factorised \throw Cancelled
    Deformer(SurfaceGraph surface, HeldNodes heldNodes, LooseSurface looseSurface, std::vector<int> slotTag,
             const std::vector<std::size_t> &point, const Eigen::Matrix3Xd &rest, const DeformerParam &param,
             const Progress &progress = {})
        : MovingSurface(std::move(surface), std::move(heldNodes), std::move(looseSurface), std::move(slotTag)),
          point(point), param(param) {
        weights = IsPrinted() ? MappingWeights::Euclidean : param.weights;
        Stopwatch watch;
        for (std::size_t i : point)
            pointRest.emplace_back(rest.col(Eigen::Index(i)));
        center = HandleCenters(this->slotTag, [&](std::size_t i) { return rest.col(Eigen::Index(i)); });
        BuildGraph(rest, progress.Slice(0, 0.7));
        secondsGraph = watch.Seconds();
        watch = {};
        mapping = std::make_unique<GraphMapping>(this->surface.graph, held.tag, patches, graph, weights,
                                                 param.influence, param.shape.runOver * D, progress.Slice(0.7, 0.95),
                                                 param.shape, IsPrinted());
        following = param.looseParts == LooseParts::Follow
                        ? FollowNearest(rest, this->slotTag, this->surface.frame, loose, 2 * D, progress.Slice(0.95, 1))
                        : LooseFollowing{std::vector<std::size_t>(loose.parts, LooseFollowing::none), {}};
        for (std::size_t i : following.leader)
            leaderRest.push_back(i == LooseFollowing::none ? Eigen::Vector3d::Zero()
                                                           : Eigen::Vector3d(rest.col(Eigen::Index(i))));
        FindMoving(point, progress.Slice(1, 1));
        secondsMap = watch.Seconds();
    }

    /// The motions of \p handles at \p percent of their way; its tags are not read, nor which vertices its points are.
    /// \throw Error a motion by more than 1e30 times the mesh, or a target that is not finite
    HeldMotions MotionsOf(const Handles &handles, double percent) const {
        HeldMotions m;
        m.motion[0].setIdentity();
        for (const auto &[tag, middle] : center) {
            const auto given = handles.motion.find(tag);
            const Motion motion = given == handles.motion.end() ? Motion() : given->second;
            m.motion[tag] = handles.ToMesh(motion.At(percent, handles.world * middle));
            detail::ExpectNear(surface.frame, m.motion[tag], "Handle " + std::to_string(tag));
            m.rotates[tag] =
                motion.matrix.topLeftCorner<3, 3>() != Eigen::Matrix3d::Identity() || !motion.turn.isZero(0);
        }
        for (std::size_t i = 0; i < point.size(); ++i) {
            const std::string name = "Point handle " + std::to_string(i + 1);
            if (!handles.point[i].target.allFinite())
                throw Error(name + " has a target that is not finite.");
            Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
            motion.topRightCorner<3, 1>() = (handles.point[i].target - pointRest[i]) * (percent / 100);
            detail::ExpectNear(surface.frame, motion, name);
            (HeldNodes::IsSingle(held.pointTag[i]) ? m.motion[held.pointTag[i]] : m.pointMotion[point[i]]) = motion;
        }
        for (std::size_t s = 0; s < held.original.size(); ++s)
            if (held.original[s] >= 0) {
                m.motion[-1 - Index(s)] = Eigen::Matrix4d(m.motion.at(held.original[s]));
                m.rotates[-1 - Index(s)] = m.rotates[held.original[s]];
            }
        return m;
    }

    /// \param last the pose to go on from, null to begin at rest
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) {
        Pose pose;
        pose.given = std::move(motions);
        for (const auto &each : pose.given.motion)
            pose.motion[each.first] = surface.frame.ToFrame(each.second);
        NodeConstraints given = detail::ConstrainNodes(graph, held.tag, patches, small, pose.given, pose.motion);
        if (!held.original.empty())
            detail::TurnTogether(graph, held.tag, patches, given);
        if (IsPrinted())
            given.turns.assign(given.turns.size(), false);
        if (!parts || given.turns != turns) {
            parts = std::make_unique<PartsDeformer>(graph, nodeArea, given, param.shape.heldDepth);
            turns = given.turns;
        }
        SolverParam steps = solver;
        steps.accelerated = solver.accelerated && !IsPrinted();
        pose.solved = parts->Solve(given, steps, progress, last ? &last->solved : nullptr,
                                   last ? last->nodeMotion : std::vector<Eigen::Affine3d>());
        pose.iterations = pose.solved.iterations;
        pose.graph = pose.solved;
        std::vector<bool> hasMotion(graph.Size());
        for (Index j = 0; j < graph.Size(); ++j)
            hasMotion[j] = given.constrained[j] && !given.turns[j];
        if (!IsPrinted())
            FitLinear(graph, hasMotion, pose.graph, param.shape.openness);
        for (Index j = 0; j < graph.Size(); ++j) {
            const Index t = held.tag[patches.center[j]];
            if (HeldNodes::IsSingle(t) && given.turns[j]) { // run over into the motion that the surface makes there
                Eigen::Affine3d &there = pose.motion[t];
                there.linear() = pose.graph.linear[j];
                there.translation() =
                    pose.graph.position.col(j) - pose.graph.linear[j] * graph.graph.position.col(j).cast<double>();
            }
        }
        pose.nodeMotion = std::move(given.motion);
        return pose;
    }

    /// The pose at param.pose percent of the motions of \p handles, reached from rest in param.steps.
    Pose Solve(const Handles &handles, const DeformationParam &param, const Progress &progress = {}) {
        Pose pose;
        for (int step = 1; step <= param.steps; ++step) {
            const double percent = step == param.steps ? param.pose : param.pose * step / param.steps;
            const int before = pose.iterations;
            pose = Solve(MotionsOf(handles, percent), param, step > 1 ? &pose : nullptr,
                         progress.Slice(double(step - 1) / param.steps, double(step) / param.steps));
            pose.iterations += before;
        }
        return pose;
    }

    std::map<Index, Eigen::Vector3d> center; ///< of each handle tag: the mean of its vertices, mesh units
    Index placedNodes = 0;                   ///< how many of the given nodes lie on the surface, and are used
    double secondsGraph = 0;                 ///< that preparing patches and graph took ...
    double secondsMap = 0;                   ///< ... and the mapping

  private:
    bool IsPrinted() const { return param.graphWeights == GraphWeights::Printed; }

    void BuildGraph(const Eigen::Matrix3Xd &rest, const Progress &progress) {
        D = detail::TargetRadius(surface, param.graph, param.shape.patchRadius);
        if (param.nodes.cols() == 0)
            patches = detail::Sample(surface, held.tag, param.graph, D, progress.Slice(0, 0.9));
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
        graph = MakeDeformationGraph(surface.graph, held.tag, surface.nodeArea, patches, param.graphWeights,
                                     progress.Slice(0.9, 1), param.shape);
        nodeArea.assign(graph.Size(), 0);
        for (Index u = 0; u < surface.graph.Size(); ++u)
            if (patches.patchOf[u] >= 0)
                nodeArea[patches.patchOf[u]] += surface.nodeArea[u];
    }

    std::vector<std::size_t> point;
    std::vector<Eigen::Vector3d> pointRest; // of each point handle, mesh units
    DeformerParam param;
    double D = 0; // frame units
    detail::SmallParts small;
    std::vector<double> nodeArea; // k, frame units^2
    std::vector<bool> turns;      // those that parts is made for
    std::unique_ptr<PartsDeformer> parts;
};

/// Whether the nodes of the deformer's graph are at \p nodes (3 x k, mesh units), but for what files round.
inline bool HasNodes(const Deformer &deformer, const Eigen::Matrix3Xd &nodes) {
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

} // namespace fcd
} // namespace vcg

#endif
