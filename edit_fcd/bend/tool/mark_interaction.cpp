// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/mark_interaction.h"
#include "edit_fcd/bend/model/session.h"

#include <QPolygonF>

MarkInteraction::MarkInteraction(BendStage &stage, Kind kind) : BendInteraction(stage), kind(kind) {
    stage.session->change();
    stage.takeNewHandle();
    if (!stage.panel->isThrough())
        depth = depthOf(*stage.view, stage.seen);
}

void MarkInteraction::begin() {
    if (kind == Brush)
        brush();
    else
        corners.assign(kind == Rectangle ? 2 : 1, stage.mouseInWindow().head<2>());
}

/// Empty for a brush.
std::vector<Eigen::Vector2d> MarkInteraction::outline() const {
    if (kind == Rectangle && corners.size() == 2)
        return {corners[0], {corners[1][0], corners[0][1]}, corners[1], {corners[0][0], corners[1][1]}};
    return kind == Polygon ? corners : std::vector<Eigen::Vector2d>();
}

/// Marks the vertices in a part of the window, and those on the other side of the mirror.
void MarkInteraction::mark(const SeenPart::IsIn &isIn) {
    const BendSession &session = *stage.session;
    const Eigen::Affine3d mirror = mirrorOf(session.model());
    const SeenPart part(stage.seen, isIn, depth, session.diagonal());
    const std::vector<std::size_t> found = slotsThat(session.tags().size(), [&](std::size_t slot) {
        if (session.restShape().isDeleted(slot))
            return false;
        const Eigen::Vector3d p = session.positionOf(slot);
        return part.has(p) || (session.model().options.mirror >= 0 && part.has(mirror * p));
    });
    if (kind == Brush || !found.empty())
        stage.session->mark(found, stage.panel->tag());
}

/// Moves the brush to the mouse.
void MarkInteraction::brush() {
    const double radius = stage.panel->brush() * stage.view->devicePixelRatioF();
    const Eigen::Vector2d to = stage.mouseInWindow().head<2>(), from = corners.empty() ? to : corners.back();
    corners = {to};
    mark([&](const Eigen::Vector2d &p) { return distanceToSegment(p, from, to) <= radius; });
    stage.showOverlay();
    stage.view->update();
}

void MarkInteraction::end() {
    stage.ended();
    if (!stage.layer())
        return;
    QPolygonF polygon;
    for (const Eigen::Vector2d &corner : outline())
        polygon << QPointF(corner[0], corner[1]);
    if (kind != Brush)
        mark([&](const Eigen::Vector2d &p) { return polygon.containsPoint(QPointF(p[0], p[1]), Qt::OddEvenFill); });
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
    if (kind != Polygon && !isHeld)
        end(); // it was released elsewhere
    else if (kind == Brush)
        brush();
    else if (isHeld)
        corners.back() = stage.mouseInWindow().head<2>();
}

void MarkInteraction::release() {
    if (kind != Polygon)
        end();
}

/// Adds a corner to a polygon, or ends it.
bool MarkInteraction::press(QMouseEvent &event) {
    if (kind != Polygon)
        return false;
    if (stage.isPlain(event) && stage.panel->mode() == BendPanel::Polyline && stage.isReady())
        corners.emplace_back(stage.mouseInWindow().head<2>());
    else if (event.button() == Qt::RightButton)
        end();
    else
        return false;
    stage.refresh();
    stage.view->update();
    return true;
}

bool MarkInteraction::doubleClick() {
    if (kind != Polygon)
        return false;
    end();
    return true;
}

void MarkInteraction::draw() const {
    if (kind != Brush)
        drawOutline(stage.seen, outline());
}
