// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_APPLIES_H
#define FCD_APPLIES_H

#include <layer_fcd/rest_shape.h> // these before Qt

#include <layer_fcd/inherited.h>

#include <algorithm>

/// \file
/// Undo over applies: back to the rest shape before one, if RestShape still keeps it.

/// Makes an earlier rest shape, which shapeOf identifies, the layer's rest shape again and shows it. Copies of the
/// layer take over its rest shapes first. \return false: it is not kept, and nothing has changed
inline bool goBackTo(const MeshDocument &document, MeshModel &layer, std::uint64_t shape) {
    if (!RestShape::exists(layer))
        return false;
    RestShape shapes(layer);
    const std::vector<std::uint64_t> kept = shapes.shapes();
    const auto place = std::find(kept.begin(), kept.end(), shape);
    if (place == kept.end())
        return false;
    handDownRest(document, layer);
    shapes.backTo(std::size_t(place - kept.begin()));
    shapes.restore();
    return true;
}

/// The first apply from which on all rest shapes are kept. \param shapeBefore(i) the shape before apply i
template <class ShapeBefore>
std::size_t firstKept(MeshModel &layer, std::size_t applies, const ShapeBefore &shapeBefore) {
    if (applies == 0 || !RestShape::exists(layer))
        return applies;
    const std::vector<std::uint64_t> kept = RestShape(layer).shapes();
    while (applies > 0 && std::find(kept.begin(), kept.end(), shapeBefore(applies - 1)) != kept.end())
        --applies;
    return applies;
}

#endif
