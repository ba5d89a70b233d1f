// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/handles.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

// The drag of a handle: what is gripped, how the layer is prepared for it, and its steps.

/// The handle that keys move where none is under the mouse; 0 where there is none.
int BendTool::selected() const {
    if (session->model().influence.isHandle(active))
        return active;
    const std::vector<int> handles = session->model().influence.handles();
    return handles.empty() ? 0 : handles.front();
}

Eigen::Matrix3d BendTool::axesOf(int tag) const {
    if (session->edit().options.axes != BendAxes::View)
        return ::axesOf(session->model(), tag);
    const Eigen::Vector3d at = pivotOf(session->model(), tag), window = seen.toWindow(at);
    Eigen::Matrix3d axes;
    axes.col(0) = (seen.toWorld({window[0] + 1, window[1], window[2]}) - at).normalized();
    axes.col(2) = seen.towardsEye(at);
    axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
    return axes;
}

/// That of the selected handle.
std::optional<Gizmo> BendTool::gizmo() const {
    const int tag = drag ? drag->tag : selected();
    if (!tag || handleOf(session->state(), tag).isHidden || handleOf(session->state(), tag).isLocked)
        return {};
    return Gizmo{pivotOf(session->model(), tag), drag ? drag->axes : axesOf(tag)};
}

/// Begins a change that drags something: at once, or, with a large layer, when it is prepared, which goes on beside the
/// window.
void BendTool::beginDrag(const Grip &what) {
    if (what.tag && handleOf(session->state(), what.tag).isLocked)
        throw vcg::fcd::Error(nameOf(session->state(), what.tag) + " is locked: the list of handles unlocks it.");
    session->change();
    if (session->edit().options.pose != 100) { // a drag says where that is
        setPose(session->edit(), 100);
        panel->setPose(100);
        solve(true);
    }
    grip = what;
    grip.isNew = !what.tag;
    gripped = mouseInWindow();
    isReleased = false;
    const double radius = panel->radius() * session->diagonal();
    const auto prepare = [this, radius](const vcg::fcd::Progress &progress) {
        if (!grip.tag)
            grip.tag = session->addPoint(grip.slot, radius);
        if (grip.part.kind != BendDrag::Move)
            session->makeGrip(grip.tag);
        tookToPrepare = session->prepare(progress);
    };
    beside(
        "Preparing the layer", prepare, [this] { dragWhenPrepared(); },
        [this] { // the layer has the shape of before
            session->cancel();
            showOverlay();
        });
}

void BendTool::dragWhenPrepared() {
    const int tag = grip.tag;
    isChosen = isChosen && tag == active;
    active = tag;
    drag = std::make_unique<BendDrag>();
    drag->tag = tag;
    display->move();
    drag->kind = grip.part.kind;
    drag->axis = grip.part.axis;
    drag->modal = grip.modal;
    drag->pivot = pivotOf(session->model(), tag);
    drag->isAbout = handleOf(session->state(), tag).pivot.has_value();
    drag->axes = axesOf(tag);
    drag->from = drag->last = gripped;
    frame = 0;
    sinceDraw.invalidate();
    drag->begin = motionOf(session->state(), tag);
    for (const int other : carriedBy(session->model(), tag))
        drag->carried[other] = motionOf(session->state(), other);
    try {
        if (tookToPrepare > 0 && moves(session->model()))
            solve(false);
        if (std::getenv("FCD_TRACE"))
            std::fprintf(stderr, "FCD trace: press: %d vertices, prepare %.1f ms, since the event %.1f ms\n",
                         model->cm.vn, tookToPrepare, double(sinceEvent.nsecsElapsed()) / 1e6);
    } catch (...) {
        endDrag(false);
        throw;
    }
    showOverlay(); // a grip is seen
    if (!colors->isStretch(*session))
        moving = MovingPart::of(*view, *model, session->tags(), colors->of(*session));
    drag->moveTo(seen, mouseInWindow());
    if (isReleased && !grip.modal)
        endDrag(true);
    else if (model->cm.vn > preparedAtOnce)
        requestStep();
}

/// What is dragged is moved, turned or scaled from now on. A point that is turned holds more, for which the layer is
/// prepared anew.
void BendTool::changeKind(BendDrag::Kind kind) {
    const auto point = session->state().points.find(drag->tag);
    if (kind == BendDrag::Move || point == session->state().points.end() || point->second.isGrip) {
        drag->kind = kind;
        return;
    }
    Grip again = grip;
    again.tag = grip.isNew ? 0 : grip.tag;
    again.part = {kind, drag->axis};
    endDrag(false);
    beginDrag(again);
}

void BendTool::endDrag(bool keep) {
    if (!drag)
        return;
    const auto motions = drag->motions(seen);
    const bool isClick = keep && !drag->step(seen);
    isClicked = isClick && grip.isNew;
    isChosen = isClick || (isChosen && drag->modal);
    if (!keep)
        session->cancel();
    else if (layer())
        setMotion(session->edit(), motions); // solved below, to the end
    drag.reset();
    if (moving)
        overlay->move();
    moving.reset();
    isStepWanted = false;
    sinceEvent.start();
    if (layer())
        comeToRest();
}

/// What has moved step by step is solved to the end. \pre there is a layer
void BendTool::comeToRest() {
    display->rest();
    solve(true);
    refresh();
    view->update();
}

/// One step a painted frame: the mouse moves more often.
void BendTool::requestStep() {
    isStepWanted = true;
    if (isPainted)
        step();
}

void BendTool::step() {
    isStepWanted = false;
    if (!drag || !layer())
        return;
    setMotion(session->edit(), drag->motions(seen));
    solve(false);
    refresh();
}

void BendTool::solve(bool full) {
    QElapsedTimer watch;
    watch.start();
    BendSession::Times times;
    try {
        times = session->pose(full, display->showsFaces());
    } catch (...) {
        session->restore();
        isLive = false;
        showVertices(true);
        throw;
    }
    isLive = !full;
    if (full && moves(session->model()))
        showChanged();
    const double solved = double(watch.nsecsElapsed()) / 1e6;
    showVertices(full);
    const double took = double(watch.nsecsElapsed()) / 1e6;
    if (!full)
        milliseconds = took; // of a step
    if (std::getenv("FCD_TRACE"))
        std::fprintf(
            stderr,
            "FCD trace: %s: %d vertices, %d nodes, prepare %.1f, solve %.1f, write %.1f, buffers %.1f, in all %.1f, "
            "since the event %.1f ms\n",
            full ? "full" : "drag", model->cm.vn, session->nodes(), times.prepare, times.solve, times.write,
            took - solved, took, sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0.0);
}
