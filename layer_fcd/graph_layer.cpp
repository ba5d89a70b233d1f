// SPDX-License-Identifier: GPL-3.0-or-later
#include "contrasting_colors.h"
#include "new_layers.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "layer_normals.h"
#include "rest_shape.h"

#include <cmath>

using vcg::fcd::Error;

static std::vector<vcg::Color4b> colorsOf(const vcg::fcd::GraphGeometry &graph) {
    return contrastingColors(std::size_t(graph.position.cols()), graph.edge);
}

Eigen::Matrix3Xd readNodes(const MeshModel &layer, const MeshModel *graph) {
    if (!graph)
        throw Error(
            "'graph_layer' names no layer of this document. Choose the layer whose vertices are the nodes, or untick "
            "'use_graph_layer'.");
    if (graph == &layer)
        throw Error(
            "'graph_layer' is the layer to deform itself. Choose the layer whose vertices are the nodes (one that "
            "'FCD: Build Deformation Graph' made, for example), or untick 'use_graph_layer'.");
    if (graph->cm.vn == 0)
        throw Error("The graph layer " + inQuotes(*graph) +
                    " has no vertices, so there are no nodes. Choose another layer, or untick 'use_graph_layer'.");
    return positionsIn(invertibleMatrixOf(layer), *graph);
}

// --- new ones ---

vcg::fcd::CentroidalGraph addGraphLayers(MeshDocument &document, MeshModel &layer, const BuildGraphParam &param,
                                         const Remark &remark, const vcg::fcd::Progress &progress) {
    vcg::fcd::CentroidalGraph graph =
        vcg::tri::BuildCentroidalGraph(layer.cm, param.graph, progress.Slice(0, 0.9), metricOf(layer));

    const vcg::fcd::Progress adding = progress.Slice(0.9, 1);
    adding(0, "Adding layers...");
    NewLayers layers(document, layer, remark);
    MeshModel &nodes = layers.addGraph("graph", graph.geometry, false);
    if (param.surfaceLayer)
        layers.addGraphSurface("graph surface", graph.geometry);
    if (param.patchesLayer) {
        MeshModel &patches = layers.addPatches("patches", graph.patchOf, colorsOf(graph.geometry));
        if (host::inWindow() && layer.cm.fn > 0)
            patches.clearDataMask(MeshModel::MM_VERTCOLOR); // which would be shown instead, with blurred borders
    }
    layers.keep(layer, adding);
    if (host::inWindow()) { // show the result
        host::setVisible(layer, !param.patchesLayer);
        host::setVisible(nodes, !param.surfaceLayer);
        host::showChanges(document);
    }
    return graph;
}

MeshModel &NewLayers::addGraphSurface(const QString &what, const vcg::fcd::GraphGeometry &graph) {
    // Thick enough to stand out of the surface, thin enough not to cover the patches.
    const double ball = 0.2, tube = 0.07; // of the mean radius of the patches
    const double radius = graph.radius.size() > 0 ? graph.radius.mean() : 0;
    const int around = 8, along = 6; // corners of a ring; rings of a ball from pole to pole
    const std::size_t nodes = std::size_t(graph.position.cols());

    Eigen::Matrix3Xd place(3, around * (2 * Eigen::Index(graph.edge.size()) + (along + 1) * Eigen::Index(nodes)));
    std::vector<vcg::Color4b> color; // by vertex
    std::vector<std::array<std::size_t, 3>> faces;
    // Rings about the line through center along axis, each joined to the next one; at(ring): height and radius.
    const auto addRings = [&](const Eigen::Vector3d &center, const Eigen::Vector3d &axis, int rings, const auto &at,
                              const vcg::Color4b &shade) {
        const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
        for (int r = 0; r < rings; ++r)
            for (int k = 0; k < around; ++k) {
                const double angle = 2 * double(EIGEN_PI) * k / around;
                const auto [height, width] = at(r);
                const std::size_t low = color.size(), right = low - std::size_t(k) + std::size_t(k + 1) % around;
                place.col(Eigen::Index(low)) =
                    center + height * axis + width * (std::cos(angle) * u + std::sin(angle) * v);
                color.push_back(shade);
                if (r + 1 < rings) {
                    faces.push_back({low, right, right + around});
                    faces.push_back({low, right + around, low + around});
                }
            }
    };
    for (const auto &ends : graph.edge) {
        const Eigen::Vector3d from = graph.position.col(ends[0]), offset = graph.position.col(ends[1]) - from;
        const double length = offset.norm();
        addRings(
            from, length > 0 ? Eigen::Vector3d(offset / length) : Eigen::Vector3d::UnitZ(), 2,
            [&](int r) { return std::pair<double, double>(r * length, tube * radius); }, vcg::Color4b(60, 60, 60, 255));
    }
    const std::vector<vcg::Color4b> ofNode = colorsOf(graph);
    for (std::size_t i = 0; i < nodes; ++i)
        addRings(
            graph.position.col(Eigen::Index(i)), Eigen::Vector3d::UnitZ(), along + 1,
            [&](int r) {
                const double angle = double(EIGEN_PI) * r / along;
                return std::pair<double, double>(-ball * radius * std::cos(angle), ball * radius * std::sin(angle));
            },
            ofNode[i]);
    MeshModel &layer = addSurface(what, place, faces);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    for (std::size_t i = 0; i < color.size(); ++i)
        layer.cm.vert[i].C() = color[i];
    return layer;
}

MeshModel &NewLayers::addPoints(const QString &what, const Eigen::Matrix3Xd &points,
                                const std::vector<std::array<vcg::fcd::Index, 2>> &edges) {
    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    const auto count = std::size_t(points.cols());
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, count);
    for (std::size_t i = 0; i < count; ++i)
        mesh.vert[i].P() = toPoint(points.col(Eigen::Index(i)));
    auto edge = vcg::tri::Allocator<CMeshO>::AddEdges(mesh, edges.size());
    for (const auto &ends : edges) {
        for (int k = 0; k < 2; ++k)
            edge->V(k) = &mesh.vert[std::size_t(ends[std::size_t(k)])];
        ++edge;
    }
    computeBoxAndNormals(mesh);
    return layer;
}

MeshModel &NewLayers::addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph, bool isDeformed) {
    MeshModel &layer = addPoints(what, graph.position, graph.edge);
    CMeshO &mesh = layer.cm;
    layer.updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY);
    const std::vector<vcg::Color4b> color = colorsOf(graph);
    for (Eigen::Index i = 0; i < graph.position.cols(); ++i) {
        CVertexO &vertex = mesh.vert[std::size_t(i)];
        vertex.N() = toPoint(graph.normal.col(i)).Normalize(); // without a normal, MeshLab draws it black
        vertex.Q() = CVertexO::QualityType(graph.radius[i]);
        vertex.C() = color[std::size_t(i)];
    }
    if (graph.energy.size() > 0) {
        auto energy = vcg::tri::Allocator<CMeshO>::AddPerVertexAttribute<Scalarm>(mesh, "energy");
        for (Eigen::Index i = 0; i < graph.energy.size(); ++i)
            energy[std::size_t(i)] = Scalarm(graph.energy[i]);
    }
    LayerState::made(document, layer).graph = {base.id(), isDeformed, shapeOf(mesh)};
    return layer;
}

MeshModel &NewLayers::addSurface(const QString &what, const Eigen::Matrix3Xd &vertices,
                                 const std::vector<std::array<std::size_t, 3>> &faces) {
    MeshModel &layer = addPoints(what, vertices, {});
    CMeshO &mesh = layer.cm;
    auto face = vcg::tri::Allocator<CMeshO>::AddFaces(mesh, faces.size());
    for (const auto &corner : faces) {
        for (int c = 0; c < 3; ++c)
            face->V(c) = &mesh.vert[corner[std::size_t(c)]];
        ++face;
    }
    computeNormals(mesh);
    return layer;
}

MeshModel &NewLayers::addLine(const QString &what, const Eigen::Matrix3Xd &points) {
    std::vector<std::array<vcg::fcd::Index, 2>> edges;
    for (vcg::fcd::Index i = 1; i < points.cols(); ++i)
        edges.push_back({i - 1, i});
    MeshModel &layer = addPoints(what, points, edges);
    layer.cm.Tr.SetIdentity();
    for (CVertexO &vertex : layer.cm.vert)
        vertex.N() = Point3m(0, 0, 1); // without a normal, MeshLab draws it black
    return layer;
}
