// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/handles.h"

// The keys of the view.

using vcg::fcd::Error;

/// The action of a key now, or null.
const ActionTable::Row *BendTool::keyOf(const QKeyEvent &event) const {
    const ActionTable::Row *key = bendActions().of(event);
    const bool isOfLines = key && key->action == BendAction::RemovePoint;
    return isOfLines && !(panel && panel->mode() == BendPanel::Line) ? nullptr : key;
}

bool BendTool::takesEvent(QEvent &event) {
    if (!session)
        return false;
    if (view->suspendedEditor) {
        // A window manager may deliver a press after later keys: Esc was meant to cancel it.
        const bool isPress = event.type() == QEvent::MouseButtonPress;
        const unsigned long time = // 0: passed on by this tool
            isPress ? static_cast<QMouseEvent &>(event).timestamp() : 0;
        if (time == 0 || time > escaped)
            return false;
        escaped = 0;
        host::suspendEditing(*view);
        return true;
    }
    if (event.type() == QEvent::Enter)
        view->setFocus();                           // keys go to what is under the mouse
    if (event.type() == QEvent::ShortcutOverride) { // before the host's shortcuts
        const auto &pressed = static_cast<QKeyEvent &>(event);
        const ActionTable::Row *key = keyOf(pressed);
        // The host gets Esc if there is nothing to cancel. During a drag, the tool takes all keys.
        const bool isOurs = key && (key->action != BendAction::Cancel || (going && going->isCancelledByEsc()));
        if (preparing || isOurs || (going && going->takesAllKeys())) {
            event.accept();
            return true;
        }
        if (key)
            escaped = pressed.timestamp();
    }
    if (event.type() != QEvent::MouseButtonDblClick || !panel)
        return false;
    guarded([&] { doubleClick(static_cast<QMouseEvent *>(&event)); });
    return true;
}

/// Whether keys make a handle of what is under the mouse: not if a handle was chosen, or is marked.
bool BendTool::beginsByKey(const Place &place) const {
    const bool isOther =
        (isChosen && session->model().influence.isHandle(active)) || (session->state().marks && selected());
    return place.slot && isFree(session->state(), *place.slot) && !isOther;
}

/// What is under the mouse for a key. Unlike for a press, rings and arrows are ignored; the gizmo's ball is its handle.
BendTool::Place BendTool::placeOfKeys() const {
    const std::optional<GizmoPart> part = partAtMouse();
    return part && part->axis < 0 ? Place{selected(), {}, {}} : placeAtMouse();
}

/// Begins to move what is under the mouse, or else the selected handle, without a button.
void BendTool::dragByKey(BendDrag::Kind kind) {
    expectSeen();
    findMouse();
    const Place place = view->underMouse() ? placeOfKeys() : Place();
    const bool isBegin = beginsByKey(place);
    const int tag = place.tag ? place.tag : isBegin ? 0 : selected();
    if (!tag && !isBegin)
        throw Error("There is no handle yet: mark one, or drag a point of the surface.");
    beginDrag({tag, place.slot.value_or(place.held.value_or(0)), {kind, -1}, true, false, place.held.has_value()});
}

/// Sets the pivot of the selected handle to the place under the mouse.
void BendTool::placePivot() {
    const int tag = selected();
    if (!tag)
        throw Error("There is no handle whose pivot you could place: mark one, or drag a point of the surface.");
    findMouse();
    const int other = placeAtMouse().tag;
    const bool isOther = other != 0 && other != tag;
    const std::optional<Eigen::Vector3d> place = isOther ? centerOf(session->model(), other) : pick();
    session->change();
    setPivot(session->edit(), tag, place);
    hint = nameOf(tag) + (!place    ? QString(jointOf(session->model(), tag) ? ": turns about its joint again."
                                                                             : ": turns about its middle again.")
                          : isOther ? ": turns about the middle of " + nameOf(other) + "."
                                    : QString(": turns about this place; P beside the mesh takes that back."));
}

/// Changes what marks become; in a mode that does not mark, tells so.
void BendTool::setRole(BendPanel::Role which, int handle) {
    panel->setRole(which, handle);
    if (panel->isBending() || panel->mode() == BendPanel::Line)
        hint = QString("Marks now become %1. B, V or L mark, M pulls.").arg(roleText());
}

void BendTool::act(BendAction::Id action) {
    switch (action) {
    case BendAction::Drag:
    case BendAction::Pull:
    case BendAction::Brush:
    case BendAction::Rectangle:
    case BendAction::Polyline:
    case BendAction::Line: setMode(BendPanel::Mode(action - BendAction::Drag)); break;
    case BendAction::Move:
    case BendAction::Turn:
    case BendAction::Scale:
    case BendAction::Limb: dragByKey(BendDrag::Kind(action - BendAction::Move)); break;
    case BendAction::Pivot: placePivot(); break;
    case BendAction::RemovePoint: removeLinePoint(); break;
    case BendAction::Fixed: setRole(BendPanel::Fixed); break;
    case BendAction::Free: setRole(BendPanel::Free); break;
    case BendAction::Outside: setRole(BendPanel::Outside); break;
    case BendAction::Handle:
        setRole(BendPanel::Handle, selected() ? selected() : session->model().influence.unusedTag());
        break;
    case BendAction::NextHandle: setRole(BendPanel::Handle, session->model().influence.unusedTag()); break;
    case BendAction::Through: panel->toggleThrough(); break;
    case BendAction::Cancel:
        if (going && going->isCancelledByEsc())
            going->cancel();
        break;
    case BendAction::End:
        if (going)
            going->doubleClick();
        break;
    case BendAction::Page: panel->showKeys(); break;
    default: onCommand(action); // actions with a button
    }
}

void BendTool::pressKey(QKeyEvent *event) {
    if (!layer() || !panel)
        return;
    event->accept();
    hint.clear();
    isClicked = false;
    if (preparing) {
        if (event->key() == Qt::Key_Escape)
            preparing.cancel();
        return;
    }
    if (going && going->takesAllKeys() && going->pressKey(*event))
        return;
    const ActionTable::Row *key = keyOf(*event);
    if (!key)
        event->ignore();
    else if (isReady())
        act(BendAction::Id(key->action));
    refreshAll();
}
