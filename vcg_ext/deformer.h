// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMER_H
#define VCG_FCD_DEFORMER_H

#include "deformation_param.h"
#include "given_nodes.h"
#include "graph_mapping.h"
#include "graph_parts.h"
#include "graph_pose.h"
#include "held_nodes.h"
#include "loose_parts.h"
#include "patch_sampling.h"
#include "rotation_fit.h"

#include <utility>

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
class Deformer {
  public:
    /// One pose.
    struct Pose {
        HeldMotions given;
        GraphPose solved;                        ///< of the graph
        GraphPose graph;                         ///< the same with linear maps (FitLinear)
        std::vector<Eigen::Affine3d> nodeMotion; ///< k, of constrained nodes, frame units
        /// Of every tag but 1, frame units; of single nodes that turn as the surface around them does, that.
        std::map<Index, Eigen::Affine3d> motion;
        int iterations = 0; ///< of the solver, with those of the poses on the way
    };

    /// \param surface the free surface without its loose parts, and what holds it
    /// \param slotTag one per vertex slot, noVertex where it is deleted \param point slots of the point handles
    /// \param rest 3 x vertex slots, mesh units
    /// \throw Error nodes that belong elsewhere, or a graph that cannot be factorised \throw Cancelled
    Deformer(SurfaceGraph surface, HeldNodes heldNodes, LooseSurface looseSurface, std::vector<int> slotTag,
             const std::vector<std::size_t> &point, const Eigen::Matrix3Xd &rest, const DeformerParam &param,
             const Progress &progress = {})
        : surface(std::move(surface)), held(std::move(heldNodes)), loose(std::move(looseSurface)),
          slotTag(std::move(slotTag)), point(point), param(param) {
        Stopwatch watch;
        for (std::size_t i : point)
            pointRest.emplace_back(rest.col(Eigen::Index(i)));
        center = HandleCenters(this->slotTag, [&](std::size_t i) { return rest.col(Eigen::Index(i)); });
        BuildGraph(rest, progress.Slice(0, 0.7));
        secondsGraph = watch.Seconds();
        watch = {};
        mapping = std::make_unique<GraphMapping>(this->surface.graph, held.tag, patches, graph, param.weights,
                                                 param.influence, param.shape.runOver * D, progress.Slice(0.7, 0.95),
                                                 param.shape);
        following = param.looseParts == LooseParts::Follow
                        ? FollowNearest(rest, this->slotTag, this->surface.frame, loose, 2 * D, progress.Slice(0.95, 1))
                        : LooseFollowing{std::vector<std::size_t>(loose.parts, LooseFollowing::none), {}};
        for (std::size_t i : following.leader)
            leaderRest.push_back(i == LooseFollowing::none ? Eigen::Vector3d::Zero()
                                                           : Eigen::Vector3d(rest.col(Eigen::Index(i))));
        FindMoving(progress.Slice(1, 1));
        secondsMap = watch.Seconds();
    }
    Deformer(const Deformer &) = delete; // its parts refer to each other
    Deformer &operator=(const Deformer &) = delete;

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
        if (!parts || given.turns != turns) {
            parts = std::make_unique<PartsDeformer>(graph, nodeArea, given, param.shape.heldDepth);
            turns = given.turns;
        }
        pose.solved = parts->Solve(given, solver, progress, last ? &last->solved : nullptr,
                                   last ? last->nodeMotion : std::vector<Eigen::Affine3d>());
        pose.iterations = pose.solved.iterations;
        pose.graph = pose.solved;
        std::vector<bool> hasMotion(graph.Size());
        for (Index j = 0; j < graph.Size(); ++j)
            hasMotion[j] = given.constrained[j] && !given.turns[j];
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

    /// \param position 3 x vertex slots, mesh units; in: at rest, out: deformed. Held vertices are exact: what is fixed
    ///        keeps its bits.
    /// \param linear if given: how the surface turns and stretches around each vertex, mesh units, one per slot
    void Apply(const Pose &pose, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> *linear = nullptr,
               const Progress &progress = {}) const {
        if (linear)
            linear->assign(slotTag.size(), Eigen::Matrix3f::Identity());
        Apply(
            pose, [&](std::size_t i) { return Eigen::Vector3d(position.col(Eigen::Index(i))); },
            [&] {
                return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                    position.col(Eigen::Index(i)) = p;
                    if (linear)
                        (*linear)[i] = map;
                };
            },
            linear != nullptr, progress, [](std::size_t) {});
    }

    /// The same for any layout: rest(slot) gives the position at rest; taker() gives what takes, by a call with (slot,
    /// position, map), the deformed ones and, where \p maps are wanted, how the surface turns and stretches there.
    /// There is a taker for some slots each, called from several threads; it gets each slot that may move in some pose
    /// once, and no other. ahead(slot) tells which slots come soon, for memory that is far away.
    template <class Rest, class Taker, class Ahead>
    void Apply(const Pose &pose, const Rest &rest, const Taker &taker, bool maps, const Progress &progress,
               const Ahead &ahead) const {
        const Carrier carrier(*this, pose);
        const char *stage = "Mapping to the mesh";
        const std::size_t all = bent.size() + carried.size();
        const double share = all > 0 ? double(bent.size()) / double(all) : 1;
        ApplyToBent(carrier, rest, taker, maps, progress.Slice(0, share), ahead);
        ParallelFor(progress.Slice(share, 1), stage, carried.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
            auto &&take = taker();
            Eigen::Matrix3f map;
            for (std::size_t c = first; c < last; ++c) {
                const Eigen::Vector3d p = carrier(carried[c], rest(carried[c]), map);
                take(carried[c], p, map);
            }
        });
        progress(1, stage);
    }

    /// Where a pose takes points that are not the surface's own vertices: as a vertex of it moves.
    class Carrier {
      public:
        Carrier(const Deformer &deformer, const Pose &pose)
            : deformer(deformer), pose(pose), mapped(deformer.mapping->At(pose.graph, pose.motion)),
              looseMotion(deformer.LooseMotions(pose, mapped)), moves(pose.given.Moves()) {}

        /// \param slot of a vertex \param p a point beside it, mesh units; it keeps its bits where the vertex does
        /// \param linear how the surface turns and stretches there, mesh units
        Eigen::Vector3d operator()(std::size_t slot, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const {
            const Frame &frame = deformer.surface.frame;
            const Index node = deformer.surface.nodeOf[slot];
            linear.setIdentity();
            if (!moves || deformer.slotTag[slot] == noVertex)
                return p;
            if (node >= 0 && deformer.held.tag[node] == 1) {
                if (deformer.param.weights == MappingWeights::Surface &&
                    pose.graph.rests[deformer.patches.patchOf[node]])
                    return p;
                const Eigen::Vector3d there = mapped(node, frame.ToFrame(p), &linear);
                linear = (frame.inverseMetric * linear.cast<double>() * frame.metric).cast<float>();
                return frame.FromFrame(there);
            }
            if (node >= 0 && deformer.held.IsFixed(deformer.held.tag[node]))
                return p;
            const auto told = pose.given.pointMotion.find(slot);
            const auto &follows = deformer.following.vertex;
            const auto follower =
                std::lower_bound(follows.begin(), follows.end(), slot,
                                 [](const LooseFollowing::Vertex &vertex, std::size_t s) { return vertex.slot < s; });
            const Eigen::Matrix4d &matrix =
                node >= 0 ? pose.given.motion.at(deformer.held.tag[node]) : deformer.MatrixAt(pose, looseMotion, slot);
            linear = matrix.topLeftCorner<3, 3>().cast<float>();
            if (told != pose.given.pointMotion.end())
                return p + told->second.topRightCorner<3, 1>();
            if (follower != follows.end() && follower->slot == slot)
                return deformer.Followed(pose, mapped, *follower, p);
            return matrix.isIdentity(0) ? p : Eigen::Vector3d((matrix * p.homogeneous()).head<3>());
        }

      private:
        friend class Deformer;
        const Deformer &deformer;
        const Pose &pose;
        const GraphMapping::Posed mapped;
        const std::vector<Eigen::Matrix4d> looseMotion;
        const bool moves;
    };

    /// body(slot) for each slot that may move in some pose, once.
    template <class Body>
    void ForMoving(const Body &body) const {
        for (const Bent &vertex : bent)
            body(std::size_t(vertex.slot));
        for (std::uint32_t i : carried)
            body(std::size_t(i));
    }

    /// The motion of each loose part, mesh units.
    std::vector<Eigen::Matrix4d> LooseMotions(const Pose &pose) const {
        return LooseMotions(pose, mapping->At(pose.graph, pose.motion));
    }

    /// The motion of a vertex that is no node of the surface, mesh units. \param looseMotion of each loose part
    const Eigen::Matrix4d &MatrixAt(const Pose &pose, const std::vector<Eigen::Matrix4d> &looseMotion,
                                    std::size_t slot) const {
        if (slotTag[slot] == 1 && !loose.partOf.empty() && loose.partOf[slot] >= 0)
            return looseMotion[loose.partOf[slot]];
        return pose.given.motion.at(slotTag[slot] == 1 ? 0 : std::max(0, slotTag[slot]));
    }

    const SurfaceGraph surface;
    const HeldNodes held;
    const LooseSurface loose;
    const std::vector<int> slotTag;
    std::map<Index, Eigen::Vector3d> center; ///< of each handle tag: the mean of its vertices, mesh units
    Patches patches;
    DeformationGraph graph;
    Index placedNodes = 0;   ///< how many of the given nodes lie on the surface, and are used
    double secondsGraph = 0; ///< that preparing patches and graph took ...
    double secondsMap = 0;   ///< ... and the mapping

  private:
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
                                     progress.Slice(0.9, 1), param.shape.leastWeight);
        nodeArea.assign(graph.Size(), 0);
        for (Index u = 0; u < surface.graph.Size(); ++u)
            if (patches.patchOf[u] >= 0)
                nodeArea[patches.patchOf[u]] += surface.nodeArea[u];
    }

    /// A free vertex of the surface.
    struct Bent {
        std::uint32_t slot;
        Index node;
    };

    /// Lists what may move, free vertices of one patch beside each other.
    void FindMoving(const Progress &progress) {
        const char *stage = "Preparing the mapping";
        const std::size_t grain = 1 << 14, count = surface.slots.size(), chunks = (count + grain - 1) / grain;
        std::vector<std::size_t> begin(chunks + 1, 0);
        const auto isBent = [&](std::size_t i) {
            const Index node = surface.nodeOf[surface.slots[i]];
            return node >= 0 && held.tag[node] == 1;
        };
        ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                begin[first / grain + 1] += isBent(i);
        });
        for (std::size_t c = 0; c < chunks; ++c)
            begin[c + 1] += begin[c];
        AssignLarge(bent, begin[chunks], Bent{0, 0});
        ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
            std::vector<std::pair<Index, Bent>> here; // by patch
            here.reserve(last - first);
            std::map<Index, std::size_t> next; // of each patch: where its next one goes
            for (std::size_t i = first; i < last; ++i)
                if (isBent(i)) {
                    const Index node = surface.nodeOf[surface.slots[i]];
                    here.push_back({patches.patchOf[node], {surface.slots[i], node}});
                    ++next[here.back().first];
                }
            std::size_t at = begin[first / grain];
            for (auto &each : next)
                each.second = std::exchange(at, at + each.second);
            for (const auto &each : here)
                bent[next[each.first]++] = each.second;
        });

        std::vector<char> isPoint; // one per slot, where there is any
        for (std::size_t i : point) {
            isPoint.resize(slotTag.size(), 0);
            isPoint[i] = 1;
        }
        const auto isCarried = [&](std::size_t i) {
            const Index node = surface.nodeOf[i];
            if (node >= 0)
                return held.tag[node] != 1 && !held.IsFixed(held.tag[node]);
            if (slotTag[i] != 1)
                return slotTag[i] > 1;
            return (!loose.partOf.empty() && loose.partOf[i] >= 0) || (!isPoint.empty() && isPoint[i]);
        };
        carried = CollectInOrder<std::uint32_t>(progress, stage, Index(slotTag.size()),
                                                [&](Index i, std::vector<std::uint32_t> &found) {
                                                    if (isCarried(std::size_t(i)))
                                                        found.push_back(std::uint32_t(i));
                                                });
    }

    template <class Rest, class Taker, class Ahead>
    void ApplyToBent(const Carrier &carrier, const Rest &rest, const Taker &taker, bool maps, const Progress &progress,
                     const Ahead &ahead) const {
        const bool isSurface = param.weights == MappingWeights::Surface; // no other part has an influence
        const Frame &frame = surface.frame;
        const bool isSame = frame.metric.isIdentity(0);
        const std::size_t lanes = detail::lanes;
        ParallelFor(progress, "Mapping to the mesh", bent.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            auto &&take = taker();
            GraphMapping::Posed::Scratch scratch;
            Index node[detail::lanes];
            Eigen::Vector3d p[detail::lanes], there[detail::lanes];
            Eigen::Matrix3f map[detail::lanes];
            for (std::size_t i = first; i < last;) {
                const Index patch = patches.patchOf[bent[i].node];
                int count = 0;
                for (std::size_t next = i + 2 * lanes; next < std::min(last, i + 3 * lanes); ++next)
                    ahead(bent[next].slot);
                for (; count < detail::lanes && i + count < last; ++count) {
                    node[count] = bent[i + count].node;
                    if (patches.patchOf[node[count]] != patch)
                        break;
                    p[count] = rest(bent[i + count].slot);
                }
                if (!carrier.moves || (isSurface && carrier.pose.graph.rests[patch])) {
                    for (int l = 0; l < count; ++l)
                        take(bent[i + l].slot, p[l], Eigen::Matrix3f::Identity());
                } else {
                    for (int l = 0; l < count; ++l)
                        p[l] = frame.ToFrame(p[l]);
                    carrier.mapped.Map(node, p, count, there, maps ? map : nullptr, scratch);
                    for (int l = 0; l < count; ++l)
                        take(bent[i + l].slot, frame.FromFrame(there[l]),
                             maps && !isSame
                                 ? Eigen::Matrix3f(
                                       (frame.inverseMetric * map[l].cast<double>() * frame.metric).cast<float>())
                                 : map[l]);
                }
                i += count;
            }
        });
    }

    /// The motion of a held vertex, or of a free one at the place of one.
    const Eigen::Matrix4d &GivenAt(const Pose &pose, std::size_t slot) const {
        const Index node = surface.nodeOf[slot];
        if (node >= 0)
            return pose.given.motion.at(held.tag[node]);
        return slotTag[slot] == 1 ? pose.given.pointMotion.at(slot) : pose.given.motion.at(std::max(0, slotTag[slot]));
    }

    /// The motion of each loose part, mesh units: the rigid one of its leader.
    std::vector<Eigen::Matrix4d> LooseMotions(const Pose &pose, const GraphMapping::Posed &mapped) const {
        std::vector<Eigen::Matrix4d> result(loose.parts, Eigen::Matrix4d::Identity());
        for (Index part = 0; part < loose.parts; ++part) {
            const std::size_t i = following.leader[part];
            if (i == LooseFollowing::none)
                continue;
            const Eigen::Vector3d p = surface.frame.ToFrame(leaderRest[part]);
            Eigen::Affine3d there;
            const Index node = surface.nodeOf[i];
            if (node >= 0 && surface.tag[node] == 1) {
                there.linear() = detail::RotationOf(pose.graph.linear[patches.patchOf[node]]);
                there.translation() = mapped(node, p) - there.linear() * p;
            } else {
                const Eigen::Matrix4d &given = GivenAt(pose, i);
                if (given.isIdentity(0))
                    continue;
                const Eigen::Affine3d moved = surface.frame.ToFrame(given);
                there.linear() = detail::RotationOf(moved.linear());
                there.translation() = moved * p - there.linear() * p;
            }
            result[part] = surface.frame.FromFrame(there);
            result[part].row(3) << 0, 0, 0, 1;
        }
        return result;
    }

    /// Where a vertex of a large loose part goes: the mean of where the places near it lead.
    Eigen::Vector3d Followed(const Pose &pose, const GraphMapping::Posed &mapped, const LooseFollowing::Vertex &vertex,
                             const Eigen::Vector3d &p) const {
        const Eigen::Vector3d x = surface.frame.ToFrame(p);
        Eigen::Vector3d way = Eigen::Vector3d::Zero();
        for (int i = 0; i < Places::several; ++i) {
            if (!(vertex.weight[i] > 0))
                continue;
            const std::size_t slot = std::size_t(vertex.place[i]);
            const Index node = surface.nodeOf[slot];
            const Eigen::Vector3d there =
                node >= 0 ? mapped(node, x) : Eigen::Vector3d(surface.frame.ToFrame(GivenAt(pose, slot)) * x);
            way += double(vertex.weight[i]) * (there - x);
        }
        return way.isZero(0) ? p : surface.frame.FromFrame(Eigen::Vector3d(x + way));
    }

    std::vector<std::size_t> point;
    std::vector<Eigen::Vector3d> pointRest; // of each point handle, mesh units
    DeformerParam param;
    double D = 0; // frame units
    detail::SmallParts small;
    std::vector<double> nodeArea; // k, frame units^2
    std::unique_ptr<GraphMapping> mapping;
    LooseFollowing following;
    std::vector<Eigen::Vector3d> leaderRest; // of each loose part, mesh units
    std::vector<Bent> bent;                  // the free vertices of the surface
    std::vector<std::uint32_t> carried;      // slots of handles, and of loose parts
    std::vector<bool> turns;                 // those that parts is made for
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
