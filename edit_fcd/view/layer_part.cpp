// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/layer_part.h"

#include "edit_fcd/view/layer_drawing.h"

#include <utility>

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
    DrawnVertices placeOf(mesh.vert.size());
    for (std::size_t f = 0; f < mesh.face.size(); ++f)
        for (int k = 0; k < 3 && isIn[f] && !mesh.face[f].IsD(); ++k)
            element.push_back(placeOf(std::size_t(mesh.face[f].cV(k) - mesh.vert.data())));
    slot = std::move(placeOf.slot);
}

void LayerPart::write() {
    if (isMoved) {
        fillVectors(
            positions, slot, [&](std::uint32_t i) { return mesh.vert[i].cP(); }, position);
        fillVectors(
            normals, slot, [&](std::uint32_t i) { return mesh.vert[i].cN(); }, normal);
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
    const LayerDrawing drawing(mesh);
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
    usePositions(positions);
    useNormals(normals);
    if (look.hasVertexColors)
        useColors(colors);
    drawTriangles(elements, element.size());
}
