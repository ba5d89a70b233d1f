// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/handles.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_labels.h>
#include <layer_fcd/tagging.h>

#include <QGuiApplication>

using vcg::fcd::Error;

void BendTool::makePanel() {
    if (panel)
        return;
    panel = new BendPanel(view->window());
    when(panel.data(), &BendPanel::optionsChanged, [this] { onOptions(); });
    when(panel.data(), &BendPanel::poseBegins, [this] {
        if (session && !drag() && !preparing)
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
        refreshAll();
    });
    when(panel.data(), &BendPanel::command, [this](int which) {
        hint.clear();
        onCommand(which);
    });
    for (const CellList *list :
         std::initializer_list<const CellList *>{&panel->handles(), &panel->poses().list(), &panel->poses().keys()})
        when(list, &CellList::editLeft, [this] {
            hint.clear();
            later([this] { refresh(); });
        });
    panel->allowStretch(model->cm.fn > 0);
    panel->showOptions(session->model().options);
    setMode(usualMode);
    dockPanel(*view, *panel);
    if (session->state().marks)
        panel->setRole(BendPanel::Handle, session->model().influence.unusedTag());
}

void BendTool::takeOptions() {
    BendOptions &options = session->edit().options;
    options = panel->options(options);
    setPose(session->edit(), panel->pose());
}

void BendTool::onOptions() {
    if (!isForPanel())
        return;
    if (panel->mode() != BendPanel::Polyline)
        going.reset(); // a marking
    forgetForeseen();
    const BendOptions before = session->edit().options;
    takeOptions();
    showStretch();
    if (!session->edit().options.givesSameShape(before))
        solve(true);
    refreshAll();
}

void BendTool::setMode(BendPanel::Mode mode) {
    if (mode != BendPanel::Polyline && QGuiApplication::mouseButtons() == Qt::NoButton)
        going.reset(); // a begun polygon, as with a click on the mode's button
    panel->setMode(mode);
    forgetForeseen();
    showStretch();
}

void BendTool::apply(bool inPlace) {
    if (!isMoved(session->model()))
        throw Error("Nothing was moved, so there is nothing to apply.");
    session->change();
    panel->setStretch(false);
    showStretch();
    if (!inPlace) {
        applyToNewLayer(
            [&] {
                say(session->applyToNewLayer(panel->graphLayers(), toLog()));
                tell("The layer " + inQuotes(*document->mm()) +
                     " has the pose; the tool goes on with it. The other one is at rest, and hidden.");
            },
            true);
        return;
    }
    try {
        say(session->applyInPlace(toLog()));
        tell(std::string("Applied: the next drag ") +
             (session->state().poses ? "and the named poses begin" : "begins") +
             " from this shape. Undo takes that back.");
    } catch (...) {
        showVertices(true);
        throw;
    }
    active = 0;
    showVertices(true);
    showChanged();
    showOverlay();
}

bool BendTool::isForPanel() { return isReady() && !(going && going->holdsPanel()); }

void BendTool::onCommand(int which) {
    if (!isForPanel())
        return;
    switch (which) {
    case BendAction::MarkSelection: {
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
        takeMarks();
        break;
    }
    case BendAction::ClearMarks:
        session->change();
        session->clearMarks();
        showOverlay();
        solve(true);
        break;
    case BendAction::TakeMotions:
        session->change();
        setMotions(session->edit(), panel->motions().toStdString());
        solve(true);
        view->setFocus();
        break;
    case BendAction::Undo:
    case BendAction::Redo:
        if (which == BendAction::Undo)
            session->undo();
        else
            session->redo();
        panel->showOptions(session->model().options);
        showOverlay();
        solve(true);
        break;
    case BendAction::Reset:
        session->change();
        session->reset();
        solve(true);
        break;
    case BendAction::ApplyInPlace:
    case BendAction::ApplyToNewLayer: apply(which == BendAction::ApplyInPlace); break;
    case BendAction::SaveSession:
    case BendAction::LoadSession: chooseSession(which == BendAction::LoadSession); break;
    }
    refreshAll();
}

// --- the list of handles ---

void BendTool::connectHandles() {
    const BendHandleList *list = &panel->handles();
    when(list, &BendHandleList::selected, [this](int tag) {
        active = tag;
        isChosen = true;
        later([this] { refresh(); }); // after the list's own events
        view->update();
    });
    when(list, &BendHandleList::removed, [this](int tag) {
        later([this] { refresh(); });
        if (!isForPanel())
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
    if (!isForPanel())
        return;
    hint.clear();
    session->change();
    BendHandle handle = handleOf(session->state(), to.tag);
    if (to.name != nameOf(to.tag))
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

void BendTool::showHandles() {
    std::vector<BendHandleRow> rows;
    for (const int tag : session->model().influence.handles()) {
        const vcg::Color4b color = colorOfTag(tag);
        BendHandleRow row;
        row.tag = tag;
        row.name = nameOf(tag);
        row.motion = QString::fromStdString(motionTextOf(session->state(), tag));
        row.shortMotion = QString::fromStdString(shortMotionOf(session->state(), tag));
        row.color = QColor(color[0], color[1], color[2]);
        row.isShown = !handleOf(session->state(), tag).isHidden;
        row.isLocked = handleOf(session->state(), tag).isLocked;
        row.isSelected = tag == selected();
        rows.push_back(row);
    }
    panel->showHandles(rows);
}
