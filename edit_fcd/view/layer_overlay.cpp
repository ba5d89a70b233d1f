// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/layer_overlay.h"

#include "edit_fcd/view/layer_drawing.h"

#include <utility>

LayerOverlay::LayerOverlay() : elements(QOpenGLBuffer::IndexBuffer) {
    positions.setUsagePattern(QOpenGLBuffer::DynamicDraw);
}

void LayerOverlay::show(const CMeshO &mesh, const std::vector<vcg::Color4b> &shown, const std::vector<char> *isIn) {
    hide();
    DrawnVertices placeOf(mesh.vert.size());
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        const CFaceO &face = mesh.face[f];
        if (face.IsD() || (isIn && !(*isIn)[f]))
            continue;
        std::size_t corner[3];
        for (int k = 0; k < 3; ++k)
            corner[k] = std::size_t(face.cV(k) - mesh.vert.data());
        if (shown[corner[0]][3] || shown[corner[1]][3] || shown[corner[2]][3])
            for (const std::size_t i : corner)
                element.push_back(placeOf(i));
    }
    for (std::size_t i = 0; i < mesh.vert.size() && mesh.fn == 0; ++i)
        if (shown[i][3] && !mesh.vert[i].IsD())
            placeOf(i);
    slot = std::move(placeOf.slot);
    for (const std::uint32_t i : slot)
        color.push_back(shown[i]);
    vertexSlots = mesh.vert.size();
    isChanged = isMoved = true;
}

void LayerOverlay::show(const CMeshO &mesh, std::vector<std::uint32_t> newSlot, std::vector<vcg::Color4b> newColor,
                        std::vector<std::uint32_t> newElement) {
    slot = std::move(newSlot);
    color = std::move(newColor);
    element = std::move(newElement);
    vertexSlots = mesh.vert.size();
    isChanged = isMoved = true;
}

void LayerOverlay::hide() {
    slot.clear();
    color.clear();
    element.clear();
}

void LayerOverlay::write(const CMeshO &mesh) {
    if (isMoved)
        fillVectors(
            positions, slot, [&](std::uint32_t i) { return mesh.vert[i].cP(); }, position);
    if (isChanged) {
        fill(colors, color);
        fill(elements, element);
    }
    isMoved = isChanged = false;
}

void LayerOverlay::draw(const CMeshO &mesh) {
    if (slot.empty() || vertexSlots != mesh.vert.size())
        return;
    write(mesh);
    const LayerDrawing drawing(mesh);
    beSeenThrough(-1);
    glDepthFunc(GL_LEQUAL);
    glShadeModel(GL_SMOOTH);
    glPointSize(5); // covers a cloud's own points, which are 3 wide
    glDepthRange(0, mesh.fn > 0 ? 1 : 0.9999);
    usePositions(positions);
    useColors(colors);
    if (element.empty())
        glDrawArrays(GL_POINTS, 0, int(slot.size()));
    else
        drawTriangles(elements, element.size());
}
