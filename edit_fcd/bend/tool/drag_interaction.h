// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_DRAG_INTERACTION_H
#define FCD_BEND_DRAG_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// Drags a handle, by the mouse or after a key. A stroke along a limb restarts a turn that was begun by a key.
class DragInteraction : public BendInteraction {
  public:
    /// What is dragged, once the layer is prepared.
    struct Grip {
        int tag = 0;          ///< of a handle; 0: a vertex becomes one
        std::size_t slot = 0; ///< of that vertex
        GizmoPart part;
        bool modal = false;
        bool isNew = false;                              ///< the handle \p tag was made of \p slot
        bool isHeld = false;                             ///< of a limb: \p slot follows the mouse, which \p tag holds
        std::optional<BendStroke> stroke = std::nullopt; ///< tells what turns and where, instead of \p tag
        int nearer = 0;                                  ///< of a limb, as in BendSession::limbAt()
        std::optional<Eigen::Vector3d> from = std::nullopt; ///< the mouse at the begin, window; none: where it is now
    };
    using BendInteraction::BendInteraction;

    /// Begins the drag: at once, or, for a large layer, when it has been prepared in the background.
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
    std::vector<int> turning() const;
    void showInfluence();
    void placePivot();
    void changeKind(BendDrag::Kind kind);
    void changeJoint(double steps);
    void restart(Grip &again);
    void stop(bool keep);
    void end(bool keep);

    std::unique_ptr<BendDrag> now;    ///< null until the layer is prepared
    std::optional<BendStroke> stroke; ///< while one is drawn, instead of \a now
    BendSession::Turned turned;       ///< by the stroke
    Grip grip;
    Eigen::Vector3d held;       ///< its vertex at the begin, or the mouse during a stroke; world
    int asked = 0;              ///< the tag for which the drag was asked
    int first = 0;              ///< of a limb that bends: the handle of its first joint; 0: it only turns
    Eigen::Vector3d gripped;    ///< the mouse at the begin, window
    double tookToPrepare = 0;   ///< milliseconds
    bool isRadiusShown = false; ///< the wheel has changed it
    bool isReleased = false;    ///< the button was released before the layer was prepared
    QElapsedTimer sinceDraw;
};

#endif
