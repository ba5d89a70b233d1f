// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/moving_part.h"

#include "edit_fcd/view/trace.h"

#include <layer_fcd/layer_contents.h>

#include <algorithm>

namespace {

// Software rendering (two cores) draws so many faces about ten times a second, which jerks.
const int leastFaces = 200000;
// Largest share of the faces that move: with more, a picture saves little.
const double mostMoving = 0.5;

} // namespace

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
    vcg::fcd::ParallelFor(0, mesh.face.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f)
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
