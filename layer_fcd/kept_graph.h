// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_GRAPH_H
#define FCD_KEPT_GRAPH_H

#include "layer_state.h"
#include "parameters.h"
#include "prepared_layers.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

/// \file
/// Which layers are deformation graphs, and of what, and the deformations that they keep.

/// The graph state of \p layer, if a filter made it or its original; else none.
std::optional<GraphState> graphOf(const MeshDocument &document, const MeshModel &layer);
/// Whether \p layer is a graph that was built, not points placed by hand; of a file, if its quality may be radii.
bool isGraph(const MeshDocument &document, const MeshModel &layer);
/// The default graph, at rest or deformed, for the current layer: its last one, or else the last of all. Layers from
/// files are told by their labels. The current layer if there is none.
const MeshModel *likelyGraph(const MeshDocument &document, bool isDeformed);
/// Call it before the layer of \p state is deleted: its copies inherit the graph state.
void handDownGraph(const MeshDocument &document, const LayerState &state);

/// A deformation by FCD: Deform Mesh. The layer of the deformed graph keeps it.
struct Deformation {
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Deformer::Pose pose;
    Eigen::Matrix3Xd rest;  ///< positions of the source when it was deformed, 3 x slots
    Eigen::Affine3d matrix; ///< of the source then
    std::uint64_t shape;    ///< shapeOf the source then
    std::uint64_t corners;  ///< facesOf the source then
    int vertices, faces;    ///< numbers of live ones
    int source;             ///< number of that layer
    int restGraph;          ///< number of the layer with the graph at rest
};

/// A deformation, and its source as it was then or, if it has that shape, where it is now.
struct DeformationThen {
    const Deformation &deformation; ///< the document owns it
    Eigen::Matrix3Xd position;      ///< of the source, 3 x slots
    Eigen::Affine3d matrix;         ///< of the source
};

/// Lets the layer \p graph keep the deformation of \p source.
void keepDeformation(const MeshDocument &document, MeshModel &graph, const MeshModel &restGraph,
                     const MeshModel &source, const std::shared_ptr<const Prepared> &prepared,
                     const vcg::fcd::Deformer::Pose &pose);

/// The deformation of layers.source. \param evenIfMoved also takes it if something has moved its source since; \p
/// remark is then told \throw vcg::fcd::Error the layers are not those of one deformation
DeformationThen deformationOf(const DeformationLayers &layers, bool evenIfMoved, const Remark &remark);

/// The layers of the last deformation that is kept and has all of its layers.
DeformationLayers lastDeformation(const MeshDocument &document);

#endif
