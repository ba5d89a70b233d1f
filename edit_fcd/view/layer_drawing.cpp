// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/layer_drawing.h"

#include <algorithm>
#include <utility>

std::uint32_t DrawnVertices::operator()(std::size_t i) {
    if (place[i] == none) {
        place[i] = std::uint32_t(slot.size());
        slot.push_back(std::uint32_t(i));
    }
    return place[i];
}

void DrawnVertices::clear() {
    for (const std::uint32_t i : slot)
        place[i] = none;
    slot.clear();
}

LayerDrawing::LayerDrawing(const CMeshO &mesh) {
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glPushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
    Eigen::Matrix4d matrix;
    mesh.Tr.ToEigenMatrix(matrix);
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glMultMatrixd(matrix.data());
    for (const GLenum array : {GL_VERTEX_ARRAY, GL_NORMAL_ARRAY, GL_COLOR_ARRAY, GL_TEXTURE_COORD_ARRAY})
        glDisableClientState(array);
}

LayerDrawing::~LayerDrawing() {
    glPopMatrix();
    glPopClientAttrib();
    glPopAttrib();
}

void beSeenThrough(float offset) {
    glDisable(GL_LIGHTING);
    glDisable(GL_TEXTURE_2D);
    glDisable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(offset, offset);
}

void use(QOpenGLBuffer &buffer, GLenum array) {
    glEnableClientState(array);
    buffer.bind();
    if (array == GL_COLOR_ARRAY)
        glColorPointer(4, GL_UNSIGNED_BYTE, 0, nullptr);
    else if (array == GL_NORMAL_ARRAY)
        glNormalPointer(GL_FLOAT, 0, nullptr);
    else
        glVertexPointer(3, GL_FLOAT, 0, nullptr);
    buffer.release();
}

void drawTriangles(QOpenGLBuffer &elements, std::size_t corners) {
    elements.bind();
    glDrawElements(GL_TRIANGLES, int(corners), GL_UNSIGNED_INT, nullptr);
    elements.release();
}

FlatDrawing::FlatDrawing() {
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glDisable(GL_LIGHTING);
    glDisable(GL_TEXTURE_2D);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
}

FlatDrawing::~FlatDrawing() { glPopAttrib(); }

void put(const Eigen::Vector3d &p) { glVertex3d(p[0], p[1], p[2]); }

void drawPoint(const Eigen::Vector3d &p, float size) {
    glPointSize(size);
    glBegin(GL_POINTS);
    put(p);
    glEnd();
}

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
    use(positions, GL_VERTEX_ARRAY);
    use(colors, GL_COLOR_ARRAY);
    if (element.empty())
        glDrawArrays(GL_POINTS, 0, int(slot.size()));
    else
        drawTriangles(elements, element.size());
}

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
    use(positions, GL_VERTEX_ARRAY);
    if (parts->element.empty()) {
        glDepthRange(0.001, 1); // behind the layer: points are several pixels wide
        glDrawArrays(GL_POINTS, 0, int(parts->slot.size()));
    } else {
        drawTriangles(elements, parts->element.size());
    }
}
