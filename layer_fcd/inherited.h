// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INHERITED_H
#define FCD_INHERITED_H

#include "layer_state.h"

#include <optional>
#include <vector>

/// \file
/// A host that merges, splits or duplicates layers copies where their vertices are, and the colours and the quality of
/// tags. What the vertices were at rest, and what the tags stand in the place of, is known by the layers that they come
/// from.

/// The rest shapes of \p layer where its vertices are some of another layer, in the order that these have there, and
/// where the last pose of that one left them; none otherwise, or where no shape is another than the present one.
/// \param others the states of other layers
std::optional<RestState> inheritedRest(const MeshModel &layer, const std::vector<const LayerState *> &others);

/// What is kept for the vertices of \p layer that are at the places of vertices of other layers, and have the colours
/// or the quality of their tags; none where there is none. \param sources the states of these others
std::optional<KeptScan> inheritedScan(const MeshModel &layer, const std::vector<const LayerState *> &sources);

/// Layers of \p document that have none of what \p state keeps get what inherit(layer) gives, none where it is none.
/// \return whether there are any
template <class Kept, class Inherit>
bool handDown(const MeshDocument &document, const LayerState &state, std::optional<Kept> LayerState::*kept,
              const Inherit &inherit) {
    bool isGiven = false;
    for (const MeshModel *layer : host::layers(document))
        if (state.*kept && !(LayerState::known(*layer).*kept))
            if (std::optional<Kept> found = inherit(*layer)) {
                LayerState::made(document, const_cast<MeshModel &>(*layer)).*kept = std::move(found);
                isGiven = true;
            }
    return isGiven;
}

/// Before the layer of \p state goes, or its vertices move: those of \p document that inherit its rest shapes have
/// them. \return whether there are any that had none
bool handDownRest(const MeshDocument &document, const LayerState &state);
inline void handDownRest(const MeshDocument &document, const MeshModel &layer) {
    if (const LayerState *state = LayerState::of(layer))
        handDownRest(document, *state);
}
/// The same before the layer goes, or its tags, of what is kept.
bool handDownScan(const MeshDocument &document, const LayerState &state);

#endif
