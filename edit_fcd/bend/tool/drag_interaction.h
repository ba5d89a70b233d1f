// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_DRAG_INTERACTION_H
#define FCD_BEND_DRAG_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// A handle is dragged, by the mouse or after a key. A turn that waits is begun anew by a stroke along a limb.
class DragInteraction : public BendInteraction {
  public:
    /// What is going to be dragged, once the layer is prepared for it.
    struct Grip {
        int tag = 0;          ///< of a handle, or
        std::size_t slot = 0; ///< of a vertex that becomes one, where \p tag is 0
        GizmoPart part;
        bool modal = false;
        bool isNew = false;                              ///< what is at \p tag was made of \p slot
        bool isHeld = false;                             ///< a limb is to follow by \p slot, which \p tag holds
        std::optional<BendStroke> stroke = std::nullopt; ///< tells what is turned, and where, in the place of \p tag
    };
    using BendInteraction::BendInteraction;

    /// Begins a change that drags something: at once, or, with a large layer, when it is prepared, which goes on beside
    /// the window.
    void begin(const Grip &what);
    void cancel() override;
    void move(QMouseEvent &event) override;
    void release() override;
    bool press(QMouseEvent &event) override;
    bool pressKey(QKeyEvent &event) override;
    bool turnWheel(double steps) override;
    bool takesAllKeys() const override { return now || stroke; }
    bool holdsPanel() const override { return now || stroke; }
    const BendDrag *drag() const override { return now.get(); }
    void step() override;
    void beforeDraw() override;
    void draw() const override;
    QString text() const override;

  private:
    bool beginStroke(const QMouseEvent &event);
    bool isNear() const;
    void showStroke(BendStroke &drawn);
    void endStroke();
    void beginPrepared();
    void showInfluence();
    void placePivot();
    void changeKind(BendDrag::Kind kind);
    void stop(bool keep);
    void end(bool keep);

    std::unique_ptr<BendDrag> now;    ///< once the layer is prepared
    std::optional<BendStroke> stroke; ///< in its place, since the button was pressed while a turn waited
    BendSession::Turned turned;       ///< by that
    Grip grip;
    Eigen::Vector3d held;       ///< where its vertex was then, or the mouse is with a stroke; world
    int asked = 0;              ///< the tag of what was to be dragged
    int first = 0;              ///< of a limb that is bent: the handle of its first joint; 0: it is turned alone
    Eigen::Vector3d gripped;    ///< where the mouse was then, window
    double tookToPrepare = 0;   ///< milliseconds
    bool isRadiusShown = false; ///< the wheel has changed it
    bool isReleased = false;    ///< the button, before the layer was prepared
    QElapsedTimer sinceDraw;
};

#endif
