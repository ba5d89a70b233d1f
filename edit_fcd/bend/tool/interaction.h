// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_INTERACTION_H
#define FCD_BEND_INTERACTION_H

#include "edit_fcd/bend/tool/drag.h" // before Qt

#include <QKeyEvent>
#include <QMouseEvent>

class BendStage;

/// What mouse and keys are for while something goes on in the view: a handle is dragged, vertices are marked, a point
/// of the line is moved, key frames are played or scrubbed. At most one goes on; the stage owns it, and it tells the
/// stage when it has ended, last.
class BendInteraction {
  public:
    explicit BendInteraction(BendStage &stage) : stage(stage) {}
    BendInteraction(const BendInteraction &) = delete;
    BendInteraction &operator=(const BendInteraction &) = delete;
    virtual ~BendInteraction() = default;

    /// Takes back what was begun, as far as that is not done. \pre there is a layer
    virtual void cancel() = 0;
    virtual void move(QMouseEvent &event) = 0;
    virtual void release() {}
    /// \return whether they are for this, which is not so unless said
    virtual bool press(QMouseEvent &) { return false; }
    virtual bool pressKey(QKeyEvent &) { return false; }
    virtual bool doubleClick() { return false; } ///< or Enter
    virtual bool turnWheel(double) { return false; }
    virtual bool takesAllKeys() const { return false; }
    virtual bool isCancelledByEsc() const { return takesAllKeys(); }
    /// Whether all that is done otherwise ends it first.
    virtual bool isEndedByAll() const { return false; }
    /// Whether the panel's commands wait until it has ended.
    virtual bool holdsPanel() const { return false; }
    /// What is dragged, null where it is no handle.
    virtual const BendDrag *drag() const { return nullptr; }
    virtual void step() {} ///< once what was shown is painted
    virtual void beforeDraw() {}
    virtual void draw() const {}
    /// What it does, empty where the mode says that.
    virtual QString text() const { return {}; }

  protected:
    BendStage &stage;
};

#endif
