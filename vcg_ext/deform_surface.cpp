// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/deformer.h>
#include <vcg_ext/map/normals.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace vcg::fcd {

namespace {

GraphGeometry GeometryOf(const SurfaceGraph &surface, const Patches &patches, const DeformationGraph &graph) {
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
    return g;
}

/// Sets the normal of a patch's node, if \p node, of vertex \p slot, is the patch's centre.
void TakeNormal(const NormalOf &normal, std::uint32_t slot, Index node, const Patches &patches, GraphGeometry &g) {
    if (const Index patch = patches.patchOf[std::size_t(node)];
        patch >= 0 && patches.center[std::size_t(patch)] == node)
        g.normal.col(patch) = normal(slot);
}

/// The angle of a rotation, a unit quaternion (w, x, y, z), in degrees.
float DegreesOf(const Eigen::Vector4d &q) {
    return float(2 * detail::ArcTangent(q.tail<3>().norm(), std::abs(q[0])) * 180 / detail::pi);
}

/// Appends one graph to another.
void Append(const GraphGeometry &part, GraphGeometry &all) {
    const auto first = Index(all.position.cols()), added = Index(part.position.cols());
    all.position.conservativeResize(3, first + added);
    all.position.rightCols(added) = part.position;
    all.normal.conservativeResize(3, first + added);
    all.normal.rightCols(added) = part.normal;
    all.radius.conservativeResize(first + added);
    all.radius.tail(added) = part.radius;
    all.energy.conservativeResize(first + added);
    all.energy.tail(added) = part.energy;
    for (const auto &[i, j] : part.edge)
        all.edge.push_back({first + i, first + j});
}

/// Appends the graph of a region, at rest and deformed, to those of \p result.
void ShowGraph(const NormalOf &normal, const MovingRegion &region, const RegionPose &pose, DeformationResult &result) {
    const SurfaceGraph &surface = region.surface;
    const DeformationGraph &graph = region.graph;
    const double scale = surface.frame.scale;
    GraphGeometry rest = GeometryOf(surface, region.patches, graph);
    if (normal)
        for (const auto *list : {&region.bent, &region.beside})
            for (const MovingRegion::Bent &vertex : *list)
                TakeNormal(normal, vertex.slot, vertex.node, region.patches, rest);
    rest.energy = Eigen::Map<const Eigen::VectorXd>(pose.graph.nodeEnergy.data(), graph.Size()) * (scale * scale);
    GraphGeometry deformed = rest;
    for (Index j = 0; j < graph.Size(); ++j) {
        const Eigen::Vector3d middle = surface.graph.position.col(region.patches.center[j]).cast<double>(),
                              offset = middle - graph.graph.position.col(j).cast<double>();
        deformed.position.col(j) =
            surface.frame.FromFrame(Eigen::Vector3d(pose.graph.position.col(j) + pose.graph.linear[j] * offset));
        const Eigen::Matrix3d map =
            graph.IsHeld(j) ? Eigen::Matrix3d(pose.nodeMotion[j].linear()) : pose.graph.linear[j];
        deformed.normal.col(j) = Cofactors(map) * rest.normal.col(j);
    }
    Append(rest, result.rest);
    Append(deformed, result.deformed);
}

/// Stretch and rotation (degrees) of a pose at the n nodes of a region. \param posed 3 x n, frame units
void MeasureRegion(const MovingRegion &region, const RegionPose &pose, const Eigen::Matrix3Xf &posed,
                   std::vector<float> &stretch, std::vector<float> &rotation, const Progress &progress) {
    const SurfaceGraph &surface = region.surface;
    const Index n = surface.graph.Size();
    stretch.resize(std::size_t(n));
    rotation.resize(std::size_t(n));
    ParallelForEach(progress, "Measuring the deformation", n, 1 << 12, [&](std::size_t u) {
        Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
        double before = 0, after = 0;
        for (Index v : surface.graph.adjacency[Index(u)]) {
            const Eigen::Vector3d e = (surface.graph.position.col(v) - surface.graph.position.col(u)).cast<double>();
            const Eigen::Vector3d f = (posed.col(v) - posed.col(u)).template cast<double>();
            s += e * f.transpose();
            before += e.squaredNorm();
            after += f.squaredNorm();
        }
        const Index at = region.patches.patchOf[u];
        const Eigen::Matrix3d patch = at < 0 ? Eigen::Matrix3d::Identity() : detail::RotationOf(pose.graph.linear[at]);
        const double size = std::sqrt(before * after);
        s += (size > 0 ? 1e-3 * size : 1) * patch.transpose(); // decides what the edges leave open
        const Eigen::Vector4d q = detail::FitQuaternion(s);
        stretch[u] = before > 0 ? float(std::sqrt(after / before)) : 1.f;
        rotation[u] = DegreesOf(q);
    });
}

} // namespace

SurfaceMeasure MeasurePose(const Deformer &deformer, const Deformer::Pose &pose, const Carrier &carrier,
                           const PositionsRef &position, const Progress &progress) {
    const std::size_t slots = deformer.slotTag.size();
    SurfaceMeasure result;
    result.stretch.assign(slots, 1);
    result.rotation.assign(slots, 0);
    std::vector<float> stretch, rotation;                     // of the nodes of a region
    for (std::size_t r = deformer.regions.size(); r-- > 0;) { // a vertex of several regions shows the first
        const MovingRegion &region = *deformer.regions[r];
        const auto forVertices = [&](const auto &body) {
            for (const auto *list : {&region.beside, &region.bent})
                for (const MovingRegion::Bent &vertex : *list)
                    body(vertex);
        };
        Eigen::Matrix3Xf posed(3, region.surface.graph.Size()); // vertices of one node share their position
        forVertices([&](const MovingRegion::Bent &vertex) {
            posed.col(vertex.node) =
                region.surface.frame.ToFrame(Eigen::Vector3d(position.col(vertex.slot))).template cast<float>();
        });
        MeasureRegion(region, pose.region[r], posed, stretch, rotation, progress);
        forVertices([&](const MovingRegion::Bent &vertex) {
            result.stretch[vertex.slot] = stretch[std::size_t(vertex.node)];
            result.rotation[vertex.slot] = rotation[std::size_t(vertex.node)];
        });
    }
    for (std::size_t i = 0; i < slots; ++i)
        if (!deformer.At(i).region && deformer.slotTag[i] != noVertex) {
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
    DeformationCheck check;
    check.overruled = detail::CountOverruled(deformer, handles.tag);
    detail::CheckEdgesBetweenHeld(mesh, deformer.frame, deformer.apart, position, check);
    check.rigid = !deformer.regions.empty() || detail::MovesAsOne({}, pose.given.motion);
    for (std::size_t r = 0; r < deformer.regions.size(); ++r) {
        const MovingRegion &region = *deformer.regions[r];
        const RegionPose &posed = pose.region[r];
        check.rigid = check.rigid && detail::MovesAsOne(region.held.tag, posed.given.motion);
        check.volumeOff = std::max(check.volumeOff, posed.volumeOff);
        std::vector<Eigen::Matrix3d> turns = posed.graph.linear; // of the surface in each patch
        for (Index j = 0; j < region.graph.Size(); ++j)
            if (region.graph.IsHeld(j))
                turns[j] = posed.nodeMotion[j].linear();
        check.flipped += detail::CountFlipped(mesh, deformer, r, turns, position,
                                              progress.Slice(double(r) / double(deformer.regions.size()),
                                                             double(r + 1) / double(deformer.regions.size())));
    }
    return check;
}

SurfaceContact ContactOf(const SurfaceView &mesh, const Deformer &deformer, const PositionsRef &position,
                         const DeformerParam &param, const Progress &progress) {
    const double unit = detail::UnitOf(deformer.frame.scale);
    // The distance of welds, but no less than what the mapping rounds by.
    SurfaceContact contact = FindContact(mesh, position, deformer.frame.metric / unit,
                                         std::max(param.weldDistance, defaultWeldDistance), progress);
    contact.largest *= unit;
    for (double &depth : contact.depth)
        depth *= unit;
    return contact;
}

double PercentToContact(const SurfaceView &mesh, const Deformer &deformer,
                        const std::function<Deformer::Pose(double, const Progress &)> &solve,
                        const DeformationParam &param, const Progress &progress) {
    const LoopHelpers helpers;
    Eigen::Matrix3Xd position;
    double done = 0; // of eight tries: the whole motion, and seven of the bisection
    const auto isFree = [&](int hundredths) {
        const Progress part = progress.Slice(done / 8, (done + 1) / 8);
        ++done;
        const Deformer::Pose pose = solve(param.pose * hundredths / 100, part.Slice(0, 0.5));
        position = mesh.Positions();
        Carrier(deformer, pose, progress.threads).Apply(position, nullptr, part.Slice(0.5, 0.6));
        return ContactOf(mesh, deformer, position, param, part.Slice(0.6, 1)).face.empty();
    };
    if (isFree(100))
        return param.pose;
    int last = 0, first = 100; // the last that is free, the first that is not
    while (first - last > 1) {
        const int middle = (last + first) / 2;
        (isFree(middle) ? last : first) = middle;
    }
    return param.pose * last / 100;
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
    result.geometry = GeometryOf(surface, patches, graph);
    if (normal)
        for (std::uint32_t slot : surface.slots)
            TakeNormal(normal, slot, surface.nodeOf[slot], patches, result.geometry);
    AssignLarge(result.patchOf, mesh.vertexSlots, Index(-1));
    ParallelForEach(progress.Slice(0.98, 1), "Building the graph", mesh.vertexSlots, 1 << 16, [&](std::size_t i) {
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
    result.surface = deformer.report;
    result.looseParts = deformer.loose.parts;
    result.placedNodes = deformer.placedNodes;

    const Stopwatch watch;
    const Deformer::Pose &pose = result.pose;
    const Carrier carrier(deformer, pose, progress.threads);
    carrier.Apply(result.position, param.linear ? &result.linear : nullptr, progress.Slice(0, 0.66));
    result.check = CheckPose(mesh, handles, deformer, pose, result.position, progress.Slice(0.66, 0.75));
    if (param.contact || mesh.faces <= contactUnasked)
        result.contact = ContactOf(mesh, deformer, result.position, param, progress.Slice(0.75, 0.83));
    if (param.measure) {
        SurfaceMeasure measure = MeasurePose(deformer, pose, carrier, result.position, progress.Slice(0.83, 0.94));
        result.stretch = std::move(measure.stretch);
        result.rotation = std::move(measure.rotation);
    }
    result.secondsMap = watch.Seconds();
    progress(0.94, "Building the graph");
    for (std::size_t r = 0; r < deformer.regions.size(); ++r)
        ShowGraph(normal, *deformer.regions[r], pose.region[r], result);
    progress(1, "Mapping to the mesh");
}

void PoseSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
                 const PoseSolver &solve, const DeformationParam &param, const Progress &progress,
                 DeformationResult &result) {
    const LoopHelpers helpers;
    const Stopwatch watch;
    result.pose = solve(progress.Slice(0, 0.4));
    result.iterations = result.pose.iterations;
    result.converged = result.pose.converged;
    result.energy = result.pose.energy;
    result.discretisationError = deformer.DiscretisationError(result.pose, param);
    result.secondsSolve = watch.Seconds();
    CarryPose(mesh, normal, handles, deformer, param, progress.Slice(0.4, 1), result);
}

DeformationResult DeformSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles,
                                const DeformationParam &param, const Progress &progress) {
    param.Validate();
    DeformationResult result;
    result.tags = CountHandles(handles, mesh.vertexSlots, mesh.deleted);
    const Stopwatch watch;
    const std::unique_ptr<Deformer> deformer = PrepareDeformer(mesh, handles, param, progress.Slice(0, 0.75));
    const double seconds = watch.Seconds();
    result.position = mesh.Copy(progress.threads);
    const auto solve = [&](const Progress &part) { return deformer->Solve(handles, param, part); };
    PoseSurface(mesh, normal, handles, *deformer, solve, param, progress.Slice(0.75, 1), result);
    result.secondsGraph = seconds;
    return result;
}

} // namespace vcg::fcd
