// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/drag_interaction.h"

#include "edit_fcd/view/pointing.h"

// A stroke along a limb sets the pivot of a turn, and what turns.

/// Whether the mouse is where the drag began.
bool DragInteraction::isNear() const {
    return (stage.mouseInWindow() - gripped).head<2>().norm() < 5; // pixels: less is a click
}

/// Begins where R was pressed, if the mouse has turned nothing yet. (Otherwise a press ends the turn.)
bool DragInteraction::beginStroke(const QMouseEvent &event) {
    const bool isWaiting = now->modal && now->kind == BendDrag::Turn && now->axis < 0 && now->typed.empty();
    const auto slot = isWaiting && isNear() && stage.isPlain(event) ? stage.slotAtMouse() : std::nullopt;
    if (!slot)
        return false;
    gripped = stage.mouseInWindow();
    const auto through = middleBehind(*stage.model, stage.seen, gripped.head<2>());
    stop(false);
    stage.comeToRest();
    stroke = BendStroke{*slot, *slot, through.value_or(stage.session->positionOf(*slot))};
    turned = {};
    held = stroke->through;
    return true;
}

/// Shows what would turn if the stroke ended at the place nearest to the mouse, also beside the layer.
void DragInteraction::showStroke(BendStroke &drawn) {
    BendSession &session = *stage.session;
    Eigen::Vector3d window = stage.mouseInWindow();
    window[2] = stage.seen.toWindow(drawn.through)[2];
    held = stage.seen.toWorld(window);
    double distance = 0;
    drawn.to = session.nearest(stage.pick().value_or(held), distance).value_or(drawn.from);
    turned = session.glimpseStroke(drawn, stage.panel->radius() * session.diagonal());
    const auto own = turned.tag ? session.glimpseOf(turned.tag) : turned.extent;
    if (stage.colors->preview({own, own ? session.glimpseTwin(turned.tag, *own) : nullptr}))
        stage.showOverlay();
    stage.refreshAll();
}

void DragInteraction::endStroke() {
    if (!stroke || !stage.layer() || isNear()) {
        cancel();
        return;
    }
    BendStroke drawn = *stroke;
    showStroke(drawn);
    stage.colors->preview({}); // the turn has its own preview
    stroke.reset();
    begin({0, drawn.to, {BendDrag::Turn, -1}, true, false, false, drawn});
    stage.refresh();
}

void DragInteraction::draw() const {
    if (now && stage.session->model().influence.isLocal)
        drawBending(*stage.session, turning());
    if (!stroke)
        return;
    Eigen::Matrix3Xd line(3, 2);
    line << (turned.extent ? turned.pivot : stroke->through), held;
    drawLine(line, line);
}
