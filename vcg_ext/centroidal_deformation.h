// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CENTROIDAL_DEFORMATION_H
#define VCG_FCD_CENTROIDAL_DEFORMATION_H

#include "deformation_check.h"
#include "graph_mapping.h"
#include "graph_parts.h"
#include "loose_parts.h"

#include <array>
#include <sstream>
#include <vcg/complex/complex.h>

/// Fast centroidal deformation in one call. After A. Morsucci, M. Centin, A. Signoroni: Fast centroidal deformation for
/// large mesh models, STAG 2018.

namespace vcg {
namespace fcd {

/// By what the patches are balanced.
enum class PatchMeasure {
    Area,    ///< of the surface, however densely it is sampled
    Vertices ///< their number (paper, Eq. 1)
};

/// How the deformation graph is built.
struct GraphParam {
    double targetRadius = 0;  ///< D, mesh units, >= 0; 0 = 0.75 sqrt(area / initialPatches), of the area that can bend
    int initialPatches = 300; ///< k0, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< of the cost, [0, 1)
    unsigned randomSeed = 1;
    PatchMeasure measure = PatchMeasure::Area;

    /// \throw Error naming the value that is out of range
    void Validate() const {
        if (!(targetRadius >= 0) || std::isinf(targetRadius))
            throw Error("The target radius must be 0 (automatic) or a positive, finite length.");
        if (initialPatches < 1)
            throw Error("The number of initial patches must be at least 1.");
        if (maxIterations < 1)
            throw Error("The maximum number of iterations must be at least 1.");
        if (!(tolerance >= 0 && tolerance < 1))
            throw Error("The tolerance of the patches must be at least 0 and below 1.");
    }
};

/// Which motion the components of the mesh without a handle or fixed vertex make.
enum class LooseParts {
    Follow, ///< that of the nearest part of the surface that is held
    Stay    ///< none
};

/// How a mesh is deformed.
struct DeformationParam {
    GraphParam graph;
    Eigen::Matrix3Xd nodes; ///< 3 x k, mesh units: centres of patches to use instead of sampling; empty = sample
    double smoothness = SolverParam().smoothness;    ///< alpha of Eq. 2, >= 0
    int maxIterations = SolverParam().maxIterations; ///< of the solver, >= 1
    double tolerance = SolverParam().tolerance;      ///< of the solver (see SolverParam), > 0
    GraphWeights graphWeights = GraphWeights::Border;
    MappingWeights weights = MappingWeights::Surface;
    double influence = 4; ///< node radius over patch radius, > 1
    LooseParts looseParts = LooseParts::Follow;
    double pose = 100;    ///< percent of the handles' motion
    bool measure = false; ///< also measure stretch and rotation of the surface
    bool linear = false;  ///< also give the linear map of the surface around each vertex
    ShapeConstants shape;

    /// \throw Error naming the value that is out of range
    void Validate() const {
        graph.Validate();
        if (!(smoothness >= 0) || std::isinf(smoothness))
            throw Error("The smoothness must be a finite number, 0 or more; useful are 0.001 to 0.1.");
        if (maxIterations < 1)
            throw Error("The maximum number of iterations must be at least 1.");
        if (!(tolerance > 0) || std::isinf(tolerance))
            throw Error("The tolerance must be a positive, finite number.");
        if (!(influence > 1) || std::isinf(influence))
            throw Error("The influence must be a finite number above 1: each node has to reach beyond its own patch.");
        if (!std::isfinite(pose))
            throw Error("The pose must be a finite number of percent.");
    }
};

/// What a layer of the deformation graph shows.
struct GraphGeometry {
    Eigen::Matrix3Xd position;              ///< 3 x k, mesh units
    Eigen::Matrix3Xd normal;                ///< 3 x k, that of a vertex there; 0 where the mesh has no normals
    Eigen::VectorXd radius;                 ///< k, mesh units
    std::vector<std::array<Index, 2>> edge; ///< pairs of nodes, the smaller first
    std::vector<vcg::Color4b> color;        ///< k, neighbours differ
    Eigen::VectorXd energy;                 ///< k, each node's share of Eq. 2, mesh units^2; empty: not deformed
};

/// A deformation graph over a mesh.
struct CentroidalGraph {
    GraphGeometry geometry;
    std::vector<Index> patchOf; ///< patch of each vertex slot, -1 for a deleted vertex
    int iterations = 0;
    bool converged = false;
    double cost = 0;         ///< Eq. 1, mesh units^2
    double targetRadius = 0; ///< D that was used, mesh units
    double averageEdge = 0;  ///< mesh units
    double seconds = 0;
    SurfaceReport surface;
};

/// A deformed mesh.
struct DeformationResult {
    Eigen::Matrix3Xd position; ///< 3 x vertex slots, mesh units; that of a deleted vertex stays where it is
    /// Per vertex slot, if wanted: how the surface around it turns and stretches, mesh units. Directions follow it,
    /// normals its Cofactors.
    std::vector<Eigen::Matrix3f> linear;
    GraphGeometry rest, deformed; ///< the deformation graph before and after
    std::vector<float> stretch;  ///< per vertex slot, if measured: root mean square length of the edges there over that
                                 ///< at rest; 1 = not stretched
    std::vector<float> rotation; ///< per vertex slot, if measured: degrees the surface turned there, [0, 180]
    TagCount tags;
    int iterations = 0; ///< of the solver
    bool converged = false;
    double energy = 0; ///< Eq. 2, mesh units^2
    double secondsGraph = 0, secondsSolve = 0, secondsMap = 0;
    SurfaceReport surface;
    Index looseParts = 0;  ///< connected components without a fixed or handle vertex
    Index placedNodes = 0; ///< how many of the given nodes lie on the surface, and are used
    DeformationCheck check;
};

/// What a map of points does to normals, but for their length; the map may flatten.
inline Eigen::Matrix3d Cofactors(const Eigen::Matrix3d &map) {
    Eigen::Matrix3d c;
    for (int i = 0; i < 3; ++i)
        c.col(i) = map.col((i + 1) % 3).cross(map.col((i + 2) % 3));
    return c;
}

namespace detail {

template <class MeshType>
GraphGeometry GeometryOf(const MeshType &m, const SurfaceGraph &surface, const Patches &patches,
                         const DeformationGraph &graph, const Progress &progress) {
    GraphGeometry g;
    g.position.resize(3, graph.Size());
    g.normal = Eigen::Matrix3Xd::Zero(3, graph.Size());
    g.radius.resize(graph.Size());
    for (Index i = 0; i < graph.Size(); ++i) {
        g.position.col(i) =
            surface.frame.FromFrame(surface.graph.position.col(patches.center[i]).template cast<double>());
        g.radius[i] = graph.radius[i] * surface.frame.scale;
        for (Index j : graph.graph.adjacency[i])
            if (i < j)
                g.edge.push_back({i, j});
    }
    g.color = ContrastingColors(graph.graph.adjacency);
    if (vcg::tri::HasPerVertexNormal(m)) {
        std::vector<bool> isCenter(surface.graph.Size(), false);
        for (Index c : patches.center)
            isCenter[c] = true;
        const std::vector<Index> atCenter = CollectInOrder(
            progress, "Building the graph", Index(m.vert.size()), [&](Index i, std::vector<Index> &found) {
                if (surface.nodeOf[i] >= 0 && isCenter[surface.nodeOf[i]])
                    found.push_back(i);
            });
        for (Index i : atCenter) {
            const auto &n = m.vert[i].cN();
            g.normal.col(patches.patchOf[surface.nodeOf[i]]) = Eigen::Vector3d(n[0], n[1], n[2]);
        }
    }
    return g;
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
/// \param tag one per vertex slot \param nodeTag n, 1 where free \param placed how many centres are not left out
/// \throw Error when these are less than half of them
template <class MeshType>
std::vector<Index> NearestNodes(const MeshType &m, const SurfaceGraph &surface, const std::vector<int> &tag,
                                const std::vector<Index> &nodeTag, const Eigen::Matrix3Xd &centers, Index &placed) {
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
            if (tag[i] != 1 && surface.nodeOf[i] < 0 && !m.vert[i].IsD()) {
                const Eigen::Vector3d p = surface.frame.ToFrame(vcg::tri::PositionOf(m.vert[i]));
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

/// How each node of a surface is held.
struct Constraints {
    std::vector<Index> tag;                  ///< n: 0 fixed, 1 free, from 2 handles; -1, -2, ... single nodes
    std::vector<Index> original;             ///< tag of the single nodes before, -1 for point handles
    std::map<Index, Eigen::Matrix4d> motion; ///< of every tag but 1, at the pose wanted, mesh units
    std::map<Index, bool> rotates;           ///< tags whose motion is told to turn
    std::map<std::size_t, Eigen::Matrix4d> pointMotion; ///< of point handles at vertices that are no surface, by slot

    static bool IsSingle(Index t) { return t < 0; }
    bool IsFixed(Index t) const { return t == 0 || (IsSingle(t) && original[-1 - t] == 0); }

    /// Holds node \p u, alone. \return its tag
    Index HoldAlone(Index u, Index tagBefore) {
        original.push_back(tagBefore);
        return tag[u] = -Index(original.size());
    }
};

/// \throw Error when \p motion leads so far that the numbers do not hold what follows from it
inline void ExpectNear(const Frame &frame, const Eigen::Matrix4d &motion, const std::string &name) {
    const double most = 1e30; // frame units; floats end at 3e38
    if (!(frame.ToFrame(motion).matrix().cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= most))
        throw Error(name + " moves too far: beyond 1e30 times the size of the mesh. Check its motion, and the pose.");
}

/// The mean position of the vertices of each handle, mesh units.
template <class MeshType>
std::map<Index, Eigen::Vector3d> HandleCenters(const MeshType &m, const std::vector<int> &tag) {
    std::map<Index, std::pair<Eigen::Vector3d, double>> sums;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (tag[i] >= 2 && !m.vert[i].IsD()) {
            auto &sum = sums.emplace(tag[i], std::make_pair(Eigen::Vector3d::Zero().eval(), 0.0)).first->second;
            sum.first += vcg::tri::PositionOf(m.vert[i]);
            ++sum.second;
        }
    std::map<Index, Eigen::Vector3d> center;
    for (const auto &sum : sums)
        center[sum.first] = sum.second.first / sum.second.second;
    return center;
}

/// A node that is held without a neighbour that is held alike, and not told to turn, has no orientation of its own:
/// only its position is constrained. (Holding its orientation leaves a bump around it.)
template <class MeshType>
Constraints MakeConstraints(const MeshType &m, const SurfaceGraph &surface, const Handles &handles, double pose,
                            const Progress &progress) {
    Constraints c;
    c.tag = surface.tag;
    c.motion[0].setIdentity();
    for (const auto &center : HandleCenters(m, handles.tag)) {
        const auto given = handles.motion.find(center.first);
        const Motion motion = given == handles.motion.end() ? Motion() : given->second;
        c.motion[center.first] = handles.ToMesh(motion.At(pose, handles.world * center.second));
        ExpectNear(surface.frame, c.motion[center.first], "Handle " + std::to_string(center.first));
        c.rotates[center.first] =
            motion.matrix.topLeftCorner<3, 3>() != Eigen::Matrix3d::Identity() || !motion.turn.isZero(0);
    }

    const std::vector<Index> alone =
        CollectInOrder(progress, "Reading the handles", surface.graph.Size(), [&](Index u, std::vector<Index> &found) {
            if (c.tag[u] == 1)
                return;
            bool free = false;
            for (Index v : surface.graph.adjacency[u]) {
                if (c.tag[v] == c.tag[u])
                    return;
                free |= c.tag[v] == 1;
            }
            if (free)
                found.push_back(u);
        });
    for (std::size_t i = 0; i < handles.point.size(); ++i) {
        const PointHandle &point = handles.point[i];
        const std::string name = "Point handle " + std::to_string(i + 1);
        if (point.vertex >= surface.nodeOf.size() || m.vert[point.vertex].IsD())
            throw Error(name + " is at vertex " + std::to_string(point.vertex) + ", which does not exist.");
        if (!point.target.allFinite())
            throw Error(name + " has a target that is not finite.");
        const Index node = surface.nodeOf[point.vertex];
        if (node >= 0 ? c.IsSingle(c.tag[node]) : c.pointMotion.count(point.vertex) > 0) {
            std::size_t other = 0;
            while (surface.nodeOf[handles.point[other].vertex] != node ||
                   (node < 0 && handles.point[other].vertex != point.vertex))
                ++other;
            throw Error(name + " is at the same place as point handle " + std::to_string(other + 1) +
                        "; leave one of them out.");
        }
        if (node < 0 ? handles.tag[point.vertex] != 1 : c.tag[node] != 1)
            throw Error(name + " is at vertex " + std::to_string(point.vertex) +
                        ", which is held already; point handles belong where the surface is free.");
        Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
        motion.topRightCorner<3, 1>() = (point.target - vcg::tri::PositionOf(m.vert[point.vertex])) * (pose / 100);
        ExpectNear(surface.frame, motion, name);
        if (node < 0)
            c.pointMotion[point.vertex] = motion;
        else
            c.motion[c.HoldAlone(node, -1)] = motion;
    }
    for (Index u : alone) {
        const Index before = c.tag[u];
        const Eigen::Matrix4d motion = c.motion.at(before);
        const bool rotates = c.rotates[before];
        const Index t = c.HoldAlone(u, before);
        c.motion[t] = motion;
        c.rotates[t] = rotates;
    }
    return c;
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
        if (given.turns[j] && Constraints::IsSingle(tag[patches.center[j]])) {
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
                                      const Patches &patches, const SmallParts &small, const Constraints &constraints,
                                      const std::map<Index, Eigen::Affine3d> &motion) {
    const Index k = graph.Size();
    NodeConstraints given{std::vector<bool>(k), std::vector<bool>(k), std::vector<double>(k, 0),
                          std::vector<Eigen::Affine3d>(k, Eigen::Affine3d::Identity())};
    for (Index j = 0; j < k; ++j) {
        const Index t = tag[patches.center[j]];
        if (t == 1)
            continue;
        const auto rotates = constraints.rotates.find(t);
        given.constrained[j] = true;
        given.turns[j] = !(constraints.IsSingle(t) && rotates != constraints.rotates.end() && rotates->second);
        given.heldArea[j] = constraints.IsSingle(t) ? 0 : std::numeric_limits<double>::infinity();
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

/// Angle of a rotation given as a unit quaternion (w, x, y, z).
inline float DegreesOf(const Eigen::Vector4d &q) {
    return float(2 * std::atan2(q.tail<3>().norm(), std::abs(q[0])) * 180 / EIGEN_PI);
}

/// Stretch and rotation of the surface at each vertex, from its edges; what they leave open is as the patch turned.
/// \param elsewhere elsewhere(slot): the linear map of a vertex that is no node of the surface
template <class MeshType, class Elsewhere>
void Measure(const MeshType &m, const SurfaceGraph &surface, const Patches &patches, const GraphPose &pose,
             const Elsewhere &elsewhere, const Progress &progress, DeformationResult &result) {
    const std::size_t slots = m.vert.size();
    const Index n = surface.graph.Size();
    Eigen::Matrix3Xf posed(3, n); // vertices of one node share their position
    for (std::size_t i = 0; i < slots; ++i)
        if (surface.nodeOf[i] >= 0)
            posed.col(surface.nodeOf[i]) =
                surface.frame.ToFrame(Eigen::Vector3d(result.position.col(i))).template cast<float>();
    std::vector<float> stretch(n), rotation(n);
    ParallelFor(progress, "Measuring the deformation", n, 1 << 12, [&](std::size_t first, std::size_t last) {
        for (std::size_t u = first; u < last; ++u) {
            Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
            double before = 0, after = 0;
            for (Index v : surface.graph.adjacency[Index(u)]) {
                const Eigen::Vector3d e =
                    (surface.graph.position.col(v) - surface.graph.position.col(u)).cast<double>();
                const Eigen::Vector3d f = (posed.col(v) - posed.col(u)).template cast<double>();
                s += e * f.transpose();
                before += e.squaredNorm();
                after += f.squaredNorm();
            }
            const Index at = patches.patchOf[u];
            const Eigen::Matrix3d patch = at < 0 ? Eigen::Matrix3d::Identity() : RotationOf(pose.linear[at]);
            const double size = std::sqrt(before * after);
            s += (size > 0 ? 1e-3 * size : 1) * patch.transpose();
            const Eigen::Vector4d q = FitQuaternion(s);
            stretch[u] = before > 0 ? float(std::sqrt(after / before)) : 1.f;
            rotation[u] = DegreesOf(q);
        }
    });
    result.stretch.assign(slots, 1);
    result.rotation.assign(slots, 0);
    for (std::size_t i = 0; i < slots; ++i)
        if (surface.nodeOf[i] >= 0) {
            result.stretch[i] = stretch[surface.nodeOf[i]];
            result.rotation[i] = rotation[surface.nodeOf[i]];
        } else if (!m.vert[i].IsD()) {
            const Eigen::Matrix3d linear = elsewhere(i);
            if (linear == Eigen::Matrix3d::Identity())
                continue;
            result.stretch[i] = float(linear.norm() / std::sqrt(3.0));
            result.rotation[i] = DegreesOf(FitQuaternion(linear.transpose()));
        }
}

} // namespace detail
} // namespace fcd

namespace tri {

/// Builds the centroidal deformation graph of a mesh (paper, sec. 2.1). The mesh is only read.
/// \param metric the linear part of the layer's matrix: lengths and areas are measured after it
/// \throw fcd::Error no vertices, a coordinate that is not finite, or a parameter out of range
/// \throw fcd::Cancelled
template <class MeshType>
fcd::CentroidalGraph BuildCentroidalGraph(const MeshType &m, const fcd::GraphParam &param,
                                          const fcd::Progress &progress = {},
                                          const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity()) {
    using namespace fcd;
    using fcd::Index; // vcg::tri has a function of that name
    param.Validate();
    const fcd::Stopwatch watch;
    const SurfaceGraph surface = BuildSurfaceGraph(m, nullptr, {}, metric, progress.Slice(0, 0.4));
    const double D = fcd::detail::TargetRadius(surface, param, ShapeConstants().patchRadius);
    const Patches patches = fcd::detail::Sample(surface, {}, param, D, progress.Slice(0.4, 0.9));
    const DeformationGraph graph = MakeDeformationGraph(surface.graph, {}, surface.nodeArea, patches,
                                                        GraphWeights::Border, progress.Slice(0.9, 0.95));
    CentroidalGraph result;
    result.geometry = fcd::detail::GeometryOf(m, surface, patches, graph, progress.Slice(0.95, 0.98));
    AssignLarge(result.patchOf, m.vert.size(), Index(-1));
    ParallelFor(progress.Slice(0.98, 1), "Building the graph", m.vert.size(), 1 << 16,
                [&](std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i)
                        if (surface.nodeOf[i] >= 0)
                            result.patchOf[i] = patches.patchOf[surface.nodeOf[i]];
                });
    const double scale = surface.frame.scale;
    result.iterations = patches.iterations;
    result.converged = patches.converged;
    result.cost = patches.cost * scale * scale;
    result.targetRadius = D * scale;
    result.averageEdge = surface.averageEdge * scale;
    result.surface = surface.report;
    std::vector<Index> componentOf;
    result.surface.components = ConnectedComponents(graph.graph.adjacency, componentOf);
    result.seconds = watch.Seconds();
    progress(1, "Building the graph");
    return result;
}

/// Deforms a mesh: fixed vertices and vertices outside the region of influence keep their position to the bit, handle
/// vertices are their motion of their rest position, the free ones follow as rigidly as possible. The mesh is only
/// read.
/// \throw fcd::Error no vertices, a coordinate that is not finite, wrong number of tags, no handle, nothing free, a
///        motion by more than 1e30 times the mesh, or a parameter out of range
/// \throw fcd::Cancelled
template <class MeshType>
fcd::DeformationResult DeformCentroidal(const MeshType &m, const fcd::Handles &handles,
                                        const fcd::DeformationParam &param, const fcd::Progress &progress = {}) {
    using namespace fcd;
    using fcd::Index; // vcg::tri has a function of that name
    param.Validate();
    DeformationResult result;
    result.tags = CountTags(m, handles.tag);
    result.tags.handle += Index(handles.point.size());
    result.tags.free -= Index(handles.point.size());
    if (result.tags.handle == 0)
        throw Error("There is no handle: no vertex has a tag of 2 or more. Mark the part to move with tag 2.");
    if (result.tags.free <= 0)
        throw Error("There is nothing to deform: no vertex is free. Mark the part that may bend with tag 1.");

    // Surface: what is free and not loose, and what holds it.
    fcd::Stopwatch watch;
    SurfaceGraph surface = ReadFreeSurface(m, handles.tag, {}, handles.world.linear(), progress.Slice(0, 0.2));
    fcd::detail::Constraints constraints =
        fcd::detail::MakeConstraints(m, surface, handles, param.pose, progress.Slice(0.2, 0.2));
    result.surface = surface.report;
    const LooseSurface loose = FindLoose(m, handles, surface, constraints.tag, progress.Slice(0.2, 0.25));
    result.surface.components = loose.components;
    result.surface.isolated += loose.isolated;
    result.looseParts = loose.parts;
    if (loose.isPartOfSurface) {
        surface = ReadFreeSurface(m, handles.tag, loose.partOf, handles.world.linear(), progress.Slice(0.25, 0.3));
        constraints = fcd::detail::MakeConstraints(m, surface, handles, param.pose, progress.Slice(0.3, 0.3));
    }
    const std::vector<Index> &tag = constraints.tag;

    // Graph.
    double D = fcd::detail::TargetRadius(surface, param.graph, param.shape.patchRadius);
    Patches patches;
    if (param.nodes.cols() == 0)
        patches = fcd::detail::Sample(surface, tag, param.graph, D, progress.Slice(0.3, 0.6));
    else {
        const std::vector<Index> nodes =
            fcd::detail::NearestNodes(m, surface, handles.tag, tag, param.nodes, result.placedNodes);
        patches = GrowPatches(surface.graph, tag, nodes, progress.Slice(0.3, 0.6));
        D = 0;
        for (float radius : patches.radius)
            D = std::max(D, double(radius));
    }
    const fcd::detail::SmallParts small = fcd::detail::FindSmallParts(surface.graph, tag, D, param.shape);
    fcd::detail::OpenSmallParts(surface.graph, tag, small, patches, progress.Slice(0.6, 0.6));
    AddHeldPatches(surface.graph, tag, patches, progress.Slice(0.6, 0.6));
    const DeformationGraph graph =
        MakeDeformationGraph(surface.graph, tag, surface.nodeArea, patches, param.graphWeights,
                             progress.Slice(0.6, 0.61), param.shape.leastWeight);
    result.secondsGraph = watch.Seconds();

    // Motion of the graph.
    watch = {};
    std::map<Index, Eigen::Affine3d> motion;
    for (const auto &each : constraints.motion)
        motion[each.first] = surface.frame.ToFrame(each.second);
    NodeConstraints given = fcd::detail::ConstrainNodes(graph, tag, patches, small, constraints, motion);
    if (!constraints.original.empty())
        fcd::detail::TurnTogether(graph, tag, patches, given);
    SolverParam solver;
    solver.smoothness = param.smoothness;
    solver.maxIterations = param.maxIterations;
    solver.tolerance = param.tolerance;
    std::vector<double> area(graph.Size(), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (patches.patchOf[u] >= 0)
            area[patches.patchOf[u]] += surface.nodeArea[u];
    GraphPose pose = SolveParts(graph, area, given, solver, param.shape.heldDepth, progress.Slice(0.61, 0.75));
    std::vector<bool> hasMotion(graph.Size());
    for (Index j = 0; j < graph.Size(); ++j)
        hasMotion[j] = given.constrained[j] && !given.turns[j];
    FitLinear(graph, hasMotion, pose, param.shape.openness);
    for (Index j = 0; j < graph.Size(); ++j) {
        const Index t = tag[patches.center[j]];
        if (constraints.IsSingle(t) && given.turns[j]) { // run over into the motion that the surface makes there
            Eigen::Affine3d &there = motion[t];
            there.linear() = pose.linear[j];
            there.translation() = pose.position.col(j) - pose.linear[j] * graph.graph.position.col(j).cast<double>();
        }
    }
    result.secondsSolve = watch.Seconds();

    // Mesh.
    watch = {};
    const GraphMapping mapping(surface.graph, tag, patches, graph, param.weights, param.influence,
                               param.shape.runOver * D, progress.Slice(0.75, 0.85), param.shape);
    const GraphMapping::Posed mapped = mapping.At(pose, motion);
    const std::vector<Eigen::Matrix4d> looseMotion =
        LooseMotions(m, handles, surface, loose, param.looseParts == LooseParts::Follow, constraints.motion,
                     constraints.pointMotion, [&](Index u, const Eigen::Vector3d &p) -> Eigen::Affine3d {
                         Eigen::Affine3d there = Eigen::Affine3d::Identity();
                         const Index j = patches.patchOf[u];
                         there.linear() = fcd::detail::RotationOf(pose.linear[j]);
                         there.translation() = mapped(u, p) - there.linear() * p;
                         return there;
                     });
    const auto matrixAt = [&](std::size_t i) -> const Eigen::Matrix4d & { // of a vertex that is no node of the surface
        if (handles.tag[i] == 1 && !loose.partOf.empty() && loose.partOf[i] >= 0)
            return looseMotion[loose.partOf[i]];
        return constraints.motion.at(handles.tag[i] == 1 ? 0 : std::max(0, handles.tag[i]));
    };
    const Eigen::Matrix4d still = Eigen::Matrix4d::Identity();
    const bool isSurface = param.weights == MappingWeights::Surface; // no other part has an influence
    bool moves = !constraints.pointMotion.empty();
    for (const auto &each : constraints.motion)
        moves |= each.second != Eigen::Matrix4d::Identity();
    const std::size_t slotCount = m.vert.size(), block = 1 << 19; // progress is reported between blocks
    result.position.resize(3, slotCount);
    if (param.linear)
        result.linear.resize(slotCount);
    for (std::size_t start = 0; start < slotCount; start += block) {
        progress(0.85 + 0.1 * double(start) / slotCount, "Mapping to the mesh");
        ParallelFor(
            progress.threads, std::min(block, slotCount - start), 1 << 12, [&](std::size_t first, std::size_t last) {
                for (std::size_t i = start + first; i < start + last; ++i) {
                    const Eigen::Vector3d p = PositionOf(m.vert[i]);
                    const Index node = surface.nodeOf[i];
                    const bool isFree = node >= 0 && tag[node] == 1;
                    const bool isBent =
                        moves && isFree && !m.vert[i].IsD() && !(isSurface && pose.rests[patches.patchOf[node]]);
                    Eigen::Matrix3d linear;
                    if (isBent) {
                        result.position.col(i) = surface.frame.FromFrame(
                            mapped(node, surface.frame.ToFrame(p), param.linear ? &linear : nullptr));
                        if (param.linear)
                            linear = surface.frame.inverseMetric * linear * surface.frame.metric;
                    } else {
                        // Vertices of a seam may have different tags.
                        const bool stays =
                            !moves || m.vert[i].IsD() || isFree || (node >= 0 && constraints.IsFixed(tag[node]));
                        const Eigen::Matrix4d &matrix = stays       ? still
                                                        : node >= 0 ? constraints.motion.at(tag[node])
                                                                    : matrixAt(i);
                        result.position.col(i) =
                            matrix.isIdentity(0) ? p : Eigen::Vector3d((matrix * p.homogeneous()).template head<3>());
                        linear = matrix.topLeftCorner<3, 3>();
                    }
                    if (param.linear)
                        result.linear[i] = linear.template cast<float>();
                }
            });
    }
    for (const auto &point : constraints.pointMotion)
        result.position.col(point.first) += point.second.topRightCorner<3, 1>();
    result.check.rigid = fcd::detail::MovesAsOne(tag, constraints.motion);
    result.check.overruled = fcd::detail::CountOverruled(surface, handles.tag);
    fcd::detail::CheckEdgesBetweenHeld(m, surface.frame, handles.tag, result.position, progress.Slice(0.95, 0.96),
                                       result.check);
    std::vector<Eigen::Matrix3d> turns = pose.linear; // of the surface in each patch
    for (Index j = 0; j < graph.Size(); ++j)
        if (graph.IsHeld(j))
            turns[j] = given.motion[j].linear();
    result.check.folded =
        fcd::detail::CountFolded(m, surface, patches.patchOf, turns, result.position, progress.Slice(0.96, 0.97));
    if (param.measure)
        fcd::detail::Measure(
            m, surface, patches, pose, [&](std::size_t i) { return matrixAt(i).template topLeftCorner<3, 3>(); },
            progress.Slice(0.97, 0.99), result);
    result.secondsMap = watch.Seconds();

    const double scale = surface.frame.scale;
    result.rest = fcd::detail::GeometryOf(m, surface, patches, graph, progress.Slice(0.99, 1));
    result.rest.energy = Eigen::Map<const Eigen::VectorXd>(pose.nodeEnergy.data(), graph.Size()) * (scale * scale);
    result.deformed = result.rest;
    for (Index j = 0; j < graph.Size(); ++j) {
        const Eigen::Vector3d center = surface.graph.position.col(patches.center[j]).cast<double>(),
                              way = center - graph.graph.position.col(j).cast<double>();
        result.deformed.position.col(j) =
            surface.frame.FromFrame(Eigen::Vector3d(pose.position.col(j) + pose.linear[j] * way));
        const Eigen::Matrix3d map = graph.IsHeld(j) ? Eigen::Matrix3d(given.motion[j].linear()) : pose.linear[j];
        result.deformed.normal.col(j) = Cofactors(map) * result.rest.normal.col(j);
    }
    result.iterations = pose.iterations;
    result.converged = pose.converged;
    result.energy = pose.energy * scale * scale;
    progress(1, "Mapping to the mesh");
    return result;
}

} // namespace tri
} // namespace vcg

#endif
