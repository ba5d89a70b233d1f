// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_GRAPH_H
#define FCD_KEPT_GRAPH_H

#include "layer_state.h"

#include <optional>

/// \file
/// Which layers are deformation graphs, and of what.

/// The graph state of \p layer, if a filter made it or its original; else none.
std::optional<GraphState> graphOf(const MeshDocument &document, const MeshModel &layer);
/// Whether \p layer is a graph that was built, not points that were placed by hand. A layer from a file counts as a
/// graph if its quality may be radii.
bool isGraph(const MeshDocument &document, const MeshModel &layer);
/// The default graph, at rest or deformed, for the current layer: its last one, or else the last of all. Layers from
/// files are told by their labels. The current layer if there is none.
const MeshModel *likelyGraph(const MeshDocument &document, bool isDeformed);
/// Call it before the layer of \p state is deleted: its copies inherit the graph state.
void handDownGraph(const MeshDocument &document, const LayerState &state);

#endif
