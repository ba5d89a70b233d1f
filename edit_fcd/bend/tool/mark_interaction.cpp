// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/mark_interaction.h"

MarkInteraction::MarkInteraction(BendStage &stage, BendMarking::Kind kind) : BendInteraction(stage) {
    marking.kind = kind;
    stage.session->change();
    stage.takeNewHandle();
    if (!stage.panel->isThrough())
        marking.depth = depthOf(*stage.view, stage.seen);
}

void MarkInteraction::begin() {
    const Eigen::Vector2d corner = stage.mouseInWindow().head<2>();
    if (marking.kind == BendMarking::Brush)
        brush();
    else
        marking.corners.assign(marking.kind == BendMarking::Rectangle ? 2 : 1, corner);
}

void MarkInteraction::brush() {
    const double radius = stage.panel->brush() * stage.view->devicePixelRatioF();
    stage.session->mark(marking.strokeTo(stage.mouseInWindow().head<2>(), radius, *stage.session, stage.seen),
                        stage.panel->tag());
    stage.showOverlay();
    stage.view->update();
}

void MarkInteraction::end() {
    stage.ended();
    if (!stage.layer())
        return;
    if (marking.kind != BendMarking::Brush) {
        const std::vector<std::size_t> found = marking.inside(*stage.session, stage.seen);
        if (!found.empty())
            stage.session->mark(found, stage.panel->tag());
    }
    stage.takeMarks();
    stage.refresh();
}

void MarkInteraction::cancel() {
    stage.ended();
    if (!stage.layer())
        return;
    stage.session->cancel();
    stage.showOverlay();
}

void MarkInteraction::move(QMouseEvent &event) {
    const bool isHeld = event.buttons() & Qt::LeftButton;
    if (marking.kind != BendMarking::Polygon && !isHeld)
        end(); // it was released elsewhere
    else if (marking.kind == BendMarking::Brush)
        brush();
    else if (isHeld)
        marking.corners.back() = stage.mouseInWindow().head<2>();
}

void MarkInteraction::release() {
    if (marking.kind != BendMarking::Polygon)
        end();
}

/// Adds a corner to a polygon, or ends it.
bool MarkInteraction::press(QMouseEvent &event) {
    if (marking.kind != BendMarking::Polygon)
        return false;
    if (stage.isPlain(event) && stage.panel->mode() == BendPanel::Polyline && stage.isReady())
        marking.corners.emplace_back(stage.mouseInWindow().head<2>());
    else if (event.button() == Qt::RightButton)
        end();
    else
        return false;
    stage.refresh();
    stage.view->update();
    return true;
}

bool MarkInteraction::doubleClick() {
    if (marking.kind != BendMarking::Polygon)
        return false;
    end();
    return true;
}

void MarkInteraction::draw() const {
    if (marking.kind != BendMarking::Brush)
        drawOutline(stage.seen, marking.outline());
}
