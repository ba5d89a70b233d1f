// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_INTERACTION_H
#define FCD_BEND_INTERACTION_H

#include "edit_fcd/bend/tool/drag.h" // before Qt

#include <QKeyEvent>
#include <QMouseEvent>

class BendStage;

/// Gets mouse and keys while something goes on in the view: a drag, a marking, a move of a line's point, playing or
/// scrubbing key frames. At most one goes on. The stage owns it. It calls BendStage::ended() as its last action.
class BendInteraction {
  public:
    explicit BendInteraction(BendStage &stage) : stage(stage) {}
    BendInteraction(const BendInteraction &) = delete;
    BendInteraction &operator=(const BendInteraction &) = delete;
    virtual ~BendInteraction() = default;

    /// Takes back what was begun and has not ended. \pre there is a layer
    virtual void cancel() = 0;
    virtual void move(QMouseEvent &event) = 0;
    virtual void release() {}
    /// Each returns whether the event was for this.
    virtual bool press(QMouseEvent &) { return false; }
    virtual bool pressKey(QKeyEvent &) { return false; }
    virtual bool doubleClick() { return false; } ///< or Enter
    virtual bool turnWheel(double) { return false; }
    virtual bool takesAllKeys() const { return false; }
    virtual bool isCancelledByEsc() const { return takesAllKeys(); }
    /// Whether any other action ends this first.
    virtual bool isEndedByAll() const { return false; }
    /// Whether the panel's commands are refused until it has ended.
    virtual bool holdsPanel() const { return false; }
    /// The drag of a handle, or null.
    virtual const BendDrag *drag() const { return nullptr; }
    virtual void step() {} ///< once for each painted frame
    virtual void beforeDraw() {}
    virtual void draw() const {}
    /// A text for the panel; empty: the mode's text.
    virtual QString text() const { return {}; }

  protected:
    BendStage &stage;
};

#endif
