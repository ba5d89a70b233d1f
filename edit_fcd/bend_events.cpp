// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include <cmath>

#include <QCoreApplication>
#include <QCursor>

using vcg::fcd::Error;

// --- the mouse ---

Eigen::Vector3d BendTool::windowOf(const QPointF &place) const {
    const double ratio = view->devicePixelRatioF();
    return {(place.x() + 0.5) * ratio, seen.height - (place.y() + 0.5) * ratio, 0};
}

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

/// Hands an event on to the view, past this tool.
void BendTool::toHost(QEvent *event) {
    view->suspendedEditor = true;
    QCoreApplication::sendEvent(view, event);
    view->suspendedEditor = false;
}

/// Hands an event on to the camera, as one of the left button where it is of the right one.
void BendTool::toCamera(QMouseEvent *event) {
    isCamera = event->type() != QEvent::MouseButtonRelease;
    const auto asLeft = [](Qt::MouseButtons buttons) {
        return (buttons & Qt::RightButton) != 0 ? (buttons & ~Qt::RightButton) | Qt::LeftButton : buttons;
    };
    QMouseEvent copy(event->type(), event->localPos(), event->windowPos(), event->screenPos(),
                     event->button() == Qt::RightButton ? Qt::LeftButton : event->button(), asLeft(event->buttons()),
                     event->modifiers() & ~Qt::AltModifier);
    toHost(&copy);
}

void BendTool::press(QMouseEvent *event) {
    sinceEvent.start();
    mouse = event->localPos();
    if (drag) {
        endDrag(event->button() == Qt::LeftButton);
        return;
    }
    const bool plain = event->button() == Qt::LeftButton && event->modifiers() == Qt::NoModifier && !isCamera;
    const bool isPolygon = marking && marking->kind == BendMarking::Polygon;
    if (!isReady() || !plain) {
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
    return !isForCamera && layer();
}

void BendTool::move(QMouseEvent *event) {
    sinceEvent.start();
    if (!isForLayer(event))
        return;
    if (drag) {
        drag->moveTo(seen, mouseInWindow());
        requestStep();
    } else if (marking && marking->kind == BendMarking::Brush) {
        brush();
    } else if (marking && (event->buttons() & Qt::LeftButton)) {
        marking->corners.back() = mouseInWindow().head<2>();
    } else if (panel && panel->mode() == BendPanel::Brush) {
        view->update();
    }
}

void BendTool::release(QMouseEvent *event) {
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
        toHost(event);
    }
}

/// Begins to drag what is under the mouse. \return false where there is nothing to drag
bool BendTool::grab() {
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    if (hasGizmo()) {
        if (const std::optional<GizmoPart> part = gizmoAt(seen, session->centerOf(active), window)) {
            session->change();
            beginDrag(active, *part, false);
            return true;
        }
    }
    double least = 12;
    int tag = 0;
    for (const auto &point : session->state().points) {
        const double d = (seen.toWindow(session->centerOf(point.first)).head<2>() - window).norm();
        if (d < least) {
            least = d;
            tag = point.first;
        }
    }
    if (!tag) {
        const std::optional<Eigen::Vector3d> place = pick();
        double distance = 0;
        const std::optional<std::size_t> slot = place ? session->nearest(*place, distance) : std::nullopt;
        if (!slot || distance > 0.02 * session->diagonal())
            return false; // nothing, or another layer
        tag = session->tags()[*slot];
        if (tag < 2) {
            if (!session->isFree(*slot)) {
                panel->showState("This part is fixed. Mark it as free first, or clear the marks.");
                return false;
            }
            session->change();
            beginDrag(session->addPoint(*slot, panel->radius() * session->diagonal()), {}, false);
            return true;
        }
    }
    session->change();
    beginDrag(tag, {}, false);
    return true;
}

// --- keys ---

bool BendTool::eventFilter(QObject *object, QEvent *event) {
    if (object == view && view && !view->suspendedEditor && session) {
        if (event->type() == QEvent::Enter)
            view->setFocus(); // keys belong to what is under the mouse
        if (event->type() == QEvent::ShortcutOverride) {
            const auto *key = static_cast<QKeyEvent *>(event);
            const bool isOurs =
                (key->key() == Qt::Key_Z || key->key() == Qt::Key_Return || key->key() == Qt::Key_Enter) &&
                (key->modifiers() & Qt::ControlModifier);
            if (isOurs || (key->key() == Qt::Key_Escape && (drag || marking))) {
                event->accept();
                return true;
            }
        }
        if (event->type() == QEvent::MouseButtonDblClick && panel && panel->mode() != BendPanel::Bend) {
            guarded([&] {
                if (marking && marking->kind == BendMarking::Polygon)
                    endMarking();
                else
                    press(static_cast<QMouseEvent *>(event));
            });
            return true;
        }
    }
    return HostEditTool::eventFilter(object, event);
}

void BendTool::pressKeyWhileDragging(QKeyEvent *event) {
    const QString text = event->text();
    switch (const int key = event->key()) {
    case Qt::Key_Escape:
    case Qt::Key_Return:
    case Qt::Key_Enter: endDrag(key != Qt::Key_Escape); return;
    case Qt::Key_X:
    case Qt::Key_Y:
    case Qt::Key_Z: drag->axis = drag->axis == key - Qt::Key_X ? -1 : key - Qt::Key_X; break;
    case Qt::Key_G: drag->kind = BendDrag::Move; break;
    case Qt::Key_R: drag->kind = BendDrag::Turn; break;
    case Qt::Key_S: drag->kind = BendDrag::Scale; break;
    case Qt::Key_Backspace:
        if (!drag->typed.empty())
            drag->typed.pop_back();
        break;
    default:
        if (text.size() == 1 && QString("0123456789.-").contains(text))
            drag->typed += text.toStdString();
    }
    requestStep();
}

/// Begins to move the active handle with the mouse, without a button.
void BendTool::dragByKey(BendDrag::Kind kind) {
    const std::vector<int> handles = session->handleTags();
    if (handles.empty())
        throw Error("There is no handle yet: mark one, or drag a point of the surface.");
    if (!hasGizmo())
        active = handles.front();
    mouse = view->mapFromGlobal(QCursor::pos());
    session->change();
    beginDrag(active, {kind, -1}, true);
}

void BendTool::pressKey(QKeyEvent *event) {
    if (!layer() || !panel)
        return;
    event->accept();
    if (drag) {
        pressKeyWhileDragging(event);
        return;
    }
    const int key = event->key();
    const bool shift = event->modifiers() & Qt::ShiftModifier, control = event->modifiers() & Qt::ControlModifier;
    if (control && key == Qt::Key_Z) {
        onCommand(shift ? BendPanel::Redo : BendPanel::Undo);
        return;
    }
    switch (key) {
    case Qt::Key_G:
    case Qt::Key_R:
    case Qt::Key_S:
        if (!isReady())
            return;
        dragByKey(key == Qt::Key_G ? BendDrag::Move : key == Qt::Key_R ? BendDrag::Turn : BendDrag::Scale);
        break;
    case Qt::Key_M: setMode(BendPanel::Bend); break;
    case Qt::Key_B: setMode(BendPanel::Brush); break;
    case Qt::Key_V: setMode(BendPanel::Rectangle); break;
    case Qt::Key_L: setMode(BendPanel::Polyline); break;
    case Qt::Key_F: panel->setRole(BendPanel::Fixed, 2); break;
    case Qt::Key_U: panel->setRole(BendPanel::Free, 2); break;
    case Qt::Key_O: panel->setRole(BendPanel::Outside, 2); break;
    case Qt::Key_H:
        panel->setRole(BendPanel::Handle, shift || session->handleTags().empty() ? session->unusedTag() : 2);
        break;
    case Qt::Key_T: panel->toggleThrough(); break;
    case Qt::Key_Backspace: onCommand(BendPanel::Reset); break;
    case Qt::Key_Escape:
        if (marking) {
            marking.reset();
            session->cancel();
            showOverlay();
        }
        break;
    case Qt::Key_Return:
    case Qt::Key_Enter:
        if (marking && marking->kind == BendMarking::Polygon)
            endMarking();
        else if (control)
            onCommand(shift ? BendPanel::ApplyToNewLayer : BendPanel::ApplyInPlace);
        break;
    default: event->ignore();
    }
    refresh();
    view->update();
}
