// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LINE_INTERACTION_H
#define FCD_BEND_LINE_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// The point of the line at a place of the window.
std::optional<std::size_t> linePointAt(const BendStage &stage);

/// Moves a point of the line, which may be new.
class LineInteraction : public BendInteraction {
  public:
    using BendInteraction::BendInteraction;
    /// Takes the point of the line under the mouse, or adds one there. \return whether there is a place for it
    bool begin();
    void cancel() override { stage.ended(); }
    void move(QMouseEvent &event) override;
    void release() override { stage.ended(); }

  private:
    std::size_t which = 0;
};

#endif
