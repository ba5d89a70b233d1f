// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "kept_deformation.h"
#include "rest_shape.h"

#include <Eigen/Core>

#include <string>

using vcg::fcd::Error;

namespace {

using Kept = std::shared_ptr<const Deformation>;

// Changes with the layout of Deformation and of all that it holds, where no size below tells.
const int layout = 1;

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

} // namespace

void keepDeformation(MeshModel &graph, const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose) {
    auto deformation =
        std::make_shared<const Deformation>(Deformation{prepared, pose, shapeOf(source.cm), source.cm.fn});
    host::madeMeshAttribute<Kept>(graph.cm, deformationName()) = std::move(deformation);
}

const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph) {
    if (!source || !restGraph || !deformedGraph)
        throw Error("source_layer, rest_graph and deformed_graph must be layers of this document, where there is no "
                    "deformation_file.");
    const Kept *kept = host::meshAttribute<Kept>(deformedGraph->cm, deformationName());
    if (!kept || !*kept)
        throw Error("The layer " + quoted(*deformedGraph) +
                    " holds no deformation. It must be the deformed graph that 'FCD: Deform Mesh' "
                    "(generate_fcd_deformed_mesh) made in this session, with 'Layers with the graph': layers that "
                    "are saved and loaded lose it. Deform the source again; to keep a deformation, use 'FCD: Save "
                    "Deformation' (save_fcd_deformation), and give its deformation_file.");
    const Deformation &deformation = **kept;
    const CMeshO &mesh = source->cm;
    const bool isPosed = RestShape::exists(*source);
    if ((isPosed ? RestShape(*source).shape() : shapeOf(mesh)) != deformation.shape || mesh.fn != deformation.faces)
        throw Error("The layer " + quoted(*source) + " is not what " + quoted(*deformedGraph) +
                    " was made from, or it was changed since. Choose the layer that was deformed, or deform it again.");
    if (restGraph == source || !HasNodes(*deformation.prepared->deformer, readNodes(*source, restGraph)))
        throw Error("The layer " + quoted(*restGraph) + " is not the graph at rest of " + quoted(*deformedGraph) +
                    ". Choose the graph that was made together with it.");
    return deformation;
}
