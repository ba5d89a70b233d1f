// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_DEFORMATION_H
#define FCD_KEPT_DEFORMATION_H

#include "parameters.h"
#include "prepared_layers.h"

#include <cstdint>
#include <memory>

/// What FCD: Deform Mesh did to a layer. Its deformed graph keeps it, as long as that layer is there.
struct Deformation {
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Deformer::Pose pose;
    std::uint64_t shape; ///< that the source had, in a pose or at rest, as shapeOf tells it
    int faces;           ///< of the source
    int source;          ///< number of that layer
    int restGraph;       ///< number of the layer with the graph at rest
};

/// Lets \p graph, a layer, keep what was done to \p source, whose graph at rest is \p restGraph.
void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose);

/// What was done to \p source. \throw vcg::fcd::Error when the layers are not those of one deformation
const Deformation &deformationOf(MeshModel *source, const MeshModel *restGraph, MeshModel *deformedGraph);

/// The positions that the vertices of \p source had when it was deformed, 3 x slots.
/// \pre \p deformation is what deformationOf gives for it
Eigen::Matrix3Xd positionsBefore(MeshModel &source, const Deformation &deformation);

/// Layers of one deformation; null where there are none.
struct DeformationLayers {
    const MeshModel *source = nullptr, *restGraph = nullptr, *deformedGraph = nullptr;
};

/// Those of the deformation that was made last, of all that are kept and whose layers are there.
DeformationLayers lastDeformation(const MeshDocument &document);

#endif
