// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/stage.h"

#include "edit_fcd/bend/model/handles.h"

#include <QCursor>

// What the mouse points at.

std::optional<Eigen::Vector3d> BendStage::pick() const {
    Eigen::Vector3d window = mouseInWindow();
    float depth = 1;
    view->makeCurrent();
    glReadPixels(int(window[0]), int(window[1]), 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    if (!(depth < 1))
        return {};
    window[2] = depth;
    return seen.toWorld(window);
}

void BendStage::findMouse() { mouse = view->mapFromGlobal(QCursor::pos()); }

/// The point handle at a place of the window, 0: none. \param least largest distance, pixels
int BendStage::pointAt(const Eigen::Vector2d &window, double least) const {
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

std::optional<std::size_t> BendStage::slotAtMouse() const {
    const std::optional<Eigen::Vector3d> place = pick();
    double distance = 0;
    const std::optional<std::size_t> slot = place ? session->nearest(*place, distance) : std::nullopt;
    return slot && distance <= 0.02 * session->diagonal() ? slot : std::nullopt;
}

BendStage::Place BendStage::placeAtMouse() const {
    if (const int point = pointAt(mouseInWindow().head<2>()))
        return {point, {}, {}};
    const std::optional<std::size_t> slot = slotAtMouse();
    if (!slot)
        return {};
    const int tag = session->tags()[*slot];
    return tag >= 2 && !isAlong(session->model(), *slot) ? Place{tag, {}, slot} : Place{0, slot, {}};
}

bool BendStage::isForLimb(const Place &place) const {
    const BendModel &model = session->model();
    const bool isLocal = model.influence.isLocal || !session->state().marks; // else the fixed vertices bound what bends
    return panel->mode() == BendPanel::Drag && isLocal && (!place.tag || turnsLimb(model, place.tag));
}

std::optional<GizmoPart> BendStage::partAtMouse() const {
    const std::optional<Gizmo> shown = gizmo();
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    const int point = shown ? pointAt(window, dotPixels / 2 + 1) : 0;
    return shown && (!point || point == selected()) ? gizmoAt(seen, *shown, window) : std::nullopt;
}

int BendStage::selected() const {
    if (session->model().influence.isHandle(active))
        return active;
    const std::vector<int> handles = session->model().influence.handles();
    return handles.empty() ? 0 : handles.front();
}

Eigen::Matrix3d BendStage::axesOf(int tag) const {
    if (session->edit().options.axes != BendAxes::View)
        return ::axesOf(session->model(), tag);
    const Eigen::Vector3d at = pivotOf(session->model(), tag), window = seen.toWindow(at);
    Eigen::Matrix3d axes;
    axes.col(0) = (seen.toWorld({window[0] + 1, window[1], window[2]}) - at).normalized();
    axes.col(2) = seen.towardsEye(at);
    axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
    return axes;
}

std::optional<Gizmo> BendStage::gizmo() const {
    const BendDrag *dragged = drag();
    const int tag = dragged ? dragged->tag : selected();
    if (!tag || handleOf(session->state(), tag).isHidden || handleOf(session->state(), tag).isLocked)
        return {};
    return Gizmo{pivotOf(session->model(), tag), dragged ? dragged->axes : axesOf(tag)};
}
