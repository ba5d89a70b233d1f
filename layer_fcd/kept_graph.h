// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_GRAPH_H
#define FCD_KEPT_GRAPH_H

#include "layer_state.h"

#include <optional>

/// \file
/// Which layers are deformation graphs, and of what.

/// What \p layer is the graph of, where a filter has made it, or what it is a copy of; none otherwise.
std::optional<GraphState> graphOf(const MeshDocument &document, const MeshModel &layer);
/// Whether \p layer is a graph that was built, and not points that were placed. Of one that comes from a file nothing
/// is known: it is taken for a graph where its quality may be radii.
bool isGraph(const MeshDocument &document, const MeshModel &layer);
/// The graph, at rest or deformed, that is most likely meant for the current layer: the last one of this, or else the
/// last of all. Of layers that come from files, labels tell. The current layer where there is none.
const MeshModel *likelyGraph(const MeshDocument &document, bool isDeformed);
/// Before the layer of \p state goes: copies of it know what they are the graph of.
void handDownGraph(const MeshDocument &document, const LayerState &state);

#endif
