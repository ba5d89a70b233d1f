// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/drag_interaction.h"

#include "edit_fcd/view/layer_ray.h"

// A stroke along a limb tells where a turn is, and of what.

bool DragInteraction::isShort(const Eigen::Vector3d &from) const {
    const double leastStroke = 5; // pixels: a hand moves less while it clicks
    return (stage.mouseInWindow() - from).head<2>().norm() < leastStroke;
}

/// It begins where R was pressed, before the mouse has turned anything: there is nothing yet that a press would keep.
bool DragInteraction::beginStroke(const QMouseEvent &event) {
    const bool isWaiting = now->modal && now->kind == BendDrag::Turn && now->axis < 0 && now->typed.empty() &&
                           isShort(gripped) && stage.isPlain(event);
    const std::optional<std::size_t> slot = isWaiting ? stage.slotAtMouse() : std::nullopt;
    if (!slot)
        return false;
    const Eigen::Vector3d window = stage.mouseInWindow();
    const auto through = middleBehind(*stage.model, stage.seen, window.head<2>());
    stop(false);
    stage.comeToRest();
    stroke = Stroke{window, {*slot, *slot, through.value_or(stage.session->positionOf(*slot))}, {}};
    stroke->pressed[2] = stage.seen.toWindow(stroke->way.through)[2];
    return true;
}

/// What would turn if it ended here: at what is nearest to the mouse, also beside the layer.
void DragInteraction::showStroke() {
    BendSession &session = *stage.session;
    Eigen::Vector3d window = stage.mouseInWindow();
    window[2] = stroke->pressed[2];
    double distance = 0;
    stroke->way.to = session.nearest(stage.pick().value_or(stage.seen.toWorld(window)), distance).value();
    stroke->turned = session.glimpseStroke(stroke->way, stage.panel->radius() * session.diagonal());
    const BendSession::Turned &turned = stroke->turned;
    if (stage.colors->preview(turned.tag ? session.glimpseOf(turned.tag) : turned.extent))
        stage.showOverlay();
    stage.refresh();
    stage.view->update();
}

void DragInteraction::endStroke() {
    if (!stage.layer() || isShort(stroke->pressed)) {
        cancel();
        return;
    }
    showStroke();
    Grip again;
    again.slot = stroke->way.to;
    again.part = {BendDrag::Turn, -1};
    again.modal = true;
    again.stroke = stroke->way;
    stroke.reset();
    stage.colors->preview(nullptr); // the turn shows what it moves
    begin(again);
    stage.refresh();
}

void DragInteraction::draw() const {
    if (!stroke)
        return;
    Eigen::Vector3d to = stage.mouseInWindow();
    to[2] = stroke->pressed[2];
    Eigen::Matrix3Xd line(3, 2);
    line << (stroke->turned.extent ? stroke->turned.pivot : stroke->way.through), stage.seen.toWorld(to);
    drawLine(line, line);
}
