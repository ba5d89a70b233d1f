// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMER_H
#define VCG_FCD_DEFORMER_H

#include "deformation_param.h"
#include "graph_parts.h"
#include "loose_parts.h"

#include <sstream>

namespace vcg {
namespace fcd {

/// Which nodes of a surface are held, and which of them alone. Follows from the tags and the places of point handles.
struct HeldNodes {
    std::vector<Index> tag;      ///< n: 0 fixed, 1 free, from 2 handles; -1, -2, ... single nodes
    std::vector<Index> original; ///< tag of the single nodes before, -1 for point handles
    std::vector<Index> pointTag; ///< of each point handle: that of its node, 1 where no surface is

    static bool IsSingle(Index t) { return t < 0; }
    bool IsFixed(Index t) const { return t == 0 || (IsSingle(t) && original[-1 - t] == 0); }

    /// Holds node \p u, alone. \return its tag
    Index HoldAlone(Index u, Index tagBefore) {
        original.push_back(tagBefore);
        return tag[u] = -Index(original.size());
    }
};

/// A node that is held without a neighbour that is held alike has no orientation of its own: only its position is
/// given, unless it is told to turn. (Holding its orientation leaves a bump around it.)
/// \param slotTag one per vertex slot \param point slots of the point handles, which exist
/// \throw Error two point handles at one place, or one where the surface is held
inline HeldNodes HoldNodes(const SurfaceGraph &surface, const std::vector<int> &slotTag,
                           const std::vector<std::size_t> &point, const Progress &progress) {
    HeldNodes held;
    held.tag = surface.tag;
    const std::vector<Index> alone =
        CollectInOrder(progress, "Reading the handles", surface.graph.Size(), [&](Index u, std::vector<Index> &found) {
            if (held.tag[u] == 1)
                return;
            bool free = false;
            for (Index v : surface.graph.adjacency[u]) {
                if (held.tag[v] == held.tag[u])
                    return;
                free |= held.tag[v] == 1;
            }
            if (free)
                found.push_back(u);
        });
    std::map<std::size_t, std::size_t> isolated; // point handles by slot, where no surface is
    for (std::size_t i = 0; i < point.size(); ++i) {
        const std::string name = "Point handle " + std::to_string(i + 1);
        const Index node = surface.nodeOf[point[i]];
        std::size_t other = i;
        if (node >= 0 && HeldNodes::IsSingle(held.tag[node]))
            other = std::size_t(std::find(held.pointTag.begin(), held.pointTag.end(), held.tag[node]) -
                                held.pointTag.begin());
        else if (node < 0)
            other = isolated.emplace(point[i], i).first->second;
        if (other != i)
            throw Error(name + " is at the same place as point handle " + std::to_string(other + 1) +
                        "; leave one of them out.");
        if ((node < 0 ? slotTag[point[i]] : held.tag[node]) != 1)
            throw Error(name + " is at vertex " + std::to_string(point[i]) +
                        ", which is held already; point handles belong where the surface is free.");
        held.pointTag.push_back(node < 0 ? 1 : held.HoldAlone(node, -1));
    }
    for (Index u : alone)
        held.HoldAlone(u, held.tag[u]);
    return held;
}

/// How what is held moves, at one pose.
struct HeldMotions {
    std::map<Index, Eigen::Matrix4d> motion;            ///< of every tag but 1, mesh units
    std::map<Index, bool> rotates;                      ///< tags whose motion is told to turn
    std::map<std::size_t, Eigen::Matrix4d> pointMotion; ///< of point handles at vertices that are no surface, by slot

    bool Moves() const {
        return !pointMotion.empty() || std::any_of(motion.begin(), motion.end(), [](const auto &each) {
            return each.second != Eigen::Matrix4d::Identity();
        });
    }
};

namespace detail {

/// \throw Error when \p motion leads so far that the numbers do not hold what follows from it
inline void ExpectNear(const Frame &frame, const Eigen::Matrix4d &motion, const std::string &name) {
    const double most = 1e30; // frame units; floats end at 3e38
    if (!(frame.ToFrame(motion).matrix().cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= most))
        throw Error(name + " moves too far: beyond 1e30 times the size of the mesh. Check its motion, and the pose.");
}

/// The mean position of the vertices of each handle, mesh units.
inline std::map<Index, Eigen::Vector3d> HandleCenters(const Eigen::Matrix3Xd &position, const std::vector<int> &tag) {
    std::map<Index, std::pair<Eigen::Vector3d, double>> sums;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (tag[i] >= 2) {
            auto &sum = sums.emplace(tag[i], std::make_pair(Eigen::Vector3d::Zero().eval(), 0.0)).first->second;
            sum.first += position.col(Eigen::Index(i));
            ++sum.second;
        }
    std::map<Index, Eigen::Vector3d> center;
    for (const auto &sum : sums)
        center[sum.first] = sum.second.first / sum.second.second;
    return center;
}

/// The median distance of positions to the nearest other one; infinite for a single one.
inline float SpacingOf(NodeTree &tree, const Eigen::Matrix3Xf &position) {
    if (position.cols() < 2)
        return std::numeric_limits<float>::infinity();
    std::vector<float> spacing;
    vcg::KdTree<float>::PriorityQueue nearest;
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
        tree->doQueryK(tree.Point(position.col(i)), 2, nearest);
        spacing.push_back(std::sqrt(nearest.getTopWeight()));
    }
    std::nth_element(spacing.begin(), spacing.begin() + spacing.size() / 2, spacing.end());
    return spacing[spacing.size() / 2];
}

/// The nodes of \p surface nearest to \p centers (3 x k, mesh units), each once, without those that are held. Left out
/// are centres further from the mesh than centres are from each other: they belong elsewhere.
/// \param rest 3 x vertex slots \param tag one per vertex slot \param nodeTag n, 1 where free \param placed how many
/// centres are not left out \throw Error when these are less than half of them
inline std::vector<Index> NearestNodes(const Eigen::Matrix3Xd &rest, const SurfaceGraph &surface,
                                       const std::vector<int> &tag, const std::vector<Index> &nodeTag,
                                       const Eigen::Matrix3Xd &centers, Index &placed) {
    const Index k = Index(centers.cols());
    Eigen::Matrix3Xf position(3, k);
    for (Index i = 0; i < k; ++i) {
        if (!centers.col(i).allFinite())
            throw Error("A node of the deformation graph has a coordinate that is not a finite number.");
        const double most = 1e15; // squares of it are floats
        position.col(i) =
            surface.frame.ToFrame(Eigen::Vector3d(centers.col(i))).cwiseMin(most).cwiseMax(-most).cast<float>();
    }
    // What lies beside held vertices alone is on the mesh, too.
    std::vector<float> distance(k, std::numeric_limits<float>::infinity());
    std::vector<Index> nearest(k, -1);
    if (surface.graph.Size() > 0) {
        NodeTree tree(surface.graph.position);
        for (Index i = 0; i < k; ++i) {
            unsigned found = 0;
            float d = 0;
            tree->doQueryClosest(tree.Point(position.col(i)), found, d);
            nearest[i] = Index(found);
            distance[i] = (surface.graph.position.col(found) - position.col(i)).norm();
        }
    }
    NodeTree centerTree(position);
    // As far as patches reach: half-way to the next centre, or as k of them do that share the surface.
    const double shared = std::sqrt(surface.area / (double(EIGEN_PI) * double(k)));
    const double patchRadius = std::min(0.25, std::max(shared, 0.5 * double(SpacingOf(centerTree, position))));
    const float tooFar = float(std::max(patchRadius, surface.averageEdge) + 1e-5); // of the frame's diagonal, 1
    if (std::any_of(distance.begin(), distance.end(), [&](float d) { return d > tooFar; })) {
        std::vector<vcg::Point3f> held;
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (tag[i] != 1 && surface.nodeOf[i] < 0 && tag[i] != noVertex) {
                const Eigen::Vector3d p = surface.frame.ToFrame(Eigen::Vector3d(rest.col(Eigen::Index(i))));
                if (p.cwiseAbs().maxCoeff() < 1e15)
                    held.push_back(NodeTree::Point(p.cast<float>()));
            }
        if (!held.empty()) {
            vcg::KdTree<float> heldTree(vcg::ConstDataWrapper<vcg::Point3f>(held.data(), int(held.size())));
            for (Index i = 0; i < k; ++i) {
                unsigned found = 0;
                float d = 0;
                heldTree.doQueryClosest(NodeTree::Point(position.col(i)), found, d);
                const float here = vcg::Distance(held[found], NodeTree::Point(position.col(i)));
                if (here < distance[i]) {
                    distance[i] = here;
                    nearest[i] = -1;
                }
            }
        }
    }
    placed = 0;
    std::vector<bool> taken(surface.graph.Size(), false);
    std::vector<Index> node;
    for (Index i = 0; i < k; ++i) {
        if (distance[i] > tooFar)
            continue;
        ++placed;
        const Index u = nearest[i];
        if (u < 0 || taken[u] || nodeTag[u] != 1)
            continue;
        taken[u] = true;
        node.push_back(u);
    }
    if (2 * placed < k) {
        std::ostringstream message;
        message
            << "Only " << placed << " of the " << k << " given nodes lie on the surface (within "
            << tooFar * surface.frame.scale
            << " of a vertex): they seem to belong to another mesh, or to this one in another place. Give the graph "
               "of this mesh, move it to where the mesh is, or let a graph be built.";
        throw Error(message.str());
    }
    return node;
}

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

/// The closest rotation between the constrained nodes before and after, as the rotation that single nodes begin with.
inline void TurnTogether(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                         NodeConstraints &given) {
    std::vector<Eigen::Affine3d> &motion = given.motion;
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    double count = 0;
    auto forConstrained = [&](const auto &body) {
        for (Index j = 0; j < graph.Size(); ++j)
            if (given.constrained[j]) {
                const Eigen::Vector3d x = graph.graph.position.col(j).cast<double>();
                body(x, Eigen::Vector3d(motion[j] * x));
            }
    };
    forConstrained([&](const Eigen::Vector3d &x, const Eigen::Vector3d &y) {
        before += x;
        after += y;
        ++count;
    });
    Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
    forConstrained([&](const Eigen::Vector3d &x, const Eigen::Vector3d &y) {
        s += (x - before / count) * (y - after / count).transpose();
    });
    // Where few points leave the rotation open, none is preferred.
    const Eigen::Matrix3d rotation = FitRotation(s + 1e-3 * s.norm() * Eigen::Matrix3d::Identity());
    for (Index j = 0; j < graph.Size(); ++j)
        if (given.turns[j] && HeldNodes::IsSingle(tag[patches.center[j]])) {
            const Eigen::Vector3d x = graph.graph.position.col(j).cast<double>(), y = motion[j] * x;
            motion[j].linear() = rotation;
            motion[j].translation() = y - rotation * x;
        }
}

/// Small held parts of the surface: connected nodes of one tag that reach no farther than a fraction of D and have free
/// surface around them.
struct SmallParts {
    std::vector<Index> center;  ///< of each part, the node nearest its middle
    std::vector<double> radius; ///< farthest node of the part from there
    std::vector<char> isIn;     ///< n flags
};

inline SmallParts FindSmallParts(const Graph &surface, const std::vector<Index> &tag, double D,
                                 const ShapeConstants &shape) {
    SmallParts small;
    small.isIn.assign(tag.size(), 0);
    std::vector<char> seen(tag.size(), 0);
    std::vector<Index> part;
    for (Index seed = 0; seed < Index(tag.size()); ++seed) {
        if (tag[seed] == 1 || seen[seed])
            continue;
        seen[seed] = 1;
        part.assign(1, seed);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < part.size(); ++i) {
            mean += surface.position.col(part[i]).cast<double>();
            for (Index v : surface.adjacency[part[i]])
                if (!seen[v] && tag[v] == tag[seed]) {
                    seen[v] = 1;
                    part.push_back(v);
                }
        }
        const Eigen::Vector3f middle = (mean / double(part.size())).cast<float>();
        Index center = seed;
        for (Index u : part)
            if ((surface.position.col(u) - middle).norm() < (surface.position.col(center) - middle).norm())
                center = u;
        float radius = 0;
        for (Index u : part)
            radius = std::max(radius, (surface.position.col(u) - surface.position.col(center)).norm());
        if (!(radius <= shape.smallHeldPart * D))
            continue;
        Eigen::Vector3d flow = Eigen::Vector3d::Zero();
        double border = 0;
        bool isFree = false;
        for (Index u : part)
            for (Index v : surface.adjacency[u])
                if (tag[v] == 1) {
                    const double w = CotangentWeight(surface, u, v);
                    const Eigen::Vector3d way = (surface.position.col(v) - surface.position.col(u)).cast<double>();
                    flow += w * way;
                    border += std::abs(w) * way.norm();
                    isFree = true;
                }
        if (!isFree || (part.size() > 1 && flow.norm() >= shape.surrounded * border))
            continue;
        small.center.push_back(center);
        small.radius.push_back(radius);
        for (Index u : part)
            small.isIn[u] = 1;
    }
    return small;
}

/// Nodes of held patches move as their tag does, and turn with what they hold: the region behind them goes on for all
/// that is known of it, but behind a small part there is only what it covers. A single node that is told to turn does.
inline NodeConstraints ConstrainNodes(const DeformationGraph &graph, const std::vector<Index> &tag,
                                      const Patches &patches, const SmallParts &small, const HeldMotions &motions,
                                      const std::map<Index, Eigen::Affine3d> &motion) {
    const Index k = graph.Size();
    NodeConstraints given{std::vector<bool>(k), std::vector<bool>(k), std::vector<double>(k, 0),
                          std::vector<Eigen::Affine3d>(k, Eigen::Affine3d::Identity())};
    for (Index j = 0; j < k; ++j) {
        const Index t = tag[patches.center[j]];
        if (t == 1)
            continue;
        const auto rotates = motions.rotates.find(t);
        given.constrained[j] = true;
        given.turns[j] = !(HeldNodes::IsSingle(t) && rotates != motions.rotates.end() && rotates->second);
        given.heldArea[j] = HeldNodes::IsSingle(t) ? 0 : std::numeric_limits<double>::infinity();
        given.motion[j] = motion.at(t);
    }
    for (std::size_t i = 0; i < small.center.size(); ++i)
        given.heldArea[patches.patchOf[small.center[i]]] = double(EIGEN_PI) * small.radius[i] * small.radius[i];
    return given;
}

/// Grows the patches anew with one around each small held part: its node then stands for the free surface around it, as
/// any other, so that the surface follows it and not only the nearest vertices.
inline void OpenSmallParts(const Graph &surface, const std::vector<Index> &tag, const SmallParts &small,
                           Patches &patches, const Progress &progress) {
    if (small.center.empty())
        return;
    std::vector<Index> open(tag), center;
    for (std::size_t u = 0; u < tag.size(); ++u)
        if (small.isIn[u])
            open[u] = 1;
    std::vector<char> dropped(patches.Size(), 0); // those that the part is near the centre of
    for (Index c : small.center)
        for (Index v : surface.adjacency[c]) {
            const Index p = patches.patchOf[v];
            if (p >= 0)
                dropped[p] |= (surface.position.col(c) - surface.position.col(patches.center[p])).norm() <
                              0.5f * patches.radius[p];
        }
    for (Index p = 0; p < patches.Size(); ++p)
        if (!dropped[p])
            center.push_back(patches.center[p]);
    center.insert(center.end(), small.center.begin(), small.center.end());
    patches = GrowPatches(surface, open, center, progress);
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
    };

    /// \param surface the free surface without its loose parts, and what holds it
    /// \param slotTag one per vertex slot, noVertex where it is deleted \param point slots of the point handles
    /// \param rest 3 x vertex slots, mesh units
    /// \throw Error nodes that belong elsewhere, or a graph that cannot be factorised \throw Cancelled
    Deformer(SurfaceGraph surface, HeldNodes heldNodes, LooseSurface looseSurface, std::vector<int> slotTag,
             const std::vector<std::size_t> &point, const Eigen::Matrix3Xd &rest, const DeformationParam &param,
             const Progress &progress = {})
        : surface(std::move(surface)), held(std::move(heldNodes)), loose(std::move(looseSurface)),
          slotTag(std::move(slotTag)), point(point), param(param) {
        Stopwatch watch;
        for (std::size_t i : point)
            pointRest.emplace_back(rest.col(Eigen::Index(i)));
        center = detail::HandleCenters(rest, this->slotTag);
        BuildGraph(rest, progress.Slice(0, 0.7));
        secondsGraph = watch.Seconds();
        watch = {};
        mapping = std::make_unique<GraphMapping>(this->surface.graph, held.tag, patches, graph, param.weights,
                                                 param.influence, param.shape.runOver * D, progress.Slice(0.7, 0.95),
                                                 param.shape);
        following = param.looseParts == LooseParts::Follow
                        ? FollowNearest(rest, this->slotTag, this->surface.frame, loose, 2 * D, progress.Slice(0.95, 1))
                        : LooseFollowing{std::vector<std::size_t>(loose.parts, LooseFollowing::none), {}};
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
    Pose Solve(HeldMotions motions, const Pose *last = nullptr, const Progress &progress = {}) {
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
        SolverParam solver;
        solver.smoothness = param.smoothness;
        solver.maxIterations = param.maxIterations;
        solver.tolerance = param.tolerance;
        pose.solved = parts->Solve(given, solver, progress, last ? &last->solved : nullptr,
                                   last ? last->nodeMotion : std::vector<Eigen::Affine3d>());
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

    /// \param position 3 x vertex slots, mesh units; in: at rest, out: deformed. Held vertices are exact: what is fixed
    ///        keeps its bits.
    /// \param linear if given: how the surface turns and stretches around each vertex, mesh units, one per slot
    void Apply(const Pose &pose, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> *linear = nullptr,
               const Progress &progress = {}) const {
        const GraphMapping::Posed mapped = mapping->At(pose.graph, pose.motion);
        const Frame &frame = surface.frame;
        const std::vector<Eigen::Matrix4d> looseMotion = LooseMotions(pose, mapped, position);
        std::vector<Eigen::Vector3d> followed;
        followed.reserve(following.vertex.size());
        for (const LooseFollowing::Vertex &vertex : following.vertex)
            followed.push_back(Followed(pose, mapped, vertex, position.col(Eigen::Index(vertex.slot))));
        const Eigen::Matrix4d still = Eigen::Matrix4d::Identity();
        const bool isSurface = param.weights == MappingWeights::Surface; // no other part has an influence
        const bool moves = pose.given.Moves();
        const std::size_t slots = slotTag.size(), block = 1 << 19; // progress is reported between blocks
        if (linear)
            linear->resize(slots);
        for (std::size_t start = 0; start < slots; start += block) {
            progress(double(start) / double(slots), "Mapping to the mesh");
            const std::size_t count = std::min(block, slots - start);
            ParallelFor(progress.threads, count, 1 << 12, [&](std::size_t first, std::size_t last) {
                for (std::size_t i = start + first; i < start + last; ++i) {
                    const Eigen::Vector3d p = position.col(Eigen::Index(i));
                    const Index node = surface.nodeOf[i];
                    const bool isFree = node >= 0 && held.tag[node] == 1;
                    const bool isBent = moves && isFree && !(isSurface && pose.graph.rests[patches.patchOf[node]]);
                    Eigen::Matrix3d map;
                    if (isBent) {
                        position.col(Eigen::Index(i)) =
                            frame.FromFrame(mapped(node, frame.ToFrame(p), linear ? &map : nullptr));
                        if (linear)
                            map = frame.inverseMetric * map * frame.metric;
                    } else {
                        // Vertices of a seam may have different tags.
                        const bool stays = !moves || isFree || (node >= 0 && held.IsFixed(held.tag[node]));
                        const Eigen::Matrix4d &matrix = stays       ? still
                                                        : node >= 0 ? pose.given.motion.at(held.tag[node])
                                                                    : MatrixAt(pose, looseMotion, i);
                        if (!matrix.isIdentity(0))
                            position.col(Eigen::Index(i)) = (matrix * p.homogeneous()).head<3>();
                        map = matrix.topLeftCorner<3, 3>();
                    }
                    if (linear)
                        (*linear)[i] = map.cast<float>();
                }
            });
        }
        for (const auto &each : pose.given.pointMotion)
            position.col(Eigen::Index(each.first)) += each.second.topRightCorner<3, 1>();
        if (moves)
            for (std::size_t v = 0; v < followed.size(); ++v)
                position.col(Eigen::Index(following.vertex[v].slot)) = followed[v];
    }

    /// The motion of each loose part, mesh units. \param rest 3 x slots
    std::vector<Eigen::Matrix4d> LooseMotions(const Pose &pose, const Eigen::Matrix3Xd &rest) const {
        return LooseMotions(pose, mapping->At(pose.graph, pose.motion), rest);
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

    /// The motion of a held vertex, or of a free one at the place of one.
    const Eigen::Matrix4d &GivenAt(const Pose &pose, std::size_t slot) const {
        const Index node = surface.nodeOf[slot];
        if (node >= 0)
            return pose.given.motion.at(held.tag[node]);
        return slotTag[slot] == 1 ? pose.given.pointMotion.at(slot) : pose.given.motion.at(std::max(0, slotTag[slot]));
    }

    /// The motion of each loose part, mesh units: the rigid one of its leader. \param rest 3 x slots, of leaders
    std::vector<Eigen::Matrix4d> LooseMotions(const Pose &pose, const GraphMapping::Posed &mapped,
                                              const Eigen::Matrix3Xd &rest) const {
        std::vector<Eigen::Matrix4d> result(loose.parts, Eigen::Matrix4d::Identity());
        for (Index part = 0; part < loose.parts; ++part) {
            const std::size_t i = following.leader[part];
            if (i == LooseFollowing::none)
                continue;
            const Eigen::Vector3d p = surface.frame.ToFrame(Eigen::Vector3d(rest.col(Eigen::Index(i))));
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
    std::vector<Eigen::Vector3d> pointRest;  // of each point handle, mesh units
    std::map<Index, Eigen::Vector3d> center; // of each handle tag, mesh units
    DeformationParam param;
    double D = 0; // frame units
    detail::SmallParts small;
    std::vector<double> nodeArea; // k, frame units^2
    std::unique_ptr<GraphMapping> mapping;
    LooseFollowing following;
    std::vector<bool> turns; // those that parts is made for
    std::unique_ptr<PartsDeformer> parts;
};

} // namespace fcd
} // namespace vcg

#endif
