// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INHERITED_SCAN_H
#define FCD_INHERITED_SCAN_H

#include "layer_state.h"

#include <optional>
#include <vector>

/// \file
/// A host that merges, splits or duplicates tagged layers copies the colours and the quality of the tags. What these
/// stand in the place of is known by the layers that the vertices come from.

/// What is kept for the vertices of \p layer that are at the places of vertices of other layers, and have the colours
/// or the quality of their tags; none where there is none. \param sources the states of these others
std::optional<KeptScan> inheritedScan(const MeshModel &layer, const std::vector<const LayerState *> &sources);

/// Before the layer of \p state goes, or its tags: layers of \p document that inherit of it have what is kept.
/// \return whether there are any that had none
bool handDown(const MeshDocument &document, const LayerState &state);

#endif
