// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_COPY_H
#define FCD_COPY_H

#include "fcd_layers.h"
#include "fcd_prepared.h"

/// What FCD: Deform Mesh did to a layer. Its deformed graph keeps it, as long as the layer is there.
struct Deformation {
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Deformer::Pose pose;
    std::uint64_t shape; ///< of the source at rest, as shapeOf tells it
    int faces;           ///< of the source
};

/// Adds the layers of a deformation of \p layer: if \p graphs, the graph at rest and the deformed one, which keeps the
/// deformation; last, the deformed mesh. \param quality as NewLayers::addDeformed takes it
std::vector<MeshModel *> addResult(NewLayers &layers, const MeshModel &layer,
                                   const std::shared_ptr<const Prepared> &prepared,
                                   const vcg::fcd::DeformationResult &result, bool graphs,
                                   const std::vector<float> &quality);

/// What was done to \p source. \throw vcg::fcd::Error when the layers are not those of one deformation
const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph);

/// The positions of the vertices of \p layer at rest, 3 x slots.
Eigen::Matrix3Xd restPositionsOf(MeshModel &layer);

/// Adds for each of \p targets a layer that is deformed as the source was. \return how many vertices they have
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be read
/// \throw vcg::fcd::Cancelled
int copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                    const Remark &remark, const vcg::fcd::Progress &progress);

#endif
