// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CENTROIDAL_DEFORMATION_H
#define VCG_FCD_CENTROIDAL_DEFORMATION_H

#include "deformation_check.h"
#include "deformer.h"
#include "normals.h"
#include "rotation_fit.h"

#include <array>
#include <sstream>
#include <vcg/complex/complex.h>

/// Fast centroidal deformation in one call. After A. Morsucci, M. Centin, A. Signoroni: Fast centroidal deformation for
/// large mesh models, STAG 2018.

namespace vcg {
namespace fcd {

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
    Deformer::Pose pose;
};

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
            progress, "Building the graph", Index(surface.slots.size()), [&](Index s, std::vector<Index> &found) {
                const Index i = Index(surface.slots[s]);
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

/// Angle of a rotation given as a unit quaternion (w, x, y, z).
inline float DegreesOf(const Eigen::Vector4d &q) {
    return float(2 * std::atan2(q.tail<3>().norm(), std::abs(q[0])) * 180 / EIGEN_PI);
}

/// Stretch and rotation of the surface at each vertex, from its edges; what they leave open is as the patch turned.
inline void Measure(const Deformer &deformer, const Deformer::Pose &pose, const Carrier &carrier,
                    const Progress &progress, DeformationResult &result) {
    const SurfaceGraph &surface = deformer.surface;
    const Patches &patches = deformer.patches;
    const std::size_t slots = surface.nodeOf.size();
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
            const Eigen::Matrix3d patch = at < 0 ? Eigen::Matrix3d::Identity() : RotationOf(pose.graph.linear[at]);
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
        } else if (deformer.slotTag[i] != noVertex) {
            const Eigen::Matrix3d linear = carrier.MatrixAt(i).topLeftCorner<3, 3>();
            if (linear == Eigen::Matrix3d::Identity())
                continue;
            result.stretch[i] = float(linear.norm() / std::sqrt(3.0));
            result.rotation[i] = DegreesOf(FitQuaternion(linear.transpose()));
        }
}

/// What in the deformation of a mesh is probably not meant. \param position 3 x slots, deformed
template <class MeshType>
DeformationCheck Check(const MeshType &m, const Handles &handles, const Deformer &deformer, const Deformer::Pose &pose,
                       const Eigen::Matrix3Xd &position, const Progress &progress) {
    const SurfaceGraph &surface = deformer.surface;
    DeformationCheck check;
    check.rigid = MovesAsOne(deformer.held.tag, pose.given.motion);
    check.overruled = CountOverruled(surface, handles.tag);
    CheckEdgesBetweenHeld(m, surface.frame, surface.apart, position, check);
    std::vector<Eigen::Matrix3d> turns = pose.graph.linear; // of the surface in each patch
    for (Index j = 0; j < deformer.graph.Size(); ++j)
        if (deformer.graph.IsHeld(j))
            turns[j] = pose.nodeMotion[j].linear();
    check.folded = CountFolded(m, surface, deformer.patches.patchOf, turns, position, progress);
    return check;
}

/// The deformation graph before and after, in \p result.
template <class MeshType>
void ShowGraph(const MeshType &m, const Deformer &deformer, const Deformer::Pose &pose, const Progress &progress,
               DeformationResult &result) {
    const SurfaceGraph &surface = deformer.surface;
    const DeformationGraph &graph = deformer.graph;
    const double scale = surface.frame.scale;
    result.rest = GeometryOf(m, surface, deformer.patches, graph, progress);
    result.rest.energy =
        Eigen::Map<const Eigen::VectorXd>(pose.graph.nodeEnergy.data(), graph.Size()) * (scale * scale);
    result.deformed = result.rest;
    for (Index j = 0; j < graph.Size(); ++j) {
        const Eigen::Vector3d middle = surface.graph.position.col(deformer.patches.center[j]).cast<double>(),
                              way = middle - graph.graph.position.col(j).cast<double>();
        result.deformed.position.col(j) =
            surface.frame.FromFrame(Eigen::Vector3d(pose.graph.position.col(j) + pose.graph.linear[j] * way));
        const Eigen::Matrix3d map =
            graph.IsHeld(j) ? Eigen::Matrix3d(pose.nodeMotion[j].linear()) : pose.graph.linear[j];
        result.deformed.normal.col(j) = Cofactors(map) * result.rest.normal.col(j);
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

/// Counts the vertices by tag, point handles as handles.
/// \throw fcd::Error wrong number of tags, no handle, or nothing free
template <class MeshType>
fcd::TagCount CountHandles(const MeshType &m, const fcd::Handles &handles, unsigned threads = 0) {
    fcd::TagCount tags = CountTags(m, handles.tag, threads);
    tags.handle += fcd::Index(handles.point.size());
    tags.free -= fcd::Index(handles.point.size());
    if (tags.handle == 0)
        throw fcd::Error("There is no handle: no vertex has a tag of 2 or more. Mark the part to move with tag 2.");
    if (tags.free <= 0)
        throw fcd::Error("There is nothing to deform: no vertex is free. Mark the part that may bend with tag 1.");
    return tags;
}

/// Prepares a mesh to be deformed: reads the tags of \p handles and where its points are, not their motions. The mesh
/// is only read.
///
/// \param rest 3 x vertex slots: the mesh's positions, out
/// \throw fcd::Error as DeformCentroidal, but for motions
/// \throw fcd::Cancelled
template <class MeshType>
std::unique_ptr<fcd::Deformer> PrepareDeformer(const MeshType &m, const fcd::Handles &handles,
                                               const fcd::DeformerParam &param, Eigen::Matrix3Xd &rest,
                                               const fcd::Progress &progress = {}) {
    using namespace fcd;
    std::vector<std::size_t> point;
    for (const PointHandle &p : handles.point) {
        if (p.vertex >= m.vert.size() || m.vert[p.vertex].IsD())
            throw Error("Point handle " + std::to_string(point.size() + 1) + " is at vertex " +
                        std::to_string(p.vertex) + ", which does not exist.");
        point.push_back(p.vertex);
    }
    std::vector<int> slotTag;
    AssignLarge(slotTag, m.vert.size(), 0);
    rest.resize(3, Eigen::Index(m.vert.size()));
    PreferLargePages(rest.data(), std::size_t(rest.size()) * sizeof(double));
    ParallelFor(progress.threads, m.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            slotTag[i] = m.vert[i].IsD() ? noVertex : std::max(-1, handles.tag[i]);
            rest.col(Eigen::Index(i)) = PositionOf(m.vert[i]);
        }
    });
    SurfaceGraph surface =
        ReadFreeSurface(m, handles.tag, {}, handles.world.linear(), progress.Slice(0, 0.25), param.weldDistance, &rest);
    HeldNodes held = HoldNodes(surface, slotTag, point, progress.Slice(0.25, 0.25));
    LooseSurface loose = FindLoose(slotTag, point, surface, held.tag, progress.Slice(0.25, 0.3));
    if (loose.isPartOfSurface) {
        surface = ReadFreeSurface(m, handles.tag, loose.partOf, handles.world.linear(), progress.Slice(0.3, 0.4),
                                  param.weldDistance, &rest);
        held = HoldNodes(surface, slotTag, point, progress.Slice(0.4, 0.4));
    }
    return std::make_unique<Deformer>(std::move(surface), std::move(held), std::move(loose), std::move(slotTag), point,
                                      rest, param, progress.Slice(0.4, 1));
}

/// Poses a prepared mesh. The mesh is only read.
/// \param result in: its position is that at rest, 3 x slots; out: all but the counts of tags
/// \throw fcd::Error a motion by more than 1e30 times the mesh \throw fcd::Cancelled
template <class MeshType>
void PoseMesh(const MeshType &m, const fcd::Handles &handles, fcd::Deformer &deformer,
              const fcd::DeformationParam &param, const fcd::Progress &progress, fcd::DeformationResult &result) {
    using namespace fcd;
    const SurfaceGraph &surface = deformer.surface;
    result.surface = surface.report;
    result.surface.components = deformer.loose.components;
    result.surface.isolated += deformer.loose.isolated;
    result.looseParts = deformer.loose.parts;
    result.placedNodes = deformer.placedNodes;

    fcd::Stopwatch watch;
    result.pose = deformer.Solve(handles, param, progress.Slice(0, 0.4));
    const Deformer::Pose &pose = result.pose;
    result.iterations = pose.iterations;
    result.converged = pose.graph.converged;
    result.energy = pose.graph.energy * surface.frame.scale * surface.frame.scale;
    result.secondsSolve = watch.Seconds();

    watch = {};
    const fcd::Carrier carrier(deformer, pose);
    carrier.Apply(result.position, param.linear ? &result.linear : nullptr, progress.Slice(0.4, 0.8));
    result.check = fcd::detail::Check(m, handles, deformer, pose, result.position, progress.Slice(0.8, 0.9));
    if (param.measure)
        fcd::detail::Measure(deformer, pose, carrier, progress.Slice(0.9, 0.96), result);
    result.secondsMap = watch.Seconds();
    fcd::detail::ShowGraph(m, deformer, pose, progress.Slice(0.96, 1), result);
    progress(1, "Mapping to the mesh");
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
    param.Validate();
    DeformationResult result;
    result.tags = CountHandles(m, handles, progress.threads);
    const fcd::Stopwatch watch;
    const std::unique_ptr<Deformer> deformer =
        PrepareDeformer(m, handles, param, result.position, progress.Slice(0, 0.75));
    const double seconds = watch.Seconds();
    PoseMesh(m, handles, *deformer, param, progress.Slice(0.75, 1), result);
    result.secondsGraph = seconds - deformer->secondsMap;
    result.secondsMap += deformer->secondsMap;
    return result;
}

} // namespace tri
} // namespace vcg

#endif
