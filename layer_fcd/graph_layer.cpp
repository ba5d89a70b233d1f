// SPDX-License-Identifier: GPL-3.0-or-later
#include "contrasting_colors.h"
#include "graph_layer.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "layer_normals.h"
#include "new_layers.h"
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
    const Eigen::Affine3d from = matrixOf(*graph), to = invertibleMatrixOf(layer);
    const bool same = from.matrix() == to.matrix();
    const Eigen::Affine3d change = to.inverse() * from;
    Eigen::Matrix3Xd nodes(3, graph->cm.vn);
    Eigen::Index next = 0;
    for (const CVertexO &vertex : graph->cm.vert)
        if (!vertex.IsD()) {
            const Eigen::Vector3d position = vcg::tri::PositionOf(vertex);
            nodes.col(next++) = same ? position : change * position;
        }
    return nodes;
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
    const std::size_t nodes = std::size_t(graph.position.cols()), edges = graph.edge.size();

    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(mesh, std::size_t(around) *
                                                                     (2 * edges + std::size_t(along + 1) * nodes));
    auto face =
        vcg::tri::Allocator<CMeshO>::AddFaces(mesh, std::size_t(2 * around) * (edges + std::size_t(along) * nodes));
    // Rings about the line through center along axis, each joined to the next one; at(ring): height and radius.
    const auto addRings = [&](const Eigen::Vector3d &center, const Eigen::Vector3d &axis, int rings, const auto &at,
                              const vcg::Color4b &color) {
        const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
        for (int r = 0; r < rings; ++r)
            for (int k = 0; k < around; ++k) {
                const double angle = 2 * double(EIGEN_PI) * k / around;
                const auto [height, width] = at(r);
                vertex->P() = toPoint(center + height * axis + width * (std::cos(angle) * u + std::sin(angle) * v));
                vertex->C() = color;
                if (r + 1 < rings) {
                    const int next = (k + 1) % around - k;
                    CVertexO *low = &*vertex, *right = low + next;
                    CVertexO *const corners[2][3] = {{low, right, right + around}, {low, right + around, low + around}};
                    for (const auto &corner : corners) {
                        for (int c = 0; c < 3; ++c)
                            face->V(c) = corner[c];
                        ++face;
                    }
                }
                ++vertex;
            }
    };
    for (const auto &ends : graph.edge) {
        const Eigen::Vector3d from = graph.position.col(ends[0]), way = graph.position.col(ends[1]) - from;
        const double length = way.norm();
        addRings(
            from, length > 0 ? Eigen::Vector3d(way / length) : Eigen::Vector3d::UnitZ(), 2,
            [&](int r) { return std::pair<double, double>(r * length, tube * radius); }, vcg::Color4b(60, 60, 60, 255));
    }
    const std::vector<vcg::Color4b> color = colorsOf(graph);
    for (std::size_t i = 0; i < nodes; ++i)
        addRings(
            graph.position.col(Eigen::Index(i)), Eigen::Vector3d::UnitZ(), along + 1,
            [&](int r) {
                const double angle = double(EIGEN_PI) * r / along;
                return std::pair<double, double>(-ball * radius * std::cos(angle), ball * radius * std::sin(angle));
            },
            color[i]);
    computeBoxAndNormals(layer.cm);
    return layer;
}

MeshModel &NewLayers::addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph, bool isDeformed) {
    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    layer.updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY);
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, std::size_t(graph.position.cols()));
    const std::vector<vcg::Color4b> color = colorsOf(graph);
    for (Eigen::Index i = 0; i < graph.position.cols(); ++i) {
        CVertexO &vertex = mesh.vert[std::size_t(i)];
        vertex.P() = toPoint(graph.position.col(i));
        vertex.N() = toPoint(graph.normal.col(i)).Normalize(); // without a normal, MeshLab draws it black
        vertex.Q() = CVertexO::QualityType(graph.radius[i]);
        vertex.C() = color[std::size_t(i)];
    }
    if (graph.energy.size() > 0) {
        auto energy = vcg::tri::Allocator<CMeshO>::AddPerVertexAttribute<Scalarm>(mesh, "energy");
        for (Eigen::Index i = 0; i < graph.energy.size(); ++i)
            energy[std::size_t(i)] = Scalarm(graph.energy[i]);
    }
    auto edge = vcg::tri::Allocator<CMeshO>::AddEdges(mesh, graph.edge.size());
    for (const auto &ends : graph.edge) {
        edge->V(0) = &mesh.vert[std::size_t(ends[0])];
        edge->V(1) = &mesh.vert[std::size_t(ends[1])];
        ++edge;
    }
    computeBoxAndNormals(layer.cm);
    LayerState::made(document, layer).graph = {base.id(), isDeformed, shapeOf(mesh)};
    return layer;
}

MeshModel &NewLayers::addSurface(const QString &what, const Eigen::Matrix3Xd &vertices,
                                 const std::vector<std::array<std::size_t, 3>> &faces) {
    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    const auto count = std::size_t(vertices.cols());
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, count);
    for (std::size_t i = 0; i < count; ++i)
        mesh.vert[i].P() = toPoint(vertices.col(Eigen::Index(i)));
    auto face = vcg::tri::Allocator<CMeshO>::AddFaces(mesh, faces.size());
    for (const auto &corner : faces) {
        for (int c = 0; c < 3; ++c)
            face->V(c) = &mesh.vert[corner[std::size_t(c)]];
        ++face;
    }
    computeBoxAndNormals(mesh);
    return layer;
}

MeshModel &NewLayers::addLine(const QString &what, const Eigen::Matrix3Xd &points) {
    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    mesh.Tr.SetIdentity();
    const auto count = std::size_t(points.cols());
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, count);
    for (std::size_t i = 0; i < count; ++i) {
        mesh.vert[i].P() = toPoint(points.col(Eigen::Index(i)));
        mesh.vert[i].N() = Point3m(0, 0, 1); // without a normal, MeshLab draws it black
    }
    auto edge = vcg::tri::Allocator<CMeshO>::AddEdges(mesh, count - 1);
    for (std::size_t i = 1; i < count; ++i, ++edge) {
        edge->V(0) = &mesh.vert[i - 1];
        edge->V(1) = &mesh.vert[i];
    }
    computeBoxAndNormals(mesh);
    return layer;
}
