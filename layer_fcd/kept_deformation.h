// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_DEFORMATION_H
#define FCD_KEPT_DEFORMATION_H

#include "parameters.h"
#include "prepared_layers.h"

#include <cstdint>
#include <memory>

/// What FCD: Deform Mesh did to a layer. Its deformed graph keeps it, as long as the layer is there.
struct Deformation {
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Deformer::Pose pose;
    std::uint64_t shape; ///< of the source at rest, as shapeOf tells it
    int faces;           ///< of the source
};

/// Lets \p graph, a layer, keep what was done to \p source.
void keepDeformation(MeshModel &graph, const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose);

/// What was done to \p source. \throw vcg::fcd::Error when the layers are not those of one deformation
const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph);

#endif
