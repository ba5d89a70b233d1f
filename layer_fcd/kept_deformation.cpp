// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "kept_deformation.h"
#include "layer_contents.h"
#include "rest_shape.h"

#include <Eigen/Core>

#include <algorithm>
#include <string>

using vcg::fcd::Error;

namespace {

// A host does not free what a mesh's attributes hold when the mesh goes: the document does that, see keepDeformation.
using Kept = std::weak_ptr<const Deformation>;

// Changes with the layout of Deformation and of all that it holds, where no size below tells.
const int layout = 3;

/// What is kept is no plain data, so only a library that was built in the same way may find it: by this name.
std::string deformationName() {
    std::string name = "fcd_deformation";
    for (const std::size_t number :
         {std::size_t(layout), sizeof(Kept), sizeof(Deformation), sizeof(Prepared), sizeof(vcg::fcd::Deformer),
          sizeof(vcg::fcd::Deformer::Pose), std::size_t(EIGEN_MAX_ALIGN_BYTES), std::size_t(EIGEN_WORLD_VERSION),
          std::size_t(EIGEN_MAJOR_VERSION), std::size_t(EIGEN_MINOR_VERSION)})
        name += "_" + std::to_string(number);
#ifdef _LIBCPP_VERSION
    name += "_libc++";
#endif
    return name;
}

std::string quoted(const MeshModel &layer) { return "'" + layer.label().toStdString() + "'"; }

/// Whether \p layer has, in memory, the shape that was deformed; otherwise it may have it at rest.
bool isAsDeformed(const MeshModel &layer, const Deformation &deformation) {
    return shapeOf(layer.cm) == deformation.shape;
}

} // namespace

void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose) {
    // Not by make_shared, whose memory goes with the last weak pointer.
    auto held = std::make_shared<std::shared_ptr<const Deformation>>(
        new Deformation{prepared, pose, shapeOf(source.cm), source.cm.fn, source.id(), restGraph.id()});
    host::madeMeshAttribute<Kept>(graph.cm, deformationName()) = *held;
    // What is connected holds it, and goes with the document.
    QObject::connect(&document, &MeshDocument::meshRemoved, [held, layer = graph.id()](int gone) {
        if (gone == layer)
            held->reset();
    });
}

const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph) {
    if (!source || !restGraph || !deformedGraph)
        throw Error("source_layer, rest_graph and deformed_graph must be layers of this document, where there is no "
                    "deformation_file.");
    const Kept *kept = host::meshAttribute<Kept>(deformedGraph->cm, deformationName());
    const std::shared_ptr<const Deformation> found = kept ? kept->lock() : nullptr;
    if (!found)
        throw Error("The layer " + quoted(*deformedGraph) +
                    " holds no deformation. It must be the deformed graph that 'FCD: Deform Mesh' "
                    "(generate_fcd_deformed_mesh) made in this session, with 'Layers with the graph': layers that "
                    "are saved and loaded lose it. Deform the source again; to keep a deformation, use 'FCD: Save "
                    "Deformation' (save_fcd_deformation), and give its deformation_file.");
    const Deformation &deformation = *found; // held by the document
    const CMeshO &mesh = source->cm;
    const bool isThere = isAsDeformed(*source, deformation) ||
                         (RestShape::exists(*source) && RestShape(*source).shape() == deformation.shape);
    if (!isThere || mesh.fn != deformation.faces)
        throw Error("The layer " + quoted(*source) + " is not what " + quoted(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, give it the pose "
                    "that it had then, or deform it again.");
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, readNodes(*source, restGraph)))
        throw Error("The layer " + quoted(*restGraph) + " is not the graph at rest of " + quoted(*deformedGraph) +
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
    const std::vector<const MeshModel *> layers = host::layers(document);
    const auto layerOf = [&layers](int id) {
        const auto found =
            std::find_if(layers.begin(), layers.end(), [id](const auto *each) { return each->id() == id; });
        return found == layers.end() ? nullptr : *found;
    };
    DeformationLayers last;
    for (const MeshModel *layer : layers) {
        const Kept *kept = host::meshAttribute<Kept>(layer->cm, deformationName());
        const std::shared_ptr<const Deformation> found = kept ? kept->lock() : nullptr;
        if (!found || (last.deformedGraph && layer->id() < last.deformedGraph->id()))
            continue;
        const MeshModel *source = layerOf(found->source), *restGraph = layerOf(found->restGraph);
        if (source && restGraph)
            last = {source, restGraph, layer};
    }
    return last;
}
