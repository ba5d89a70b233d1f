// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/layer_contents.h>

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

void usePositions(QOpenGLBuffer &positions) {
    glEnableClientState(GL_VERTEX_ARRAY);
    positions.bind();
    glVertexPointer(3, GL_FLOAT, 0, nullptr);
    positions.release();
}

void useNormals(QOpenGLBuffer &normals) {
    glEnableClientState(GL_NORMAL_ARRAY);
    normals.bind();
    glNormalPointer(GL_FLOAT, 0, nullptr);
    normals.release();
}

void useColors(QOpenGLBuffer &colors) {
    glEnableClientState(GL_COLOR_ARRAY);
    colors.bind();
    glColorPointer(4, GL_UNSIGNED_BYTE, 0, nullptr);
    colors.release();
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
