// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_part.h"

#include <layer_fcd/layer_contents.h>

using Names = MLRenderingData::ATT_NAMES;

std::optional<LayerLook> LayerLook::of(const MLRenderingData &data, const CMeshO &mesh) {
    MLPerViewGLOptions options;
    MLRenderingData::RendAtts shown;
    for (const auto other :
         {MLRenderingData::PR_POINTS, MLRenderingData::PR_WIREFRAME_EDGES, MLRenderingData::PR_WIREFRAME_TRIANGLES})
        if (data.isPrimitiveActive(other))
            return {};
    if (!data.get(options) || !data.get(MLRenderingData::PR_SOLID, shown) ||
        !data.isPrimitiveActive(MLRenderingData::PR_SOLID))
        return {};
    for (const Names other :
         {Names::ATT_FACENORMAL, Names::ATT_FACECOLOR, Names::ATT_VERTTEXTURE, Names::ATT_WEDGETEXTURE})
        if (shown[other])
            return {};
    const bool isSelected = options._sel_enabled && (mesh.svn > 0 || mesh.sfn > 0);
    const bool hasEdges = options._peredge_edgeboundary_enabled || options._peredge_faceboundary_enabled ||
                          options._peredge_edgemanifold_enabled || options._peredge_vertmanifold_enabled ||
                          options._peredge_text_boundary_enabled;
    if (isSelected || hasEdges || !shown[Names::ATT_VERTNORMAL] || options._perbbox_enabled ||
        options._double_side_lighting || options._fancy_lighting)
        return {};
    LayerLook look;
    look.isLit = !options._persolid_noshading;
    look.isCulled = options._back_face_cull;
    look.color = options._persolid_fixed_color_enabled  ? options._persolid_fixed_color
                 : options._persolid_mesh_color_enabled ? mesh.cC()
                                                        : vcg::Color4b(vcg::Color4b::LightGray);
    look.hasVertexColors =
        !options._persolid_fixed_color_enabled && !options._persolid_mesh_color_enabled && shown[Names::ATT_VERTCOLOR];
    return look;
}

LayerPart::LayerPart(const CMeshO &mesh, const std::vector<char> &isIn, const LayerLook &look)
    : mesh(mesh), look(look), elements(QOpenGLBuffer::IndexBuffer) {
    positions.setUsagePattern(QOpenGLBuffer::DynamicDraw);
    normals.setUsagePattern(QOpenGLBuffer::DynamicDraw);
    const std::uint32_t none = std::uint32_t(-1);
    std::vector<std::uint32_t> place(mesh.vert.size(), none);
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        if (!isIn[f] || mesh.face[f].IsD())
            continue;
        for (int k = 0; k < 3; ++k) {
            const auto i = std::size_t(mesh.face[f].cV(k) - mesh.vert.data());
            if (place[i] == none) {
                place[i] = std::uint32_t(slot.size());
                slot.push_back(std::uint32_t(i));
            }
            element.push_back(place[i]);
        }
    }
}

void LayerPart::write() {
    const auto fill = [](QOpenGLBuffer &buffer, const auto &values) {
        if (!buffer.isCreated())
            buffer.create();
        buffer.bind();
        buffer.allocate(values.data(), int(values.size() * sizeof values[0]));
        buffer.release();
    };
    if (isMoved) {
        position.resize(3 * slot.size());
        normal.resize(3 * slot.size());
        vcg::fcd::ParallelFor(0, slot.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            for (std::size_t j = first; j < last; ++j)
                for (int d = 0; d < 3; ++d) {
                    position[3 * j + std::size_t(d)] = float(mesh.vert[slot[j]].cP()[d]);
                    normal[3 * j + std::size_t(d)] = float(mesh.vert[slot[j]].cN()[d]);
                }
        });
        fill(positions, position);
        fill(normals, normal);
    }
    if (isNew) {
        fill(elements, element);
        std::vector<vcg::Color4b> color;
        for (std::size_t j = 0; j < slot.size() && look.hasVertexColors; ++j)
            color.push_back(mesh.vert[slot[j]].cC());
        fill(colors, color);
    }
    isMoved = isNew = false;
}

void LayerPart::draw(const GLArea &view) {
    if (element.empty())
        return;
    write();
    glPushAttrib(GL_ALL_ATTRIB_BITS);
    glPushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
    const auto light = [](GLenum what, const vcg::Color4b &color) {
        glLightfv(GL_LIGHT0, what, vcg::Color4f::Construct(color).V());
    };
    light(GL_AMBIENT, view.glas.baseLightAmbientColor);
    light(GL_DIFFUSE, view.glas.baseLightDiffuseColor);
    light(GL_SPECULAR, view.glas.baseLightSpecularColor);
    glDisable(GL_LIGHT1);
    const auto set = [](GLenum what, bool on) {
        if (on)
            glEnable(what);
        else
            glDisable(what);
    };
    set(GL_LIGHTING, look.isLit);
    set(GL_CULL_FACE, look.isCulled);
    glEnable(GL_COLOR_MATERIAL);
    glDisable(GL_TEXTURE_2D);
    glColor4ubv(look.color.V());
    if (look.hasVertexColors)
        glColorMaterial(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
    Eigen::Matrix4d matrix;
    mesh.Tr.ToEigenMatrix(matrix);
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glMultMatrixd(matrix.data());

    glEnableClientState(GL_VERTEX_ARRAY);
    glEnableClientState(GL_NORMAL_ARRAY);
    glDisableClientState(GL_TEXTURE_COORD_ARRAY);
    positions.bind();
    glVertexPointer(3, GL_FLOAT, 0, nullptr);
    normals.bind();
    glNormalPointer(GL_FLOAT, 0, nullptr);
    normals.release();
    if (look.hasVertexColors) {
        glEnableClientState(GL_COLOR_ARRAY);
        colors.bind();
        glColorPointer(4, GL_UNSIGNED_BYTE, 0, nullptr);
        colors.release();
    } else {
        glDisableClientState(GL_COLOR_ARRAY);
    }
    elements.bind();
    glDrawElements(GL_TRIANGLES, int(element.size()), GL_UNSIGNED_INT, nullptr);
    elements.release();
    glPopMatrix();
    glPopClientAttrib();
    glPopAttrib();
}
