// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/marks.h"

#include "edit_fcd/bend/model/handles.h"

#include "edit_fcd/view/layer_ray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <QCursor>

using vcg::fcd::Error;

// --- the mouse ---

Eigen::Vector3d BendTool::windowOf(const QPointF &place) const { return ::windowOf(*view, seen, place); }

std::optional<Eigen::Vector3d> BendTool::pick() const {
    Eigen::Vector3d window = mouseInWindow();
    float depth = 1;
    view->makeCurrent();
    glReadPixels(int(window[0]), int(window[1]), 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    if (!(depth < 1))
        return {};
    window[2] = depth;
    return seen.toWorld(window);
}

/// Hands an event on to the camera.
void BendTool::toCamera(QMouseEvent *event) {
    isCamera = event->type() != QEvent::MouseButtonRelease;
    ::toCamera(*view, event);
}

void BendTool::press(QMouseEvent *event) {
    sinceEvent.start();
    hint.clear();
    isClicked = false;
    mouse = event->localPos();
    if (preparing) {
        if (event->button() == Qt::RightButton)
            preparing->cancel();
        return;
    }
    if (drag) {
        endDrag(event->button() == Qt::LeftButton);
        return;
    }
    const bool plain = event->button() == Qt::LeftButton && event->modifiers() == Qt::NoModifier && !isCamera;
    const bool isPolygon = marking && marking->kind == BendMarking::Polygon;
    if (!plain || !isReady()) {
        if (marking && isPolygon && event->button() == Qt::RightButton)
            endMarking();
        else
            toCamera(event);
        return;
    }
    const Eigen::Vector2d corner = mouseInWindow().head<2>();
    switch (panel->mode()) {
    case BendPanel::Bend:
        if (!grab())
            toCamera(event);
        break;
    case BendPanel::Brush:
        if (!pick()) {
            toCamera(event);
            break;
        }
        beginMarking(BendMarking::Brush);
        brush();
        break;
    case BendPanel::Rectangle:
        beginMarking(BendMarking::Rectangle);
        marking->corners = {corner, corner};
        break;
    case BendPanel::Polyline:
        if (!marking || !isPolygon)
            beginMarking(BendMarking::Polygon);
        marking->corners.push_back(corner);
        break;
    case BendPanel::Line:
        if (!pressLine())
            toCamera(event);
        break;
    }
    refresh();
    view->update();
    if (panel->mode() == BendPanel::Line && std::getenv("FCD_TRACE"))
        std::fprintf(stderr, "FCD trace: click: %d vertices, %d points, since the event %.1f ms\n", model->cm.vn,
                     int(session->state().line.size()), double(sinceEvent.nsecsElapsed()) / 1e6);
}

/// What is marked quickly is marked; else the view turns about the place under the mouse from then on, as the host has
/// it, and the handle that the first click was about to make is none.
void BendTool::doubleClick(QMouseEvent *event) {
    if (panel->mode() != BendPanel::Bend && event->button() == Qt::LeftButton) {
        if (marking && marking->kind == BendMarking::Polygon)
            endMarking();
        else
            press(event);
        return;
    }
    if (drag)
        return;
    if (preparing) {
        preparing->cancel();
    } else if (isClicked && layer()) {
        session->cancel();
        showOverlay();
        solve(true);
        refresh();
    }
    isClicked = false;
    toHost(*view, event);
}

/// Whether the mouse, which has moved or was released, is for the layer, and not for the camera.
bool BendTool::isForLayer(QMouseEvent *event) {
    mouse = event->localPos();
    const bool isForCamera = isCamera; // a release ends that
    if (isForCamera)
        toCamera(event);
    if (preparing && event->type() == QEvent::MouseButtonRelease)
        isReleased = true;
    return !isForCamera && !preparing && layer();
}

void BendTool::move(QMouseEvent *event) {
    sinceEvent.start();
    if (!isForLayer(event))
        return;
    const bool isHeld = event->buttons() & Qt::LeftButton;
    if (drag && !drag->modal && !isHeld) { // it was released elsewhere, over a question of the host
        endDrag(true);
    } else if (drag) {
        drag->snap = event->modifiers() & Qt::ControlModifier;
        drag->onto.reset();
        if (event->modifiers() & Qt::ShiftModifier)
            drag->onto = hitOthers(*view->md(), *model, seen, mouseInWindow().head<2>());
        drag->moveTo(seen, mouseInWindow());
        requestStep();
    } else if (marking && marking->kind != BendMarking::Polygon && !isHeld) {
        endMarking();
    } else if (marking && marking->kind == BendMarking::Brush) {
        brush();
    } else if (marking && isHeld) {
        marking->corners.back() = mouseInWindow().head<2>();
    } else if (linePoint && isHeld) {
        dragLinePoint();
    } else if (panel && panel->mode() == BendPanel::Brush) {
        view->update();
    } else if (panel && panel->mode() == BendPanel::Bend && event->buttons() == Qt::NoButton) {
        hover();
    }
}

void BendTool::release(QMouseEvent *event) {
    linePoint.reset();
    if (!isForLayer(event))
        return;
    if (drag && !drag->modal)
        endDrag(true);
    else if (marking && marking->kind != BendMarking::Polygon)
        endMarking();
}

void BendTool::turnWheel(QWheelEvent *event) {
    const double steps = event->angleDelta().y() / 120.0;
    if (drag && session) {
        panel->setRadius(radiusOf(session->model(), drag->tag) / session->diagonal() * std::pow(1.1, steps));
        session->setRadius(drag->tag, panel->radius() * session->diagonal());
        requestStep();
    } else if (panel && panel->mode() == BendPanel::Bend && event->modifiers() == Qt::ControlModifier && isReady() &&
               changeRim(std::pow(1.1, steps))) {
        view->update();
    } else if (panel && panel->mode() == BendPanel::Brush && event->modifiers() == Qt::NoModifier) {
        panel->setBrush(int(std::lround(panel->brush() * std::pow(1.15, steps) + (steps > 0 ? 0.5 : -0.5))));
        view->update();
    } else {
        toHost(*view, event);
    }
}

/// Where the mouse is now: keys, and the wheel, come without it.
void BendTool::findMouse() { mouse = view->mapFromGlobal(QCursor::pos()); }

/// The free rim of the mark under the mouse gets so many times as wide. \return whether there is a mark
bool BendTool::changeRim(double times) {
    findMouse();
    const auto [tag, found] = placeAtMouse();
    const auto &marks = session->state().marks;
    if (!tag && !(found && marks && (*marks)[*found] == 0))
        return false;
    const std::size_t slot = found.value_or(0); // of what is fixed, where there is no handle
    // A way of the wheel is one step of undo.
    if (!sinceRim.isValid() || sinceRim.hasExpired(1000))
        session->change();
    sinceRim.start();
    const double least = 0.005 * session->diagonal(), most = 4 * session->diagonal(); // as in the panel
    const double before = tag ? radiusOf(session->model(), tag) : rimAt(session->state(), slot, session->diagonal()),
                 rim = std::min(std::max(before * times, least), most);
    if (tag)
        session->setRadius(tag, rim);
    else
        session->setRimAt(slot, rim);
    const double percent = 100 * rim / session->diagonal();
    const bool isPoint = session->state().points.count(tag) > 0; // which has no rim, but bends as far
    hint = QString(isPoint ? "%1: bends what is within %2 % of the diagonal."
                           : "%1: nothing else is held within %2 % of the diagonal.")
               .arg(tag ? QString::fromStdString(nameOf(session->state(), tag)) : QString("What is fixed here"))
               .arg(isPoint ? percent : gapOfRadius * percent, 0, 'f', 1);
    showOverlay();
    solve(true);
    refresh();
    return true;
}

/// The point handle at a place of the window, 0: none. \param least pixels that it is near
int BendTool::pointAt(const Eigen::Vector2d &window, double least) const {
    int tag = 0;
    for (const auto &point : session->state().points) {
        const double d = (seen.toWindow(dotOf(session->model(), point.first)).head<2>() - window).norm();
        if (d < least && !handleOf(session->state(), point.first).isHidden) {
            least = d;
            tag = point.first;
        }
    }
    return tag;
}

/// The vertex of the layer under the mouse, none where there is nothing, or another layer.
std::optional<std::size_t> BendTool::slotAtMouse() const {
    const std::optional<Eigen::Vector3d> place = pick();
    double distance = 0;
    const std::optional<std::size_t> slot = place ? session->nearest(*place, distance) : std::nullopt;
    return slot && distance <= 0.02 * session->diagonal() ? slot : std::nullopt;
}

BendTool::Place BendTool::placeAtMouse() const {
    if (const int point = pointAt(mouseInWindow().head<2>()))
        return {point, {}};
    const std::optional<std::size_t> slot = slotAtMouse();
    if (!slot)
        return {};
    const int tag = session->tags()[*slot];
    return tag >= 2 && !isAlong(session->model(), *slot) ? Place{tag, {}} : Place{0, slot};
}

/// The part of the gizmo under the mouse, none where that is on the dot of another handle, which a ring may cross.
std::optional<GizmoPart> BendTool::partAtMouse() const {
    const std::optional<Gizmo> shown = gizmo();
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    const int point = shown ? pointAt(window, dotPixels / 2 + 1) : 0;
    return shown && (!point || point == selected()) ? gizmoAt(seen, *shown, window) : std::nullopt;
}

/// What is under the mouse lights up.
void BendTool::hover() {
    const std::optional<GizmoPart> part = partAtMouse();
    const Place place = part ? Place() : placeAtMouse();
    const bool isBegin = beginsByKey(place);
    if (place.tag == hovered && part == lit && isBegin == keysBegin)
        return;
    hovered = place.tag;
    lit = part;
    keysBegin = isBegin;
    panel->showState(stateText());
    view->update();
}

/// Begins to drag what is under the mouse. \return false where there is nothing to drag
bool BendTool::grab() {
    if (const std::optional<GizmoPart> part = partAtMouse()) {
        beginDrag({selected(), 0, *part, false});
        return true;
    }
    const Place place = placeAtMouse();
    if (!place.tag && !place.slot)
        return false;
    if (place.slot && !isFree(session->state(), *place.slot)) {
        hint = "This part is fixed: the camera moves. Mark it as free first (U), or clear the marks.";
        return false;
    }
    beginDrag({place.tag, place.slot.value_or(0), {}, false});
    return true;
}
