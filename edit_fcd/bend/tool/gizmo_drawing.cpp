// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/gizmo_drawing.h"

#include "edit_fcd/bend/model/handles.h"

#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/edit_host.h>

#include <algorithm>
#include <cmath>

const int arrowPixels = 60, ringPixels = 42; // small: the surface below is visible, and can be hit
const int ringParts = 48;
const GLubyte litColor[] = {255, 225, 60};

/// A point of the ring that turns about an axis. \param part of ringParts
static Eigen::Vector3d onRing(const Gizmo &gizmo, int axis, double radius, int part) {
    const double angle = part * (360.0 / ringParts) * oneDegree;
    return gizmo.center + radius * (std::cos(angle) * gizmo.axes.col((axis + 1) % 3) +
                                    std::sin(angle) * gizmo.axes.col((axis + 2) % 3));
}

std::optional<GizmoPart> gizmoAt(const Camera &view, const Gizmo &gizmo, const Eigen::Vector2d &window) {
    const Eigen::Vector3d &center = gizmo.center;
    const auto flat = [&](const Eigen::Vector3d &p) { return Eigen::Vector2d(view.toWindow(p).head<2>()); };
    if ((flat(center) - window).norm() < 15) // before rings, which may cross the ball
        return GizmoPart();
    const double pixel = view.pixelAt(center);
    std::optional<GizmoPart> hit;
    double least = 5; // pixels: farther presses drag the surface
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d arrow = arrowPixels * pixel * gizmo.axes.col(axis);
        const Eigen::Vector2d a = flat(center + arrow * 0.3), b = flat(center + arrow);
        if (const double d = distanceToSegment(window, a, b); d < least && (b - a).norm() > 10) {
            least = d;
            hit = GizmoPart{BendDrag::Move, axis};
        }
        for (int i = 0; i < ringParts; ++i) {
            const Eigen::Vector2d p = flat(onRing(gizmo, axis, ringPixels * pixel, i)),
                                  q = flat(onRing(gizmo, axis, ringPixels * pixel, i + 1));
            if (const double d = distanceToSegment(window, p, q); d < least) {
                least = d;
                hit = GizmoPart{BendDrag::Turn, axis};
            }
        }
    }
    return hit;
}

void drawBending(const BendSession &session, const std::vector<int> &turning) {
    const FlatDrawing flat;
    const BendTags &tags = session.tags();
    const std::size_t some = tags.size() / 20000 + 1;
    glPointSize(2);
    glColor3ub(240, 197, 60);
    glBegin(GL_POINTS);
    const auto draw = [&](std::size_t slot) {
        if (slot % some == 0 && tags[slot] == 1)
            put(session.positionOf(slot));
    };
    for (const int tag : turning)
        if (const auto extent = valueOr(session.model().influence.extents, tag))
            std::for_each(extent->around.begin(), extent->around.end(), draw);
        else if (tag) // the only handle: all that bends is of it
            for (std::size_t i = 0; i < tags.size(); i += some)
                draw(i);
    glEnd();
}

void drawPoints(const BendSession &session, int lit) {
    const FlatDrawing flat;
    for (const auto &point : session.state().points)
        if (!handleOf(session.state(), point.first).isHidden) {
            glColor3ub(210, 60, 50);
            drawPoint(dotOf(session.model(), point.first), dotPixels);
        }
    if (lit) {
        glColor3ubv(litColor);
        drawPoint(dotOf(session.model(), lit), 12);
    }
}

void drawPivot(const Eigen::Vector3d &place) {
    const FlatDrawing flat;
    glColor3ub(20, 20, 20);
    drawPoint(place, 10);
    glColor3ubv(litColor);
    drawPoint(place, 6);
}

void drawGizmo(const Camera &view, const Gizmo &gizmo, const BendDrag *drag, const std::optional<GizmoPart> &lit) {
    const FlatDrawing flat;
    const double pixel = view.pixelAt(gizmo.center);
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d along = gizmo.axes.col(axis) * pixel;
        const auto begin = [&](BendDrag::Kind kind) { // brighter and thicker if highlighted or dragged
            const bool isLit = drag ? drag->axis == axis && (drag->kind == kind || drag->kind == BendDrag::Scale)
                                    : lit && *lit == GizmoPart{kind, axis};
            glLineWidth(isLit ? 4 : 2);
            if (isLit)
                glColor3ubv(litColor);
            else
                glColor3ub(axis == 0 ? 230 : 40, axis == 1 ? 190 : 40, axis == 2 ? 240 : 40);
            return isLit;
        };
        const bool isLine = begin(BendDrag::Move) && drag;
        glBegin(GL_LINES);
        put(isLine ? gizmo.center - 2000 * along : gizmo.center);
        put(gizmo.center + (isLine ? 2000 : arrowPixels) * along);
        glEnd();
        drawPoint(gizmo.center + arrowPixels * along, 8);
        begin(BendDrag::Turn);
        glBegin(GL_LINE_LOOP);
        for (int i = 0; i < ringParts; ++i)
            put(onRing(gizmo, axis, ringPixels * pixel, i));
        glEnd();
    }
    glColor3ub(250, 250, 250);
    if (lit && lit->axis < 0)
        glColor3ubv(litColor);
    drawPoint(gizmo.center, 14);
}

void drawLine(const Eigen::Matrix3Xd &points, const Eigen::Matrix3Xd &path) {
    const FlatDrawing flat;
    const bool isKnown = path.cols() > 0;
    for (const bool isInner : {false, true}) { // dark around light: seen on any ground
        const float width = isKnown ? 2 : 1;
        glLineWidth(isInner ? width : width + 2);
        if (isInner)
            glColor3ubv(litColor);
        else
            glColor3ub(20, 20, 20);
        glBegin(GL_LINE_STRIP);
        for (const auto &place : (isKnown ? path : points).colwise())
            put(place);
        glEnd();
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            drawPoint(points.col(i), (i == 0 ? 12.f : 9.f) - (isInner ? 3.f : 0.f));
    }
}
