// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_deformation.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "rest_shape.h"

#include <algorithm>
#include <utility>

using vcg::fcd::Error;

namespace {

/// Whether \p layer has the shape that was deformed, now or at rest.
bool hasShape(MeshModel &layer, const Deformation &deformation) {
    return shapeOf(layer.cm) == deformation.shape ||
           (RestShape::exists(layer) && RestShape(layer).shape() == deformation.shape);
}

/// Whether \p layer is the very one that was deformed, with the same mesh, wherever its vertices are now.
bool isSameMesh(const MeshModel &layer, const Deformation &deformation) {
    const CMeshO &mesh = layer.cm;
    return layer.id() == deformation.source && mesh.vert.size() == deformation.rest.size() &&
           mesh.vn == deformation.vertices && facesOf(mesh) == deformation.corners;
}

} // namespace

void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose) {
    const CMeshO &mesh = source.cm;
    std::vector<Point3m> rest;
    rest.reserve(mesh.vert.size());
    for (const CVertexO &vertex : mesh.vert)
        rest.push_back(vertex.cP());
    LayerState::made(document, graph).deformation = std::make_shared<const Deformation>(
        Deformation{prepared, pose, std::move(rest), invertibleMatrixOf(source), shapeOf(mesh), facesOf(mesh), mesh.vn,
                    mesh.fn, source.id(), restGraph.id()});
}

const Deformation &deformationOf(const DeformationLayers &layers, bool evenIfMoved) {
    const auto [source, restGraph, deformedGraph] = layers;
    if (!source || !restGraph || !deformedGraph)
        throw Error(
            "source_layer, rest_graph and deformed_graph must be layers of this document. Or give a deformation_file.");
    const std::shared_ptr<const Deformation> &found = LayerState::known(*deformedGraph).deformation;
    if (!found)
        throw Error("The layer " + inQuotes(*deformedGraph) +
                    " holds no deformation. It must be the deformed graph that 'FCD: Deform Mesh' "
                    "(generate_fcd_deformed_mesh) made in this session, with 'Add graph layers': layers that "
                    "are saved and loaded lose it. Deform the source again; to keep a deformation, use 'FCD: Save "
                    "Deformation' (save_fcd_deformation), and give its deformation_file.");
    const Deformation &deformation = *found; // the document owns it
    const bool isThere = source->cm.fn == deformation.faces && hasShape(*source, deformation),
               isElsewhere = !isThere && isSameMesh(*source, deformation);
    if (!isThere && !(isElsewhere && evenIfMoved))
        throw Error("The layer " + inQuotes(*source) + " is not what " + inQuotes(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, give it the pose "
                    "that it had then, or deform it again." +
                    (isElsewhere ? " It was only moved: 'FCD: Save Deformation' (save_fcd_deformation) still saves the "
                                   "deformation as it was; give that deformation_file."
                                 : ""));
    const Eigen::Affine3d matrix = isThere ? invertibleMatrixOf(*source) : deformation.matrix;
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, positionsIn(matrix, *restGraph)))
        throw Error("The layer " + inQuotes(*restGraph) + " is not the graph at rest of " + inQuotes(*deformedGraph) +
                    ". Choose the graph that was made together with it.");
    return deformation;
}

SourceThen sourceThen(MeshModel &source, const Deformation &deformation, const Remark &remark) {
    const bool isThere = hasShape(source, deformation);
    if (!isThere && remark)
        remark("Something else has moved " + inQuotes(source) +
               " since it was deformed. The deformation is that of the shape and the place that it had then.");
    SourceThen then{positionsOf(source), isThere ? invertibleMatrixOf(source) : deformation.matrix};
    for (std::size_t i = 0; i < std::min(source.cm.vert.size(), deformation.rest.size()); ++i)
        then.position.col(Eigen::Index(i)) = toVector(deformation.rest[i]);
    return then;
}

DeformationLayers lastDeformation(const MeshDocument &document) {
    DeformationLayers last;
    for (const MeshModel *layer : host::layers(document)) {
        const std::shared_ptr<const Deformation> &found = LayerState::known(*layer).deformation;
        if (!found || (last.deformedGraph && layer->id() < last.deformedGraph->id()))
            continue;
        MeshDocument &all = const_cast<MeshDocument &>(document); // which is not changed
        MeshModel *source = all.getMesh(found->source), *restGraph = all.getMesh(found->restGraph);
        if (source && restGraph)
            last = {source, restGraph, all.getMesh(layer->id())};
    }
    return last;
}
