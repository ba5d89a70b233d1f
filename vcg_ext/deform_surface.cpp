// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/deformer.h>
#include <vcg_ext/map/normals.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace vcg {
namespace fcd {

namespace {

GraphGeometry GeometryOf(const NormalOf &normal, const SurfaceGraph &surface, const Patches &patches,
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
    if (normal) {
        std::vector<bool> isCenter(surface.graph.Size(), false);
        for (Index c : patches.center)
            isCenter[c] = true;
        const std::vector<Index> atCenter = CollectInOrder(
            progress, "Building the graph", Index(surface.slots.size()), [&](Index s, std::vector<Index> &found) {
                const Index i = Index(surface.slots[s]);
                if (surface.nodeOf[i] >= 0 && isCenter[surface.nodeOf[i]])
                    found.push_back(i);
            });
        for (Index i : atCenter)
            g.normal.col(patches.patchOf[surface.nodeOf[i]]) = normal(std::size_t(i));
    }
    return g;
}

/// Angle of a rotation given as a unit quaternion (w, x, y, z).
float DegreesOf(const Eigen::Vector4d &q) {
    return float(2 * detail::ArcTangent(q.tail<3>().norm(), std::abs(q[0])) * 180 / detail::pi);
}

/// The deformation graph before and after, in \p result.
void ShowGraph(const NormalOf &normal, const Deformer &deformer, const Deformer::Pose &pose, const Progress &progress,
               DeformationResult &result) {
    const SurfaceGraph &surface = deformer.surface;
    const DeformationGraph &graph = deformer.graph;
    const double scale = surface.frame.scale;
    result.rest = GeometryOf(normal, surface, deformer.patches, graph, progress);
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

} // namespace

// From the edges; what they leave open is as the patch turned.
SurfaceMeasure MeasurePose(const Deformer &deformer, const Deformer::Pose &pose, const Carrier &carrier,
                           const PositionsRef &position, const Progress &progress) {
    const SurfaceGraph &surface = deformer.surface;
    const Patches &patches = deformer.patches;
    const std::size_t slots = surface.nodeOf.size();
    const Index n = surface.graph.Size();
    Eigen::Matrix3Xf posed(3, n); // vertices of one node share their position
    for (std::size_t i = 0; i < slots; ++i)
        if (surface.nodeOf[i] >= 0)
            posed.col(surface.nodeOf[i]) =
                surface.frame.ToFrame(Eigen::Vector3d(position.col(i))).template cast<float>();
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
            const Eigen::Matrix3d patch =
                at < 0 ? Eigen::Matrix3d::Identity() : detail::RotationOf(pose.graph.linear[at]);
            const double size = std::sqrt(before * after);
            s += (size > 0 ? 1e-3 * size : 1) * patch.transpose();
            const Eigen::Vector4d q = detail::FitQuaternion(s);
            stretch[u] = before > 0 ? float(std::sqrt(after / before)) : 1.f;
            rotation[u] = DegreesOf(q);
        }
    });
    SurfaceMeasure result;
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
            result.rotation[i] = DegreesOf(detail::FitQuaternion(linear.transpose()));
        }
    return result;
}

DeformationCheck CheckPose(const SurfaceView &mesh, const Handles &handles, const Deformer &deformer,
                           const Deformer::Pose &pose, const PositionsRef &position, const Progress &progress) {
    const SurfaceGraph &surface = deformer.surface;
    DeformationCheck check;
    check.rigid = detail::MovesAsOne(deformer.held.tag, pose.given.motion);
    check.overruled = detail::CountOverruled(surface, handles.tag);
    detail::CheckEdgesBetweenHeld(mesh, surface.frame, surface.apart, position, check);
    std::vector<Eigen::Matrix3d> turns = pose.graph.linear; // of the surface in each patch
    for (Index j = 0; j < deformer.graph.Size(); ++j)
        if (deformer.graph.IsHeld(j))
            turns[j] = pose.nodeMotion[j].linear();
    check.flipped = detail::CountFlipped(mesh, surface, deformer.patches.patchOf, turns, position, progress);
    return check;
}

CentroidalGraph BuildCentroidalGraph(const SurfaceView &mesh, const NormalOf &normal, const GraphParam &param,
                                     const Progress &progress, const Eigen::Matrix3d &metric) {
    param.Validate();
    const Stopwatch watch;
    const SurfaceGraph surface = BuildSurfaceGraph(mesh, nullptr, {}, metric, progress.Slice(0, 0.4));
    const double D = TargetRadius(surface, param, ShapeConstants().patchRadius);
    const Patches patches = SampleSurface(surface, {}, param, D, progress.Slice(0.4, 0.9));
    const DeformationGraph graph = MakeDeformationGraph(surface.graph, {}, surface.nodeArea, patches,
                                                        GraphWeights::Border, progress.Slice(0.9, 0.95));
    CentroidalGraph result;
    result.geometry = GeometryOf(normal, surface, patches, graph, progress.Slice(0.95, 0.98));
    AssignLarge(result.patchOf, mesh.vertexSlots, Index(-1));
    ParallelFor(progress.Slice(0.98, 1), "Building the graph", mesh.vertexSlots, 1 << 16,
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

void CarryPose(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
               const DeformationParam &param, const Progress &progress, DeformationResult &result) {
    assert(mesh.vertexSlots == deformer.slotTag.size() && handles.tag.size() == mesh.vertexSlots);
    assert(result.position.cols() == Eigen::Index(mesh.vertexSlots));
    result.surface = deformer.surface.report;
    result.surface.components = deformer.loose.components;
    result.surface.isolated += deformer.loose.isolated;
    result.looseParts = deformer.loose.parts;
    result.placedNodes = deformer.placedNodes;

    const Stopwatch watch;
    const Deformer::Pose &pose = result.pose;
    const Carrier carrier(deformer, pose, progress.threads);
    carrier.Apply(result.position, param.linear ? &result.linear : nullptr, progress.Slice(0, 0.66));
    result.check = CheckPose(mesh, handles, deformer, pose, result.position, progress.Slice(0.66, 0.83));
    if (param.measure) {
        SurfaceMeasure measure = MeasurePose(deformer, pose, carrier, result.position, progress.Slice(0.83, 0.94));
        result.stretch = std::move(measure.stretch);
        result.rotation = std::move(measure.rotation);
    }
    result.secondsMap = watch.Seconds();
    ShowGraph(normal, deformer, pose, progress.Slice(0.94, 1), result);
    progress(1, "Mapping to the mesh");
}

void PoseSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
                 const PoseSolver &solve, const DeformationParam &param, const Progress &progress,
                 DeformationResult &result) {
    const Stopwatch watch;
    result.pose = solve(progress.Slice(0, 0.4));
    result.iterations = result.pose.iterations;
    result.converged = result.pose.graph.converged;
    const double scale = deformer.surface.frame.scale;
    result.energy = result.pose.graph.energy * scale * scale;
    result.discretisationError = deformer.DiscretisationError(result.pose, param);
    result.secondsSolve = watch.Seconds();
    CarryPose(mesh, normal, handles, deformer, param, progress.Slice(0.4, 1), result);
}

DeformationResult DeformSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles,
                                const DeformationParam &param, const Progress &progress) {
    param.Validate();
    DeformationResult result;
    result.tags = CountHandles(handles, mesh.vertexSlots, mesh.deleted, progress.threads);
    const Stopwatch watch;
    const std::unique_ptr<Deformer> deformer = PrepareDeformer(mesh, handles, param, progress.Slice(0, 0.75));
    const double seconds = watch.Seconds();
    result.position = mesh.Copy(progress.threads);
    const auto solve = [&](const Progress &part) { return deformer->Solve(handles, param, part); };
    PoseSurface(mesh, normal, handles, *deformer, solve, param, progress.Slice(0.75, 1), result);
    result.secondsGraph = seconds - deformer->secondsMap;
    result.secondsMap += deformer->secondsMap;
    return result;
}

} // namespace fcd
} // namespace vcg
