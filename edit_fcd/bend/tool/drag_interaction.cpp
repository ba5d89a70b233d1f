// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/drag_interaction.h"

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/view/pointing.h"
#include "edit_fcd/view/trace.h"

#include <cmath>

void DragInteraction::begin(const Grip &what) {
    BendSession &session = *stage.session;
    session.change();
    if (session.model().options.pose != 100) { // a drag is at 100 %
        setPose(session.edit(), 100);
        stage.panel->setPose(100);
        stage.solve(true);
    }
    grip = what;
    grip.isNew = !what.tag;
    asked = what.tag;
    const bool isLimb = what.part.kind == BendDrag::Limb;
    if (const auto point = session.state().points.find(what.tag); point != session.state().points.end()) {
        if (!isLimb || !what.isHeld)
            grip.slot = point->second.slot;
    } else if (isLimb && what.tag) {
        throw vcg::fcd::Error("A marked handle is no point of a limb: R turns it.");
    }
    held = session.positionOf(grip.slot);
    gripped = grip.from.value_or(stage.mouseInWindow());
    isReleased = false;
    const double radius = stage.panel->radius() * session.diagonal();
    stage.beside(
        "Preparing the layer",
        [this, radius, isLimb](const vcg::fcd::Progress &progress) {
            if (isLimb || grip.stroke) {
                const BendInfluence before = stage.session->model().influence;
                grip.tag = isLimb ? stage.session->limbAt(grip.slot, radius, grip.nearer)
                                  : stage.session->strokeAt(*grip.stroke, radius);
                grip.isNew = !before.isHandle(grip.tag);
            }
            if (isLimb && !grip.tag) {
                if (grip.modal)
                    throw vcg::fcd::Error("There is no limb here to turn: G pulls this place, and R turns it.");
                grip.tag = asked; // no limb: pull instead
                grip.isNew = !asked;
                grip.part.kind = BendDrag::Move;
            }
            if (!grip.tag)
                grip.tag = stage.session->addPoint(grip.slot, radius);
            if (grip.part.kind != BendDrag::Move)
                stage.session->makeGrip(grip.tag);
            tookToPrepare = stage.session->prepare(progress);
        },
        [this] { beginPrepared(); },
        [this] { // cancelled: the shape before
            stage.session->cancel();
            stage.showOverlay();
            stage.ended();
        });
}

void DragInteraction::beginPrepared() {
    const BendSession &session = *stage.session;
    const BendModel &model = session.model();
    const int tag = grip.tag;
    stage.isChosen = stage.isChosen && tag == stage.active;
    stage.active = tag;
    stage.display->move();
    BendDrag begun;
    begun.tag = tag;
    begun.kind = grip.part.kind;
    begun.axis = grip.part.axis;
    begun.modal = grip.modal;
    begun.held = held;
    begun.axes = stage.axesOf(tag);
    begun.from = begun.last = gripped;
    begun.begin = motionOf(model.state, tag);
    for (const int other : carriedBy(model, tag))
        begun.carried[other] = motionOf(model.state, other);
    first = begun.kind == BendDrag::Limb && grip.nearer == 0 ? jointBefore(model, tag, held) : 0;
    if (first) {
        begun.before.emplace();
        begun.before->carried[first] = motionOf(model.state, first);
        for (const int other : carriedBy(model, first))
            if (other != tag && begun.carried.count(other) == 0)
                begun.before->carried[other] = motionOf(model.state, other);
    }
    now = std::make_unique<BendDrag>(std::move(begun));
    placePivot();
    stage.frame = 0;
    sinceDraw.invalidate();
    try {
        if (tookToPrepare > 0 && isMoved(model))
            stage.solve(false);
        trace("press: %d vertices, prepare %.1f ms, since the event %.1f ms", stage.model->cm.vn, tookToPrepare,
              stage.millisecondsSinceEvent());
    } catch (...) {
        end(false);
        throw;
    }
    showInfluence();
    if (!stage.colors->isStretch(session))
        stage.moving = MovingPart::of(*stage.view, *stage.model, session.tags(), stage.colors->of(session));
    now->moveTo(stage.seen, stage.mouseInWindow());
    if (isReleased && !grip.modal)
        end(true);
    else if (stage.model->cm.vn > preparedAtOnce)
        stage.requestStep();
}

/// The handles whose surroundings bend; 0: none.
std::vector<int> DragInteraction::turning() const {
    const BendModel &model = stage.session->model();
    return {now->tag, mirrored(model, now->tag), first, first ? mirrored(model, first) : 0};
}

/// Shows what turns, and how much the surface bends. (For a pull, draw() shows it.)
void DragInteraction::showInfluence() {
    const BendModel &model = stage.session->model();
    const int tag = first ? first : now->tag; // all that moves is of its extent
    MarkColors::Extents extents;
    for (const int each : {tag, mirrored(model, tag)})
        if (isGrip(model.state, each))
            extents.push_back(valueOr(model.influence.extents, each)); // null ones are ignored
    stage.colors->preview(std::move(extents));
    stage.showOverlay();
}

/// Sets the point of the drag: it turns and scales about the pivot, and moves by the dot, or by a pivot of the user's.
void DragInteraction::placePivot() {
    const BendModel &model = stage.session->model();
    const bool isGiven = handleOf(model.state, now->tag).pivot.has_value(), isPoint = isGrip(model.state, now->tag);
    const auto asItBegan = [&](int tag, const BendDrag::Steps &begin, const Eigen::Vector3d &place) {
        return Eigen::Vector3d(motionBy(model, tag, begin) * motionAt(model, tag).inverse() * place);
    };
    now->pivot = asItBegan(now->tag, now->begin,
                           now->kind == BendDrag::Move && !isGiven ? dotOf(model, now->tag) : pivotOf(model, now->tag));
    now->isAbout = isGiven || isPoint;
    if (now->before)
        now->before->pivot = asItBegan(first, now->before->carried.at(first), pivotOf(model, first));
}

/// Changes between move, turn and scale. A point that turns becomes a grip, so the layer is prepared anew.
void DragInteraction::changeKind(BendDrag::Kind kind) {
    const BendState &state = stage.session->state();
    const bool isOther = kind == BendDrag::Limb || now->kind == BendDrag::Limb; // maybe of another handle
    if (!isOther && (kind == BendDrag::Move || state.points.count(now->tag) == 0 || isGrip(state, now->tag))) {
        now->kind = kind;
        placePivot();
        return;
    }
    Grip again = grip;
    again.part = {kind, now->axis};
    restart(again);
}

/// Takes the drag back, and begins another one.
void DragInteraction::restart(Grip &again) {
    again.tag = asked;
    stop(false);
    stage.comeToRest();
    begin(again);
}

/// The limb turns at a joint that is nearer to the mouse, by steps down, or farther from it. What was dragged follows.
void DragInteraction::changeJoint(double steps) {
    const int before = grip.nearer;
    if (steps > 0 && before == BendReach::wholeLimb)
        return;
    const Eigen::Vector3d place = now->pivot;
    Grip again = grip;
    again.nearer = steps > 0 ? before - 1 : before + 1;
    again.from = gripped;
    restart(again);
    if (now && now->pivot == place)
        grip.nearer = before; // there is none
}

void DragInteraction::stop(bool keep) {
    const auto motions = now->motions(stage.seen);
    const bool isClick = keep && now->steps(stage.seen).empty();
    stage.isClicked = isClick && grip.isNew;
    stage.isChosen = isClick || (stage.isChosen && now->modal);
    if (!keep)
        stage.session->cancel();
    else if (stage.layer())
        setMotion(stage.session->edit(), motions); // a full solve follows
    now.reset();
    if (stage.moving)
        stage.overlay->move();
    stage.moving.reset();
    if (stage.colors->preview({}) && stage.layer())
        stage.showOverlay();
    stage.isStepWanted = false;
    stage.sinceEvent.start();
}

void DragInteraction::end(bool keep) {
    stop(keep);
    stage.ended();
    if (stage.layer())
        stage.comeToRest();
}

void DragInteraction::cancel() {
    if (now && stage.layer()) {
        end(false);
        return;
    }
    if (stroke && stage.colors->preview({}) && stage.layer())
        stage.showOverlay();
    stage.ended();
}

void DragInteraction::move(QMouseEvent &event) {
    if (!now && !stroke)
        return;
    if (!(now && now->modal) && !(event.buttons() & Qt::LeftButton)) { // it was released over a dialog of
        release();                                                     // the host
        return;
    }
    if (stroke) {
        stage.requestStep();
        return;
    }
    const Eigen::Vector3d window = stage.mouseInWindow();
    now->snap = event.modifiers() & Qt::ControlModifier;
    now->onto.reset();
    if (event.modifiers() & Qt::ShiftModifier)
        now->onto = hitOthers(*stage.view->md(), *stage.model, stage.seen, window.head<2>());
    now->moveTo(stage.seen, window);
    stage.requestStep();
}

void DragInteraction::release() {
    if (stroke)
        endStroke();
    else if (!now)
        isReleased = true;
    else if (!now->modal)
        end(true);
}

bool DragInteraction::press(QMouseEvent &event) {
    if (stroke) {
        if (event.button() == Qt::RightButton)
            cancel();
        return true;
    }
    if (!now)
        return false; // a press is not for this drag
    if (beginStroke(event))
        return true;
    end(event.button() == Qt::LeftButton);
    return true;
}

bool DragInteraction::pressKey(QKeyEvent &event) {
    if (stroke) {
        if (event.key() == Qt::Key_Escape)
            cancel();
        return true;
    }
    const QString typed = event.text();
    switch (const int key = event.key()) {
    case Qt::Key_Escape:
    case Qt::Key_Return:
    case Qt::Key_Enter:
        if (key == Qt::Key_Escape || !now->isRefused()) // the panel tells what is wrong
            end(key != Qt::Key_Escape);
        return true;
    case Qt::Key_X:
    case Qt::Key_Y:
    case Qt::Key_Z: now->axis = now->axis == key - Qt::Key_X ? -1 : key - Qt::Key_X; break;
    case Qt::Key_G: changeKind(BendDrag::Move); break;
    case Qt::Key_R: changeKind(BendDrag::Turn); break;
    case Qt::Key_S: changeKind(BendDrag::Scale); break;
    case Qt::Key_J: changeKind(BendDrag::Limb); break;
    case Qt::Key_Backspace:
        if (!now->typed.empty())
            now->typed.pop_back();
        break;
    default:
        if (typed.size() == 1 && typed[0].isPrint() && !typed[0].isSpace())
            now->typed += QString(typed).replace(',', '.').toStdString();
    }
    stage.requestStep();
    return true;
}

bool DragInteraction::turnWheel(double steps) {
    if (!now)
        return stroke.has_value();
    if (now->kind == BendDrag::Limb) {
        changeJoint(steps);
        if (now)
            stage.requestStep(); // begun again: the limb follows before the mouse moves on
        return true;
    }
    BendSession &session = *stage.session;
    session.setRadius(now->tag, radiusOf(session.model(), now->tag) * std::pow(1.1, steps));
    isRadiusShown = true;
    placePivot();
    now->moveTo(stage.seen, now->last);
    showInfluence();
    if (stage.moving)
        stage.moving = MovingPart::of(*stage.view, *stage.model, session.tags(), stage.colors->of(session));
    stage.requestStep();
    return true;
}

void DragInteraction::step() {
    if (!stage.layer())
        return;
    if (stroke)
        showStroke(*stroke);
    if (!now)
        return;
    setMotion(stage.session->edit(), now->motions(stage.seen));
    stage.solve(false);
    stage.refresh();
}

void DragInteraction::beforeDraw() {
    if (!now)
        return;
    const double past = sinceDraw.isValid() ? double(sinceDraw.nsecsElapsed()) / 1e6 : 0;
    stage.frame = stage.frame > 0 ? 0.8 * stage.frame + 0.2 * past : past; // mean of about five
    sinceDraw.start();
}

QString DragInteraction::text() const {
    if (stroke)
        return turned.extent ? "Drag along the limb: the tinted part turns where you began. Release: turn it; Esc."
                             : "Drag from the joint along the limb, towards its end. Esc.";
    if (!now)
        return {};
    const BendSession &session = *stage.session;
    const QString what = stage.nameOf(now->tag) + ": " + QString::fromStdString(now->text(stage.seen));
    return isRadiusShown ? QString("%1; radius %2 %")
                               .arg(what)
                               .arg(100 * radiusOf(session.model(), now->tag) / session.diagonal(), 0, 'f', 1)
                         : what;
}
