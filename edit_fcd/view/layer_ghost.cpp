// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/layer_ghost.h"

#include "edit_fcd/view/layer_drawing.h"

#include <algorithm>
#include <utility>

// Software rendering (two cores) draws two such ghosts in 9 ms, about half of the time of a step of a drag.
const std::size_t mostGhostFaces = 25000;
// Points of a ghost: as dense as the pixels of a layer that fills a fifth of the view.
const std::size_t mostGhostPoints = 20000;

bool GhostParts::isPoints(std::size_t faces) { return faces == 0 || faces > mostGhostFaces; }

GhostParts GhostParts::of(const vcg::fcd::SurfaceView &surface, const std::vector<int> &tags) {
    GhostParts parts;
    if (isPoints(surface.faces)) {
        const auto moves = [](int tag) { return tag > 0; };
        const std::size_t every = 1 + std::size_t(std::count_if(tags.begin(), tags.end(), moves)) / mostGhostPoints;
        std::size_t met = 0;
        for (std::size_t i = 0; i < surface.vertexSlots; ++i)
            if (moves(tags[i]) && met++ % every == 0 && !surface.IsDeleted(i))
                parts.slot.push_back(std::uint32_t(i));
        return parts;
    }
    DrawnVertices placeOf(surface.vertexSlots);
    for (std::size_t f = 0; f < surface.faces; ++f)
        for (int k = 0; k < 3 && surface.IsFace(f); ++k)
            parts.element.push_back(placeOf(surface.corner[3 * f + std::size_t(k)]));
    parts.slot = std::move(placeOf.slot);
    return parts;
}

void LayerGhost::show(std::shared_ptr<const GhostParts> newParts, std::shared_ptr<const std::vector<float>> shape) {
    isOther = isOther || newParts != parts;
    isMoved = isMoved || shape != position;
    parts = std::move(newParts);
    position = std::move(shape);
}

void LayerGhost::hide() {
    position.reset();
    parts.reset();
}

void LayerGhost::draw(const CMeshO &mesh) {
    if (!position)
        return;
    if (isMoved)
        fill(positions, *position);
    if (isOther)
        fill(elements, parts->element);
    isMoved = isOther = false;
    const LayerDrawing drawing(mesh);
    beSeenThrough(1);
    glPointSize(2);
    glColor4ubv(color.V());
    usePositions(positions);
    if (parts->element.empty()) {
        glDepthRange(0.001, 1); // behind the layer: points are several pixels wide
        glDrawArrays(GL_POINTS, 0, int(parts->slot.size()));
    } else {
        drawTriangles(elements, parts->element.size());
    }
}
