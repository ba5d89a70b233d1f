// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/moving_part.h"
#include "edit_fcd/view/trace.h"

#include <layer_fcd/layer_contents.h>

#include <algorithm>
#include <utility>

// Software rendering (two cores) draws so many faces about ten times a second, which jerks.
const int leastFaces = 200000;
// Largest share of the faces that move: with more, a picture saves little.
const double mostMoving = 0.5;

std::unique_ptr<MovingPart> MovingPart::of(GLArea &view, const MeshModel &layer, const std::vector<int> &tags,
                                           std::vector<vcg::Color4b> over) {
    MLSceneGLSharedDataContext *shared = view.getSceneGLSharedContext();
    if (!shared || layer.cm.fn < leastFaces || view.mvc()->count() > 1 || view.getRenderer() ||
        !view.meshVisibilityMap.value(layer.id()) || !view.iPerMeshDecoratorsListMap.value(layer.id()).isEmpty())
        return nullptr;
    MLRenderingData data;
    shared->getRenderInfoPerMeshView(layer.id(), view.context(), data);
    const std::optional<LayerLook> look = LayerLook::of(data, layer.cm);
    if (!look)
        return nullptr;
    std::unique_ptr<MovingPart> made(new MovingPart(view, layer, *look, std::move(over)));
    made->take(tags);
    if (double(made->part->faces()) > mostMoving * layer.cm.fn)
        return nullptr;
    view.meshVisibilityMap[layer.id()] = false;
    return made;
}

MovingPart::MovingPart(GLArea &view, const MeshModel &layer, const LayerLook &look, std::vector<vcg::Color4b> over)
    : view(&view), layer(layer), layerId(layer.id()), look(look), over(std::move(over)) {}

MovingPart::~MovingPart() {
    if (view)
        view->meshVisibilityMap[layerId] = true;
}

/// Takes the faces with a free or handle vertex as the moving part.
void MovingPart::take(const std::vector<int> &newTags) {
    tags = newTags;
    const CMeshO &mesh = layer.cm;
    isMoving.assign(mesh.face.size(), 0);
    forEach(mesh.face.size(), [&](std::size_t f) {
        for (int k = 0; k < 3 && !mesh.face[f].IsD(); ++k)
            if (tags[std::size_t(mesh.face[f].cV(k) - mesh.vert.data())] > 0)
                isMoving[f] = 1;
    });
    part = std::make_unique<LayerPart>(mesh, isMoving, look);
    if (!over.empty())
        overPart.show(mesh, over, &isMoving);
    picture.reset();
}

void MovingPart::move(const std::vector<int> &newTags) {
    if (tags != newTags)
        take(newTags);
    part->move();
    overPart.move();
}

bool MovingPart::isPictureOf(const Camera &seen) const {
    return picture && seen.toClip == pictureSeen.toClip && seen.width == pictureSeen.width &&
           seen.height == pictureSeen.height;
}

/// Copies colour and depth of the view into the picture, or back. \return whether that worked
bool MovingPart::copy(bool toPicture) const {
    // Qt's own copy leaves an OpenGL error if the view is copied, and GLEW is not linked.
    const auto bind = reinterpret_cast<PFNGLBINDFRAMEBUFFERPROC>(view->context()->getProcAddress("glBindFramebuffer"));
    const auto blit = reinterpret_cast<PFNGLBLITFRAMEBUFFERPROC>(view->context()->getProcAddress("glBlitFramebuffer"));
    if (!bind || !blit)
        return false;
    while (glGetError() != GL_NO_ERROR) // forgets errors of others
        ;
    int own = 0;
    glGetIntegerv(GL_FRAMEBUFFER_BINDING, &own);
    bind(GL_READ_FRAMEBUFFER, toPicture ? GLuint(own) : picture->handle());
    bind(GL_DRAW_FRAMEBUFFER, toPicture ? picture->handle() : GLuint(own));
    const int width = pictureSeen.width, height = pictureSeen.height;
    blit(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    bind(GL_FRAMEBUFFER, GLuint(own));
    return glGetError() == GL_NO_ERROR;
}

bool MovingPart::draw(const Camera &seen) {
    view->meshVisibilityMap[layerId] = false; // the host may have forgotten
    if (!isPictureOf(seen)) {
        std::vector<char> stays(isMoving.size());
        std::transform(isMoving.begin(), isMoving.end(), stays.begin(), [](char moves) { return char(!moves); });
        LayerPart(layer.cm, stays, look).draw(*view);
        if (!over.empty()) {
            LayerOverlay overStill;
            overStill.show(layer.cm, over, &stays);
            overStill.draw(layer.cm);
        }
        pictureSeen = seen;
        picture = std::make_unique<QOpenGLFramebufferObject>(seen.width, seen.height,
                                                             QOpenGLFramebufferObject::CombinedDepthStencil);
        picture->release(); // it is bound when it is made
        if (!picture->isValid() || !copy(true) || !copy(false))
            return false;
    } else if (!copy(false)) {
        return false;
    }
    part->draw(*view);
    overPart.draw(layer.cm);
    trace("moving: %d of %d faces are drawn", int(part->faces()), layer.cm.fn);
    return true;
}

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
    use(positions, GL_VERTEX_ARRAY);
    use(normals, GL_NORMAL_ARRAY);
    if (look.hasVertexColors)
        use(colors, GL_COLOR_ARRAY);
    drawTriangles(elements, element.size());
}
