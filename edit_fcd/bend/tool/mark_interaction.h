// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_MARK_INTERACTION_H
#define FCD_BEND_MARK_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"
#include "edit_fcd/view/brush.h"

/// Marks vertices as the panel says, by brush, rectangle or polygon.
class MarkInteraction : public BendInteraction {
  public:
    enum Kind { Brush, Rectangle, Polygon };

    MarkInteraction(BendStage &stage, Kind kind);
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
    std::vector<Eigen::Vector2d> outline() const;
    void mark(const SeenPart::IsIn &isIn);
    void brush();
    void end();

    // In window coordinates:
    Kind kind;
    std::vector<Eigen::Vector2d> corners; ///< of a polygon; a rectangle's two opposite ones; a brush's last place
    std::vector<float> depth;             ///< from depthOf, to mark visible vertices only; empty: all
};

#endif
