// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include "bend_sight.h"

#include <cmath>

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
    if (drag) {
        drag->snap = event->modifiers() & Qt::ControlModifier;
        drag->onto.reset();
        if (event->modifiers() & Qt::ShiftModifier) {
            const Eigen::Vector3d window = mouseInWindow();
            drag->onto = firstOnOthers(*view->md(), *model, seen.toWorld({window[0], window[1], 0}),
                                       seen.toWorld({window[0], window[1], 1}));
        }
        drag->moveTo(seen, mouseInWindow());
        requestStep();
    } else if (marking && marking->kind == BendMarking::Brush) {
        brush();
    } else if (marking && (event->buttons() & Qt::LeftButton)) {
        marking->corners.back() = mouseInWindow().head<2>();
    } else if (linePoint) {
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
        panel->setRadius(panel->radius() * std::pow(1.1, steps));
        session->setRadius(drag->tag, panel->radius() * session->diagonal());
        requestStep();
    } else if (panel && panel->mode() == BendPanel::Brush && event->modifiers() == Qt::NoModifier) {
        panel->setBrush(int(std::lround(panel->brush() * std::pow(1.15, steps) + (steps > 0 ? 0.5 : -0.5))));
        view->update();
    } else {
        toHost(*view, event);
    }
}

/// The point handle at a place of the window, 0: none.
int BendTool::pointAt(const Eigen::Vector2d &window) const {
    double least = 12;
    int tag = 0;
    for (const auto &point : session->state().points) {
        const double d = (seen.toWindow(session->centerOf(point.first)).head<2>() - window).norm();
        if (d < least && !session->handle(point.first).isHidden) {
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

/// The handle under the mouse, 0: none.
int BendTool::handleAtMouse() const {
    if (const int point = pointAt(mouseInWindow().head<2>()))
        return point;
    const std::optional<std::size_t> slot = slotAtMouse();
    return slot && session->tags()[*slot] >= 2 ? session->tags()[*slot] : 0;
}

/// What is under the mouse lights up.
void BendTool::hover() {
    const std::optional<Gizmo> shown = gizmo();
    const auto part = shown ? gizmoAt(seen, *shown, mouseInWindow().head<2>()) : std::nullopt;
    const int handle = part ? 0 : handleAtMouse();
    if (handle == hovered && part == lit)
        return;
    hovered = handle;
    lit = part;
    panel->showState(stateText());
    view->update();
}

/// Begins to drag what is under the mouse. \return false where there is nothing to drag
bool BendTool::grab() {
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    if (const std::optional<Gizmo> shown = gizmo())
        if (const std::optional<GizmoPart> part = gizmoAt(seen, *shown, window)) {
            beginDrag({selected(), 0, *part, false});
            return true;
        }
    int tag = pointAt(window);
    if (!tag) {
        const std::optional<std::size_t> slot = slotAtMouse();
        if (!slot)
            return false;
        tag = session->tags()[*slot];
        if (tag < 2) {
            if (!session->isFree(*slot)) {
                hint = "This part is fixed: the camera moves. Mark it as free first (U), or clear the marks.";
                return false;
            }
            beginDrag({0, *slot, {}, false});
            return true;
        }
    }
    beginDrag({tag, 0, {}, false});
    return true;
}
