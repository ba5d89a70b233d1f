// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_overlay.h"

#include <layer_fcd/layer_contents.h>

namespace {

const std::uint32_t none = std::uint32_t(-1);

/// Makes a buffer hold values, and the one that is bound.
template <class T>
void fill(QOpenGLBuffer &buffer, const std::vector<T> &values) {
    if (!buffer.isCreated())
        buffer.create();
    buffer.bind();
    buffer.allocate(values.data(), int(values.size() * sizeof(T)));
    buffer.release();
}

} // namespace

LayerOverlay::LayerOverlay() : elements(QOpenGLBuffer::IndexBuffer) {
    positions.setUsagePattern(QOpenGLBuffer::DynamicDraw);
}

void LayerOverlay::show(const CMeshO &mesh, const std::vector<vcg::Color4b> &shown, const std::vector<char> *isIn) {
    hide();
    std::vector<std::uint32_t> place(mesh.vert.size(), none);
    const auto placeOf = [&](std::size_t i) {
        if (place[i] == none) {
            place[i] = std::uint32_t(slot.size());
            slot.push_back(std::uint32_t(i));
            color.push_back(shown[i]);
        }
        return place[i];
    };
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
    vertexSlots = mesh.vert.size();
    isChanged = isMoved = true;
}

void LayerOverlay::hide() {
    slot.clear();
    color.clear();
    element.clear();
}

void LayerOverlay::write(const CMeshO &mesh) {
    if (isMoved) {
        position.resize(3 * slot.size());
        vcg::fcd::ParallelFor(0, slot.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            for (std::size_t j = first; j < last; ++j)
                for (int d = 0; d < 3; ++d)
                    position[3 * j + std::size_t(d)] = float(mesh.vert[slot[j]].cP()[d]);
        });
        fill(positions, position);
    }
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
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glPushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
    glDisable(GL_LIGHTING);
    glDisable(GL_TEXTURE_2D);
    glDisable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glShadeModel(GL_SMOOTH);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1, -1); // in front of the layer's own faces
    glPointSize(5);          // a cloud's own points are 3 wide: between them, nothing of them is seen
    glDepthRange(0, mesh.fn > 0 ? 1 : 0.9999);
    Eigen::Matrix4d matrix;
    mesh.Tr.ToEigenMatrix(matrix);
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glMultMatrixd(matrix.data());

    glEnableClientState(GL_VERTEX_ARRAY);
    glEnableClientState(GL_COLOR_ARRAY);
    glDisableClientState(GL_NORMAL_ARRAY);
    glDisableClientState(GL_TEXTURE_COORD_ARRAY);
    positions.bind();
    glVertexPointer(3, GL_FLOAT, 0, nullptr);
    colors.bind();
    glColorPointer(4, GL_UNSIGNED_BYTE, 0, nullptr);
    colors.release();
    if (element.empty()) {
        glDrawArrays(GL_POINTS, 0, int(slot.size()));
    } else {
        elements.bind();
        glDrawElements(GL_TRIANGLES, int(element.size()), GL_UNSIGNED_INT, nullptr);
        elements.release();
    }
    glPopMatrix();
    glPopClientAttrib();
    glPopAttrib();
}
