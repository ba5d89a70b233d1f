// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_MARK_INTERACTION_H
#define FCD_BEND_MARK_INTERACTION_H

#include "edit_fcd/bend/tool/marking.h"
#include "edit_fcd/bend/tool/stage.h"

/// Marks vertices as the panel says, by brush, rectangle or polygon.
class MarkInteraction : public BendInteraction {
  public:
    MarkInteraction(BendStage &stage, BendMarking::Kind kind);
    /// Begins at the mouse.
    void begin();
    void cancel() override;
    void move(QMouseEvent &event) override;
    void release() override;
    bool press(QMouseEvent &event) override;
    bool doubleClick() override;
    bool isCancelledByEsc() const override { return true; }
    void draw() const override;

  private:
    void brush();
    void end();

    BendMarking marking;
};

#endif
