// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MOVING_PART_H
#define FCD_MOVING_PART_H

#include "edit_fcd/view/camera.h"
#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/edit_host.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <QOpenGLBuffer>
#include <QOpenGLFramebufferObject>
#include <QPointer>

/// How the host draws the faces of a layer.
struct LayerLook {
    bool isLit = true, isCulled = false;
    bool hasVertexColors = false;
    vcg::Color4b color; ///< without vertex colours

    /// None unless only smooth faces without textures are drawn, as LayerPart can.
    static std::optional<LayerLook> of(const MLRenderingData &data, const CMeshO &mesh);
};

/// Draws some faces of a layer as the host would. Buffers are written when the layer has moved.
class LayerPart {
  public:
    /// \param isIn one per face slot
    LayerPart(const CMeshO &mesh, const std::vector<char> &isIn, const LayerLook &look);

    std::size_t faces() const { return element.size() / 3; }
    /// Call when the layer's positions or normals have changed.
    void move() { isMoved = true; }
    /// \pre the context of the view is current, and has the transformation of the world
    void draw(const GLArea &view);

  private:
    void write();

    const CMeshO &mesh;
    LayerLook look;
    std::vector<std::uint32_t> slot;     ///< of the vertices that are drawn
    std::vector<std::uint32_t> element;  ///< three corners per face, indices into \p slot
    std::vector<float> position, normal; ///< three of each vertex
    QOpenGLBuffer positions, normals, colors, elements;
    bool isMoved = true, isNew = true;
};

/// Draws a large layer while a part of it is dragged. What stays is drawn once, and kept as a picture with depth. Each
/// frame draws only what moves. Meanwhile, the host does not draw the layer.
class MovingPart {
  public:
    /// Null if the host should draw the layer: it is small, mostly moves, has a look that LayerLook does not know, or
    /// is in several views. \param tags one per vertex slot \param over colours as in LayerOverlay::show; empty: none
    static std::unique_ptr<MovingPart> of(GLArea &view, const MeshModel &layer, const std::vector<int> &tags,
                                          std::vector<vcg::Color4b> over);
    MovingPart(const MovingPart &) = delete;
    MovingPart &operator=(const MovingPart &) = delete;
    ~MovingPart();

    /// Call when the layer's shape has changed. \param tags now
    void move(const std::vector<int> &tags);
    /// Draws the layer, and what is over it. \pre as LayerPart::draw() \return false: it cannot, so the host must
    bool draw(const Camera &seen);

  private:
    MovingPart(GLArea &view, const MeshModel &layer, const LayerLook &look, std::vector<vcg::Color4b> over);
    void take(const std::vector<int> &newTags);
    bool isPictureOf(const Camera &seen) const;
    bool copy(bool toPicture) const;

    QPointer<GLArea> view;
    const MeshModel &layer;
    int layerId;
    LayerLook look;
    std::vector<vcg::Color4b> over;
    std::vector<int> tags;
    std::vector<char> isMoving; ///< one per face slot
    std::unique_ptr<LayerPart> part;
    LayerOverlay overPart;
    std::unique_ptr<QOpenGLFramebufferObject> picture; ///< of what stays
    Camera pictureSeen;
};

#endif
