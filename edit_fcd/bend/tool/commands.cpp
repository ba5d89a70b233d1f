// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/handles.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/tagging.h>

#include <algorithm>

using vcg::fcd::Error;
using vcg::fcd::MotionStep;

void BendTool::makePanel() {
    if (panel)
        return;
    panel = new BendPanel(view->window());
    when(panel.data(), &BendPanel::optionsChanged, [this] { onOptions(); });
    when(panel.data(), &BendPanel::poseBegins, [this] {
        if (session && !drag && !preparing)
            session->change();
    });
    for (const auto signal : {&BendPanel::modeChosen, &BendPanel::left})
        when(panel.data(), signal, [this] { view->setFocus(); });
    when(panel.data(), &BendPanel::roleChanged, [this] {
        hint.clear();
        refresh();
    });
    connectHandles();
    connectPoses();
    when(&panel->line(), &BendLineBox::command, [this](int which) { onLineCommand(which); });
    when(&panel->line(), &BendLineBox::changed, [this] {
        hint.clear();
        refresh();
        view->update();
    });
    when(panel.data(), &BendPanel::command, [this](int which) { onCommand(which); });
    panel->allowStretch(model->cm.fn > 0);
    if (usualSizes) {
        panel->setBrush(usualSizes->first);
        panel->setRadius(usualSizes->second);
    }
    showOptions();
    dockPanel(*view, *panel);
    if (session->state().marks)
        panel->setRole(BendPanel::Handle, session->model().influence.unusedTag());
}

void BendTool::takeOptions() {
    BendOptions &options = session->edit().options;
    options.smoothness = panel->smoothness();
    options.initialPatches = panel->patches();
    options.weights = panel->weights();
    options.mirror = panel->mirror();
    options.axes = BendAxes(panel->axes());
    setPose(session->edit(), panel->pose());
}

/// The panel shows the options of the session, which has gone back to others.
void BendTool::showOptions() {
    const BendOptions &options = session->edit().options;
    panel->setShape(options.smoothness, options.initialPatches, options.weights, options.mirror, int(options.axes),
                    int(options.pose));
    panel->setStretch(options.stretch);
}

void BendTool::onOptions() {
    if (!isReady() || drag)
        return;
    if (panel->mode() != BendPanel::Polyline)
        marking.reset();
    const BendOptions before = session->edit().options;
    takeOptions();
    showStretch();
    if (!session->edit().options.givesSameShape(before))
        solve(true);
    refresh();
    view->update();
}

void BendTool::setMode(BendPanel::Mode mode) {
    panel->setMode(mode);
    showStretch();
}

void BendTool::beginApply() {
    if (!moves(session->model()))
        throw Error("Nothing was moved, so there is nothing to apply.");
    session->change();
    panel->setStretch(false);
    showStretch();
}

void BendTool::onCommand(int which) {
    if (!isReady() || drag)
        return;
    const Remark remark = [this](const std::string &line) { say(line); };
    switch (which) {
    case BendPanel::MarkSelection: {
        std::vector<char> chosen = onSelectedFaces(*model);
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < chosen.size(); ++i)
            if (!model->cm.vert[i].IsD() && (chosen[i] || model->cm.vert[i].IsS()))
                all.push_back(i);
        if (all.empty())
            throw Error("Nothing is selected.");
        session->change();
        takeNewHandle();
        session->mark(all, panel->tag());
        session->endMarks(panel->radius() * session->diagonal());
        if (panel->tag() >= 2)
            active = panel->tag();
        showOverlay();
        solve(true);
        break;
    }
    case BendPanel::ClearMarks:
        session->change();
        session->clearMarks();
        showOverlay();
        solve(true);
        break;
    case BendPanel::TakeMotions:
        session->change();
        setMotions(session->edit(), panel->motions().toStdString());
        solve(true);
        view->setFocus();
        break;
    case BendPanel::Undo:
    case BendPanel::Redo:
        if (which == BendPanel::Undo)
            session->undo();
        else
            session->redo();
        showOptions();
        showOverlay();
        solve(true);
        break;
    case BendPanel::Reset:
        session->change();
        session->reset();
        solve(true);
        break;
    case BendPanel::ApplyInPlace:
        beginApply();
        try {
            say(session->applyInPlace(remark));
        } catch (...) {
            showVertices(true);
            throw;
        }
        active = 0;
        showVertices(true);
        showChanged();
        showOverlay();
        break;
    case BendPanel::ApplyToNewLayer:
        beginApply();
        applyToNewLayer([&] { say(session->applyToNewLayer(panel->graphLayers(), remark)); }, true);
        return;
    }
    refresh();
    view->update();
}

// --- the list of handles ---

void BendTool::connectHandles() {
    const BendHandleList *list = &panel->handles();
    when(list, &BendHandleList::selected, [this](int tag) {
        active = tag;
        isChosen = true;
        later([this] { refresh(); }); // not in the midst of the list's own events
        view->update();
    });
    when(list, &BendHandleList::removed, [this](int tag) {
        later([this] { refresh(); });
        if (!isReady() || drag)
            return;
        session->change();
        session->removeHandle(tag);
        showOverlay();
        solve(true);
    });
    when(list, &BendHandleList::edited, [this](const BendHandleRow &to) {
        later([this] {
            if (view)
                view->setFocus();
            refresh();
        });
        editHandle(to);
    });
}

void BendTool::editHandle(const BendHandleRow &to) {
    if (!isReady() || drag)
        return;
    hint.clear();
    session->change();
    BendHandle handle = handleOf(session->state(), to.tag);
    if (to.name.toStdString() != nameOf(session->state(), to.tag))
        handle.name = to.name.toStdString();
    handle.isHidden = !to.isShown;
    handle.isLocked = to.isLocked;
    setHandle(session->edit().state, to.tag, handle);
    if (to.motion.toStdString() != motionTextOf(session->state(), to.tag)) {
        setMotionText(session->edit(), to.tag, to.motion.toStdString());
        solve(true);
    }
    showOverlay();
}

namespace {

/// The motion of a handle, as far as the list has room.
QString shortTextOf(const BendSession &session, int tag) {
    QStringList words;
    for (const MotionStep &step : motionOf(session.state(), tag))
        switch (step.kind) {
        case MotionStep::Translation: words += QString("move %1").arg(step.vector.norm(), 0, 'g', 3); break;
        case MotionStep::Rotation: words += QString("turn %1").arg(step.degrees, 0, 'g', 3) + QChar(0xb0); break;
        case MotionStep::Scaling: words += QString("scale %1").arg(step.vector.maxCoeff(), 0, 'g', 3); break;
        case MotionStep::Matrix: words += "matrix"; break;
        }
    return words.join(", ");
}

} // namespace

void BendTool::showHandles() {
    std::vector<BendHandleRow> rows;
    for (const int tag : session->model().influence.handles()) {
        const vcg::Color4b color = colorOfTag(tag);
        BendHandleRow row;
        row.tag = tag;
        row.name = QString::fromStdString(nameOf(session->state(), tag));
        row.motion = QString::fromStdString(motionTextOf(session->state(), tag));
        row.shortMotion = shortTextOf(*session, tag);
        row.color = QColor(color[0], color[1], color[2]);
        row.isShown = !handleOf(session->state(), tag).isHidden;
        row.isLocked = handleOf(session->state(), tag).isLocked;
        row.isSelected = tag == selected();
        rows.push_back(row);
    }
    panel->showHandles(rows);
}

// --- what the panel says ---

/// What is marked becomes this.
QString BendTool::roleText() const {
    const int tag = tagToMark();
    return tag >= 2   ? QString::fromStdString(nameOf(session->state(), tag))
           : tag == 1 ? "free"
           : tag == 0 ? "fixed"
                      : "outside";
}

/// What is to be done in a mode that marks.
QString BendTool::markingText() const {
    const QString role = roleText(), what = panel->isThrough() ? "what is in it, hidden or not," : "what is seen in it";
    switch (panel->mode()) {
    case BendPanel::Rectangle: return QString("Drag a rectangle: %1 becomes %2.").arg(what, role);
    case BendPanel::Polyline:
        return QString("Click the corners of a polygon; Enter or a double click ends it: %1 becomes %2.")
            .arg(what, role);
    default:
        return QString("Drag over the surface: what the brush meets becomes %1. Its size is on the wheel.").arg(role);
    }
}

QString BendTool::stateText() const {
    if (isSuspended)
        return "The mouse is the camera's: Esc gives it back.";
    if (playing.isActive())
        return "Playing the key frames: Esc, or a click, ends it.";
    if (!hint.isEmpty())
        return hint;
    if (panel->mode() == BendPanel::Line)
        return lineText();
    QString text;
    if (panel->mode() != BendPanel::Bend)
        text = markingText();
    else if (session->model().influence.handles().empty())
        text = session->state().marks ? "Mark a handle (red), then drag it."
                                      : "Drag a point of the surface, or mark what is fixed and what is a handle.";
    else if (drag)
        text = QString::fromStdString(nameOf(session->state(), drag->tag) + ": " + drag->text(seen));
    else if (lit)
        text = QString::fromStdString(nameOf(session->state(), selected())) +
               (lit->axis < 0
                    ? QString(": drag moves it in the view")
                    : QString(lit->kind == BendDrag::Turn ? ": drag turns it about %1" : ": drag moves it along %1")
                          .arg("xyz"[lit->axis]));
    else if (hovered)
        text = QString::fromStdString(nameOf(session->state(), hovered) + ": drag it, or press G, R or S.");
    else if (keysBegin)
        text = "Drag this point, or press G, R or S.";
    else
        text = QString::fromStdString(
            "Drag a handle (red), or a point of the surface. G, R, S: " + nameOf(session->state(), selected()) + ".");
    if (drag && !drag->carried.empty())
        text += "\nHandles beyond it go along, but for locked ones.";
    if (drag && isKeptApart(session->model(), drag->tag))
        text += "\nWhat other handles have bent stays as it is; the wheel makes this one bend that, too.";
    else if (session->model().influence.isLocal)
        text += "\nNothing is marked as fixed: what is farther away than the point radius stays.";
    if (session->nodes() > 0 && milliseconds > 0) {
        text += QString("\n%1 nodes, %2 ms a step").arg(session->nodes()).arg(milliseconds, 0, 'f', 1);
        if (frame > 0)
            text += QString(", drawn %1/s").arg(1000 / frame, 0, 'f', frame > 200 ? 1 : 0);
    }
    return text;
}

void BendTool::refresh() {
    if (!panel || !session)
        return;
    if (preparing) {
        panel->showState(
            preparing->cancelled()
                ? "Stopping ..."
                : QString("%1: %2 %. Esc or a right click stops that.").arg(preparingWhat).arg(preparing->percent()));
        return;
    }
    if (!session->model().influence.isHandle(hovered))
        hovered = 0; // it was undone, or removed, under the mouse
    panel->setPose(int(session->edit().options.pose));
    panel->showMotions(QString::fromStdString(vcg::fcd::WriteMotionText(session->state().motion)));
    showHandles();
    showPoses();
    showLines();
    lookForLine();
    panel->showState(stateText());
}
