// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CENTROIDAL_DEFORMATION_H
#define VCG_FCD_CENTROIDAL_DEFORMATION_H

#include "graph_mapping.h"

#include <array>
#include <vcg/complex/complex.h>

/// Fast centroidal deformation in one call. After A. Morsucci, M. Centin, A. Signoroni: Fast centroidal deformation for
/// large mesh models, STAG 2018.

namespace vcg {
namespace fcd {

/// How the deformation graph is built.
struct GraphParam {
    double targetRadius = 0;  ///< D, mesh units, >= 0; 0 = 0.7 x average edge x sqrt(vertices / initialPatches)
    int initialPatches = 300; ///< k0, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< of the cost, [0, 1)
    unsigned randomSeed = 1;

    /// \throw Error naming the value that is out of range
    void Validate() const {
        if (!(targetRadius >= 0) || std::isinf(targetRadius))
            throw Error("The target radius must be 0 (automatic) or a positive length.");
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
    double tolerance = SolverParam().tolerance;      ///< of the solver, fraction of the diagonal, > 0
    GraphWeights graphWeights = GraphWeights::Border;
    MappingWeights weights = MappingWeights::Surface;
    double influence = 4; ///< node radius over patch radius, > 1
    LooseParts looseParts = LooseParts::Follow;
    double pose = 100;    ///< percent of the handles' motion
    bool measure = false; ///< also measure stretch and rotation of the surface

    /// \throw Error naming the value that is out of range
    void Validate() const {
        graph.Validate();
        if (!(smoothness >= 0) || std::isinf(smoothness))
            throw Error("The smoothness must be 0 or positive.");
        if (maxIterations < 1)
            throw Error("The maximum number of iterations must be at least 1.");
        if (!(tolerance > 0) || std::isinf(tolerance))
            throw Error("The tolerance must be positive.");
        if (!(influence > 1) || std::isinf(influence))
            throw Error("The influence must be above 1: each node has to reach beyond its own patch.");
        if (!std::isfinite(pose))
            throw Error("The pose must be a percentage.");
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
    Eigen::Matrix3Xd position;    ///< 3 x vertex slots, mesh units; that of a deleted vertex stays where it is
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
    Index looseParts = 0; ///< connected components without a fixed or handle vertex
};

namespace detail {

template <class MeshType>
GraphGeometry GeometryOf(const MeshType &m, const SurfaceGraph &surface, const Patches &patches,
                         const DeformationGraph &graph, const Progress &progress = {}) {
    GraphGeometry g;
    g.position.resize(3, graph.Size());
    g.normal = Eigen::Matrix3Xd::Zero(3, graph.Size());
    g.radius.resize(graph.Size());
    for (Index i = 0; i < graph.Size(); ++i) {
        g.position.col(i) = surface.frame.FromFrame(graph.graph.position.col(i).template cast<double>());
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

/// The nodes of \p surface nearest to \p centers (3 x k, mesh units), each once.
inline std::vector<Index> NearestNodes(const SurfaceGraph &surface, const Eigen::Matrix3Xd &centers) {
    NodeTree tree(surface.graph.position);
    std::vector<bool> taken(surface.graph.Size(), false);
    std::vector<Index> node;
    for (Index i = 0; i < Index(centers.cols()); ++i) {
        if (!centers.col(i).allFinite())
            throw Error("A node of the deformation graph has a coordinate that is not a finite number.");
        const Eigen::Vector3f c = surface.frame.ToFrame(Eigen::Vector3d(centers.col(i))).cast<float>();
        unsigned nearest = 0;
        float d = 0;
        tree->doQueryClosest(tree.Point(c), nearest, d);
        if (!taken[nearest])
            node.push_back(Index(nearest));
        taken[nearest] = true;
    }
    return node;
}

/// D in frame units.
inline double TargetRadius(const SurfaceGraph &surface, const GraphParam &param) {
    if (param.targetRadius > 0)
        return param.targetRadius / surface.frame.scale;
    const double automatic = 0.7 * surface.averageEdge * std::sqrt(double(surface.graph.Size()) / param.initialPatches);
    return automatic > 0 ? automatic : 1; // no edges: every node is a patch whatever D is
}

inline PatchParam ToPatchParam(const GraphParam &param, double targetRadius) {
    PatchParam p;
    p.targetRadius = targetRadius;
    p.initialPatches = param.initialPatches;
    p.maxIterations = param.maxIterations;
    p.tolerance = param.tolerance;
    p.randomSeed = param.randomSeed;
    return p;
}

/// How each node of a surface is held.
struct Constraints {
    std::vector<Index> tag;      ///< n: 0 fixed, 1 free, from 2 handles; -1, -2, ... single nodes that turn freely
    std::vector<Index> original; ///< tag of the single nodes before, -1 for point handles
    std::map<Index, Eigen::Matrix4d> motion; ///< of every tag but 1, at the pose wanted, mesh units

    static bool Turns(Index t) { return t < 0; }
    bool IsFixed(Index t) const { return t == 0 || (Turns(t) && original[-1 - t] == 0); }

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

/// A node that is held without a neighbour that is held alike, and not told to turn, has no orientation of its own:
/// only its position is constrained. (Holding its orientation leaves a bump around it.)
template <class MeshType>
Constraints MakeConstraints(const MeshType &m, const SurfaceGraph &surface, const Handles &handles, double pose) {
    Constraints c;
    c.tag = NodeTags(surface, handles.tag);
    const Index n = surface.graph.Size();
    struct Sum {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();
        double count = 0;
    };
    std::map<Index, Sum> sums; // of the nodes of each handle
    for (Index u = 0; u < n; ++u)
        if (c.tag[u] >= 2) {
            Sum &sum = sums[c.tag[u]];
            sum.position += surface.graph.position.col(u).template cast<double>();
            ++sum.count;
        }
    c.motion[0].setIdentity();
    std::map<Index, bool> rotates{{0, false}};
    for (const auto &s : sums) {
        const auto given = handles.motion.find(s.first);
        const Motion motion = given == handles.motion.end() ? Motion() : given->second;
        c.motion[s.first] =
            motion.At(pose, surface.frame.FromFrame(Eigen::Vector3d(s.second.position / s.second.count)));
        ExpectNear(surface.frame, c.motion[s.first], "Handle " + std::to_string(s.first));
        rotates[s.first] = motion.matrix.topLeftCorner<3, 3>() != Eigen::Matrix3d::Identity();
    }

    const std::vector<Index> alone = CollectInOrder(Progress(), "", n, [&](Index u, std::vector<Index> &found) {
        if (c.tag[u] == 1 || rotates.at(c.tag[u]))
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
        const Index node = point.vertex < surface.nodeOf.size() ? surface.nodeOf[point.vertex] : -1;
        if (node < 0)
            throw Error(name + " is at vertex " + std::to_string(point.vertex) + ", which does not exist.");
        if (!point.target.allFinite())
            throw Error(name + " has a target that is not finite.");
        if (c.Turns(c.tag[node]))
            throw Error(name + " is at the same place as point handle " + std::to_string(-c.tag[node]) +
                        "; leave one of them out.");
        if (c.tag[node] != 1)
            throw Error(name + " is at vertex " + std::to_string(point.vertex) +
                        ", which is held already; point handles belong where the surface is free.");
        Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
        motion.topRightCorner<3, 1>() = (point.target - vcg::tri::PositionOf(m.vert[point.vertex])) * (pose / 100);
        ExpectNear(surface.frame, motion, name);
        c.motion[c.HoldAlone(node, -1)] = motion;
    }
    for (Index u : alone) {
        const Eigen::Matrix4d motion = c.motion.at(c.tag[u]);
        c.motion[c.HoldAlone(u, c.tag[u])] = motion;
    }
    return c;
}

/// The closest rotation between the constrained nodes before and after, as the rotation the nodes that turn begin with.
inline void TurnTogether(const DeformationGraph &graph, const std::vector<bool> &constrained,
                         const std::vector<bool> &turns, std::vector<Eigen::Affine3d> &motion) {
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    double count = 0;
    auto forConstrained = [&](const auto &body) {
        for (Index j = 0; j < graph.Size(); ++j)
            if (constrained[j]) {
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
        if (turns[j]) {
            const Eigen::Vector3d x = graph.graph.position.col(j).cast<double>(), y = motion[j] * x;
            motion[j].linear() = rotation;
            motion[j].translation() = y - rotation * x;
        }
}

/// Grows the patches anew where a held part of the surface is smaller than a patch: its node then stands for the free
/// surface around it, as any other, so that the surface follows it and not only the nearest vertices.
inline void OpenSmallHandles(const Graph &surface, const std::vector<Index> &tag, double D, Patches &patches,
                             const Progress &progress) {
    const Index k = patches.Size();
    auto maySmall = [&](Index j) { return patches.tag[j] != 1 && patches.radius[j] <= 0.5 * D; };
    bool any = false;
    for (Index j = 0; j < k; ++j)
        any |= maySmall(j);
    if (!any)
        return;
    const Csr dual = QuotientGraph(surface.adjacency, patches.patchOf, k, progress).adjacency;
    std::vector<char> small(k, 0), dropped(k, 0);
    any = false;
    for (Index j = 0; j < k; ++j) {
        bool whole = maySmall(j), free = false;
        for (Index i : dual[j]) {
            whole &= patches.tag[i] != patches.tag[j];
            free |= patches.tag[i] == 1;
        }
        small[j] = whole && free;
        any |= small[j];
    }
    if (!any)
        return;
    for (Index j = 0; j < k; ++j)
        for (Index i : dual[j])
            dropped[j] |= patches.tag[j] == 1 && small[i] &&
                          (surface.position.col(patches.center[i]) - surface.position.col(patches.center[j])).norm() <
                              0.5f * patches.radius[j];
    std::vector<Index> open(tag.size()), center;
    for (std::size_t u = 0; u < tag.size(); ++u)
        open[u] = small[patches.patchOf[u]] ? 1 : tag[u];
    for (Index j = 0; j < k; ++j)
        if (!dropped[j])
            center.push_back(patches.center[j]);
    patches = GrowPatches(surface, open, center, progress);
}

/// Stretch and rotation of the surface at each vertex, from its edges; what they leave open is as the patch turned.
template <class MeshType>
void Measure(const MeshType &m, const SurfaceGraph &surface, const Patches &patches, const GraphPose &pose,
             const Progress &progress, DeformationResult &result) {
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
            const Eigen::Matrix3d patch = RotationOf(pose.linear[patches.patchOf[u]]);
            const double size = std::sqrt(before * after);
            s += (size > 0 ? 1e-3 * size : 1) * patch.transpose();
            const Eigen::Vector4d q = FitQuaternion(s);
            stretch[u] = before > 0 ? float(std::sqrt(after / before)) : 1.f;
            rotation[u] = float(2 * std::atan2(q.tail<3>().norm(), std::abs(q[0])) * 180 / std::acos(-1.0));
        }
    });
    result.stretch.assign(slots, 1);
    result.rotation.assign(slots, 0);
    for (std::size_t i = 0; i < slots; ++i)
        if (surface.nodeOf[i] >= 0) {
            result.stretch[i] = stretch[surface.nodeOf[i]];
            result.rotation[i] = rotation[surface.nodeOf[i]];
        }
}

inline Index CountComponents(const DeformationGraph &graph) {
    std::vector<Index> componentOf;
    return ConnectedComponents(graph.graph.adjacency, componentOf);
}

} // namespace detail
} // namespace fcd

namespace tri {

/// Builds the centroidal deformation graph of a mesh (paper, sec. 2.1). The mesh is only read.
/// \throw fcd::Error no vertices, a coordinate that is not finite, or a parameter out of range
/// \throw fcd::Cancelled
template <class MeshType>
fcd::CentroidalGraph BuildCentroidalGraph(const MeshType &m, const fcd::GraphParam &param,
                                          const fcd::Progress &progress = {}) {
    using namespace fcd;
    using fcd::Index; // vcg::tri has a function of that name
    param.Validate();
    const fcd::Stopwatch watch;
    const SurfaceGraph surface = BuildSurfaceGraph(m, progress.Slice(0, 0.4));
    const double D = fcd::detail::TargetRadius(surface, param);
    const Patches patches =
        SamplePatches(surface.graph, {}, fcd::detail::ToPatchParam(param, D), progress.Slice(0.4, 0.9));
    const DeformationGraph graph = MakeDeformationGraph(surface.graph, patches, surface.averageEdge,
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
    result.surface.components = fcd::detail::CountComponents(graph);
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

    // Graph.
    fcd::Stopwatch watch;
    const SurfaceGraph surface = BuildSurfaceGraph(m, progress.Slice(0, 0.3));
    const fcd::detail::Constraints constraints = fcd::detail::MakeConstraints(m, surface, handles, param.pose);
    const std::vector<Index> &tag = constraints.tag;
    double D = fcd::detail::TargetRadius(surface, param.graph);
    Patches patches;
    if (param.nodes.cols() == 0)
        patches =
            SamplePatches(surface.graph, tag, fcd::detail::ToPatchParam(param.graph, D), progress.Slice(0.3, 0.6));
    else {
        patches =
            GrowPatches(surface.graph, tag, fcd::detail::NearestNodes(surface, param.nodes), progress.Slice(0.3, 0.6));
        D = *std::max_element(patches.radius.begin(), patches.radius.end());
    }
    fcd::detail::OpenSmallHandles(surface.graph, tag, D, patches, progress.Slice(0.6, 0.6));
    const DeformationGraph graph = MakeDeformationGraph(surface.graph, patches, surface.averageEdge, param.graphWeights,
                                                        progress.Slice(0.6, 0.61));
    result.secondsGraph = watch.Seconds();

    // Motion of the graph.
    watch = {};
    std::map<Index, Eigen::Affine3d> motion;
    for (const auto &each : constraints.motion)
        motion[each.first] = surface.frame.ToFrame(each.second);
    std::vector<bool> constrained(graph.Size()), turns(graph.Size());
    std::vector<Eigen::Affine3d> nodeMotion(graph.Size(), Eigen::Affine3d::Identity());
    for (Index j = 0; j < graph.Size(); ++j) {
        const Index t = tag[patches.center[j]];
        constrained[j] = t != 1;
        turns[j] = constraints.Turns(t);
        if (constrained[j])
            nodeMotion[j] = motion.at(t);
    }
    if (!constraints.original.empty())
        fcd::detail::TurnTogether(graph, constrained, turns, nodeMotion);
    const GraphDeformer deformer(graph, constrained, surface.area, turns);
    SolverParam solver;
    solver.smoothness = param.smoothness;
    solver.maxIterations = param.maxIterations;
    solver.tolerance = param.tolerance;
    GraphPose pose = deformer.Solve(nodeMotion, solver, progress.Slice(0.61, 0.75));
    if (param.looseParts == LooseParts::Follow)
        FollowNearest(graph, deformer, pose);
    FitLinear(graph, deformer, pose);
    for (Index j = 0; j < graph.Size(); ++j)
        if (turns[j]) { // run over into the motion that the surface makes there
            Eigen::Affine3d &there = motion[tag[patches.center[j]]];
            there.linear() = pose.linear[j];
            there.translation() = pose.position.col(j) - pose.linear[j] * graph.graph.position.col(j).cast<double>();
        }
    result.secondsSolve = watch.Seconds();

    // Mesh.
    watch = {};
    // Narrower run-overs crease, wider ones hold back what is free.
    const GraphMapping mapping(surface.graph, tag, patches, graph, param.weights, param.influence, 2.5 * D,
                               progress.Slice(0.75, 0.85));
    const GraphMapping::Posed mapped = mapping.At(pose, motion);
    const std::size_t slotCount = m.vert.size(), block = 1 << 19; // progress is reported between blocks
    result.position.resize(3, slotCount);
    for (std::size_t start = 0; start < slotCount; start += block) {
        progress(0.85 + 0.1 * double(start) / slotCount, "Mapping to the mesh");
        ParallelFor(
            progress.threads, std::min(block, slotCount - start), 1 << 12, [&](std::size_t first, std::size_t last) {
                for (std::size_t i = start + first; i < start + last; ++i) {
                    const Eigen::Vector3d p = PositionOf(m.vert[i]);
                    const Index node = surface.nodeOf[i];
                    const Index t = node < 0 ? 0 : tag[node]; // vertices of a seam may have different tags
                    if (constraints.IsFixed(t))
                        result.position.col(i) = p;
                    else if (t != 1)
                        result.position.col(i) = (constraints.motion.at(t) * p.homogeneous()).template head<3>();
                    else
                        result.position.col(i) = surface.frame.FromFrame(mapped(node, surface.frame.ToFrame(p)));
                }
            });
    }
    if (param.measure)
        fcd::detail::Measure(m, surface, patches, pose, progress.Slice(0.95, 1), result);
    result.secondsMap = watch.Seconds();

    const double scale = surface.frame.scale;
    result.rest = fcd::detail::GeometryOf(m, surface, patches, graph);
    result.rest.energy = Eigen::Map<const Eigen::VectorXd>(pose.nodeEnergy.data(), graph.Size()) * (scale * scale);
    result.deformed = result.rest;
    for (Index j = 0; j < graph.Size(); ++j) {
        result.deformed.position.col(j) = surface.frame.FromFrame(Eigen::Vector3d(pose.position.col(j)));
        result.deformed.normal.col(j) = pose.linear[j].inverse().transpose() * result.rest.normal.col(j);
    }
    result.iterations = pose.iterations;
    result.converged = pose.converged;
    result.energy = pose.energy * scale * scale;
    result.surface = surface.report;
    result.surface.components = deformer.Components();
    result.looseParts = deformer.LooseComponents();
    progress(1, "Mapping to the mesh");
    return result;
}

} // namespace tri
} // namespace vcg

#endif
