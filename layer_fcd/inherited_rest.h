// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INHERITED_REST_H
#define FCD_INHERITED_REST_H

#include "layer_state.h"

#include <optional>
#include <vector>

/// \file
/// A host that duplicates a posed layer, or a part of it, copies where its vertices are. What they were at rest is
/// known by the layer that they come from.

/// The rest shapes of \p layer where its vertices are some of another layer, in the order that these have there, and
/// where the last pose of that one left them; none otherwise, or where no shape is another than the present one.
/// \param others the states of other layers
std::optional<RestState> inheritedRest(const MeshModel &layer, const std::vector<const LayerState *> &others);

/// Before the layer of \p state goes, or its vertices move: those of \p document that inherit its rest shapes have
/// them. \return whether there are any that had none
bool handDownRest(const MeshDocument &document, const LayerState &state);
inline void handDownRest(const MeshDocument &document, const MeshModel &layer) {
    if (const LayerState *state = LayerState::of(layer))
        handDownRest(document, *state);
}

#endif
