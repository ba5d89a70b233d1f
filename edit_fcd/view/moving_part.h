// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MOVING_PART_H
#define FCD_MOVING_PART_H

#include "edit_fcd/view/camera.h"
#include "edit_fcd/view/layer_overlay.h"
#include "edit_fcd/view/layer_part.h"

#include <memory>
#include <vector>

#include <QOpenGLFramebufferObject>
#include <QPointer>

/// A large layer while a part of it is dragged: what stays is drawn once, and kept as a picture with its depth; in each
/// frame only what moves is drawn, and given to the graphics card. The host does not draw the layer meanwhile.
class MovingPart {
  public:
    /// Null where the host had better draw the layer: a small one, or one that moves as a whole, is shown otherwise
    /// than LayerLook knows, or in several views.
    /// \param tags one per vertex slot \param over colours of LayerOverlay::show, empty: none
    static std::unique_ptr<MovingPart> of(GLArea &view, const MeshModel &layer, const std::vector<int> &tags,
                                          std::vector<vcg::Color4b> over);
    MovingPart(const MovingPart &) = delete;
    MovingPart &operator=(const MovingPart &) = delete;
    ~MovingPart();

    /// The layer has another shape from now on. \param tags now
    void move(const std::vector<int> &tags);
    /// Draws the layer, and what is over it. \pre as LayerPart::draw() \return whether it could: if not, the host has
    /// to
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
    std::unique_ptr<QOpenGLFramebufferObject> picture; ///< of all that stays
    Camera pictureSeen;
};

#endif
