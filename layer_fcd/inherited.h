// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_INHERITED_H
#define FCD_INHERITED_H

#include "layer_state.h"

#include <optional>
#include <vector>

/// \file
/// Inheritance of states. Hosts that merge, split or duplicate layers copy positions of vertices, and colours and
/// quality of tags. Rest shapes, and colours and quality before tagging, come from the states of the original layers.

/// The rest shapes that \p layer gets from another layer. Its vertices must be copies of that layer's, in the same
/// order and where the last pose left them, in that layer's coordinates or in the world's (hosts merge layers there).
/// None otherwise, or if no shape differs from the present one. \param others the states of other layers
std::optional<RestState> inheritedRest(const MeshModel &layer, const std::vector<const LayerState *> &others);

/// The colours and quality kept aside for vertices of \p layer that are copies of other layers': at their positions,
/// with colours or quality of their tags. None if there are no such vertices. \param sources states of other layers
std::optional<KeptScan> inheritedScan(const MeshModel &layer, const std::vector<const LayerState *> &sources);

/// Gives a copy what its original has of these, unless it has its own: tags, with the colours and quality under them.
void inheritScan(const MeshDocument &document, MeshModel &layer);

/// Gives a copy what its original has of both, unless it has its own.
void inheritState(const MeshDocument &document, MeshModel &layer);

/// Gives inherit(layer) to the layers of \p document that have no such part (\p kept) of a state. \param state of the
/// layer that they may inherit from \return whether a layer got something
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

/// Call it before the layer of \p state is deleted, or its vertices move: layers that inherit its rest shapes get them.
/// \return whether a layer got them
bool handDownRest(const MeshDocument &document, const LayerState &state);
/// The same for a layer, whose own shapes from before a deletion (LayerState::whole) are then given up.
inline void handDownRest(const MeshDocument &document, const MeshModel &layer) {
    if (LayerState *state = LayerState::of(layer)) {
        handDownRest(document, *state);
        state->whole.reset();
    }
}
/// Call it before the layer, or its tags, are deleted: the same for colours and quality that are kept aside.
bool handDownScan(const MeshDocument &document, const LayerState &state);

#endif
