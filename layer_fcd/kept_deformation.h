// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_DEFORMATION_H
#define FCD_KEPT_DEFORMATION_H

#include "parameters.h"
#include "prepared_layers.h"

#include <cstdint>
#include <memory>

/// A deformation by FCD: Deform Mesh. The layer of the deformed graph keeps it.
struct Deformation {
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Deformer::Pose pose;
    std::uint64_t shape; ///< shapeOf the source when it was deformed
    int faces;           ///< of the source
    int source;          ///< number of that layer
    int restGraph;       ///< number of the layer with the graph at rest
};

/// Lets the layer \p graph keep the deformation of \p source.
void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose);

/// The deformation of layers.source. \throw vcg::fcd::Error the layers are not those of one deformation
const Deformation &deformationOf(const DeformationLayers &layers);

/// The positions of \p source when it was deformed, 3 x slots. \param deformation as of deformationOf
Eigen::Matrix3Xd positionsBefore(MeshModel &source, const Deformation &deformation);

/// The layers of the last deformation that is kept and has all of its layers.
DeformationLayers lastDeformation(const MeshDocument &document);

#endif
