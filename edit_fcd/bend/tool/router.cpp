// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/tool/interactions.h"
#include "edit_fcd/view/trace.h"

#include <cmath>
#include <tuple>

// Events of the mouse: for the interaction that goes on, for one that they begin, or for the camera.

/// Passes an event to the camera.
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
            preparing.cancel();
        return;
    }
    if (going && going->press(*event))
        return;
    if (!isPlain(*event) || !isReady()) {
        forgetForeseen();
        toCamera(event);
        return;
    }
    if (!begin())
        toCamera(event);
    refreshAll();
    if (panel->mode() == BendPanel::Line)
        trace("click: %d vertices, %d points, since the event %.1f ms", model->cm.vn, int(session->state().line.size()),
              millisecondsSinceEvent());
}

/// Begins what a press in this mode begins. \return false if that is nothing
bool BendTool::begin() {
    expectSeen();
    switch (panel->mode()) {
    case BendPanel::Drag:
    case BendPanel::Pull: return grab();
    case BendPanel::Line:
        if (goOn<LineInteraction>().begin())
            return true;
        going.reset();
        return false;
    case BendPanel::Brush:
        if (!pick())
            return false;
        goOn<MarkInteraction>(MarkInteraction::Brush).begin();
        return true;
    case BendPanel::Rectangle: goOn<MarkInteraction>(MarkInteraction::Rectangle).begin(); return true;
    case BendPanel::Polyline: goOn<MarkInteraction>(MarkInteraction::Polygon).begin(); return true;
    }
    return false;
}

/// In a mode that marks, a double click counts as two clicks. Otherwise the host makes the place under the mouse the
/// centre of the view's turns, and a handle of the first click is removed.
void BendTool::doubleClick(QMouseEvent *event) {
    if (!panel->isBending() && event->button() == Qt::LeftButton) {
        if (!going || !going->doubleClick())
            press(event);
        return;
    }
    if (drag())
        return;
    if (preparing) {
        preparing.cancel();
    } else if (isClicked && layer()) {
        session->cancel();
        showOverlay();
        solve(true);
        refresh();
    }
    isClicked = false;
    toHost(*view, event);
}

/// Whether a move or a release is for the layer, and not for the camera.
bool BendTool::isForLayer(QMouseEvent *event) {
    mouse = event->localPos();
    const bool isForCamera = isCamera; // before a release resets it
    if (isForCamera)
        toCamera(event);
    return !isForCamera && layer();
}

void BendTool::move(QMouseEvent *event) {
    sinceEvent.start();
    if (!isForLayer(event) || preparing)
        return;
    if (going)
        going->move(*event);
    else if (panel && panel->mode() == BendPanel::Brush)
        view->update();
    else if (panel && panel->isBending() && event->buttons() == Qt::NoButton)
        hover();
}

void BendTool::release(QMouseEvent *event) {
    if (isForLayer(event) && going)
        going->release();
}

void BendTool::turnWheel(QWheelEvent *event) {
    const double steps = event->angleDelta().y() / 120.0;
    if (going && session && going->turnWheel(steps))
        return;
    if (panel && panel->isBending() && event->modifiers() == Qt::ControlModifier && isReady() &&
        changeRim(std::pow(1.1, steps))) {
        view->update();
    } else if (panel && panel->mode() == BendPanel::Brush && event->modifiers() == Qt::NoModifier) {
        panel->setBrush(brushAfter(panel->brush(), steps));
        view->update();
    } else {
        toHost(*view, event);
    }
}

/// Multiplies the radius of the mark or point under the mouse. \return whether there is one
bool BendTool::changeRim(double times) {
    findMouse();
    const Place place = placeAtMouse();
    const int tag = place.tag;
    const std::optional<std::size_t> &found = place.slot;
    const auto &marks = session->state().marks;
    if (!tag && !(found && marks && (*marks)[*found] == 0))
        return false;
    const std::size_t slot = found.value_or(0); // fixed, if there is no handle
    // Turns of the wheel within a second are one step of undo.
    if (!sinceRim.isValid() || sinceRim.hasExpired(1000))
        session->change();
    sinceRim.start();
    double rim = times * (tag ? radiusOf(session->model(), tag) : rimAt(session->state(), slot, session->diagonal()));
    if (tag) {
        session->setRadius(tag, rim);
        rim = radiusOf(session->model(), tag);
    } else {
        session->setRimAt(slot, rim);
        rim = rimAt(session->state(), slot, session->diagonal());
    }
    const double percent = 100 * rim / session->diagonal();
    const bool isPoint = session->state().points.count(tag) > 0; // its radius is how far it bends, not a rim
    hint = QString(isPoint ? "%1: bends the surface within %2 % of the diagonal."
                           : "%1: its free rim is %2 % of the diagonal wide.")
               .arg(tag ? nameOf(tag) : QString("The fixed part here"))
               .arg(isPoint ? percent : gapOfRadius * percent, 0, 'f', 1);
    showOverlay();
    solve(true);
    refresh();
    return true;
}

/// Highlights what a press would take, which may be a ring over another handle.
void BendTool::hover() {
    const std::optional<GizmoPart> part = partAtMouse();
    const Place place = placeOfKeys();
    const int tag = part ? 0 : place.tag;
    const bool isBegin = beginsByKey(place);
    foreseen = part ? Place{selected(), {}, {}} : place;
    if (!isForeseeing)
        later([this] { foresee(); }); // once for several moves of the mouse
    isForeseeing = true;
    if (tag == hovered && part == lit && isBegin == keysBegin && place.tag == keysTag)
        return;
    hovered = tag;
    lit = part;
    keysBegin = isBegin;
    keysTag = place.tag;
    panel->showState(stateText());
    view->update();
}

/// Previews how much a press would move, and about which pivot.
void BendTool::foresee() {
    isForeseeing = isReading = false;
    if (!layer() || going || preparing || !panel->isBending() || isSuspended || isHidden())
        return;
    isReading = !session->readAhead() && (foreseen.tag || foreseen.slot) && isForLimb(foreseen);
    if (isReading) {
        isForeseeing = true;
        later([this] { foresee(); }, 50);
        panel->showState(stateText());
        return;
    }
    int tag = foreseen.tag;
    const std::optional<std::size_t> slot = foreseen.slot;
    const BendModel &model = session->model();
    const bool isThere = slot && *slot < session->tags().size() && canBecomePoint(model, *slot);
    const vcg::fcd::Stopwatch watch;
    std::shared_ptr<const BendExtent> found;
    const double worldRadius = panel->radius() * session->diagonal();
    if (isForLimb(foreseen))
        std::tie(tag, found) = session->glimpseLimb(tag, slot, worldRadius);
    isLimbForeseen = found != nullptr;
    foreseenPivots.clear();
    if (isLimbForeseen && tag) {
        const std::optional<std::size_t> held = slot ? slot : foreseen.held;
        if (const int first = jointBefore(model, tag, held ? session->positionOf(*held) : dotOf(model, foreseen.tag))) {
            foreseenPivots.push_back(pivotOf(model, tag)); // the limb bends there, and turns at the first joint
            tag = first;
            found = session->glimpseOf(first);
        }
    }
    if (!found && (model.influence.isLocal || !session->state().marks)) { // else all free vertices move
        tag = foreseen.tag;
        found = tag ? session->glimpseOf(tag) : isThere ? session->glimpse(*slot, worldRadius) : nullptr;
    }
    if (found) {
        const std::size_t at = found->vertices.front();
        const Eigen::Vector3d rest = model.ground.world * model.ground.at(at),
                              pivot = found->joint ? Eigen::Vector3d(model.ground.world * *found->joint) : rest;
        foreseenPivots.push_back(tag ? pivotOf(model, tag) : session->seenAt(pivot, at));
    }
    panel->showState(stateText());
    if (!colors->preview({found, found ? session->glimpseTwin(tag, *found) : nullptr}))
        return;
    showOverlay();
    if (found)
        trace("foreseen: %d vertices, %d move, %.1f ms", this->model->cm.vn,
              int(found->beyond.size() + found->around.size()), 1000 * watch.Seconds());
}

/// Removes the preview.
void BendTool::forgetForeseen() {
    foreseenPivots.clear();
    isLimbForeseen = false;
    if (colors && colors->preview({}) && layer())
        showOverlay();
}

/// Begins to drag what is under the mouse. \return false if there is nothing to drag
bool BendTool::grab() {
    if (std::optional<GizmoPart> part = partAtMouse()) {
        if (part->axis < 0 && isForLimb({selected(), {}, {}}))
            part->kind = BendDrag::Limb;
        beginDrag({selected(), 0, *part, false, false, false});
        return true;
    }
    const Place place = placeAtMouse();
    if (!place.tag && !place.slot)
        return false;
    if (place.slot && !isFree(session->state(), *place.slot)) {
        hint = "This part is fixed: the camera moves. Mark it as free first (U), or clear the marks.";
        return false;
    }
    const GizmoPart part{isForLimb(place) ? BendDrag::Limb : BendDrag::Move, -1};
    beginDrag({place.tag, place.slot.value_or(place.held.value_or(0)), part, false, false, place.held.has_value()});
    return true;
}

void BendTool::beginDrag(const DragInteraction::Grip &grip) {
    if (grip.tag && handleOf(session->state(), grip.tag).isLocked)
        throw vcg::fcd::Error(nameOf(grip.tag).toStdString() + " is locked: the list of handles unlocks it.");
    foreseenPivots.clear();
    isLimbForeseen = false;
    colors->preview({}); // the drag has its own preview
    DragInteraction &begun = goOn<DragInteraction>();
    try {
        begun.begin(grip);
    } catch (...) {
        if (going.get() == &begun)
            ended();
        throw;
    }
}
