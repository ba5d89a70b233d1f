// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_deformation.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "rest_shape.h"

using vcg::fcd::Error;

namespace {

/// Whether \p layer has the shape that was deformed; otherwise that may be its rest shape.
bool isAsDeformed(const MeshModel &layer, const Deformation &deformation) {
    return shapeOf(layer.cm) == deformation.shape;
}

} // namespace

void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose) {
    LayerState::made(document, graph).deformation = std::make_shared<const Deformation>(
        Deformation{prepared, pose, shapeOf(source.cm), source.cm.fn, source.id(), restGraph.id()});
}

const Deformation &deformationOf(const DeformationLayers &layers) {
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
    const CMeshO &mesh = source->cm;
    const bool isThere = isAsDeformed(*source, deformation) ||
                         (RestShape::exists(*source) && RestShape(*source).shape() == deformation.shape);
    if (!isThere || mesh.fn != deformation.faces)
        throw Error("The layer " + inQuotes(*source) + " is not what " + inQuotes(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, give it the pose "
                    "that it had then, or deform it again.");
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, readNodes(*source, restGraph)))
        throw Error("The layer " + inQuotes(*restGraph) + " is not the graph at rest of " + inQuotes(*deformedGraph) +
                    ". Choose the graph that was made together with it.");
    return deformation;
}

Eigen::Matrix3Xd positionsBefore(MeshModel &source, const Deformation &deformation) {
    Eigen::Matrix3Xd position = positionsOf(source);
    if (!isAsDeformed(source, deformation)) {
        const Point3m *rest = RestShape(source).positions();
        for (Eigen::Index i = 0; i < position.cols(); ++i)
            position.col(i) << rest[i][0], rest[i][1], rest[i][2];
    }
    return position;
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
