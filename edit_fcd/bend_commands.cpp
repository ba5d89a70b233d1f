// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include <layer_fcd/layer_contents.h>

#include <algorithm>

#include <QMainWindow>
#include <QMdiArea>
#include <QMdiSubWindow>

using vcg::fcd::Error;

void BendTool::makePanel() {
    if (panel)
        return;
    auto *window = qobject_cast<QMainWindow *>(view->window());
    panel = new BendPanel(view->window());
    connect(panel, &BendPanel::optionsChanged, this, [this] { guarded([&] { onOptions(); }); });
    connect(panel, &BendPanel::command, this, [this](int which) { guarded([&] { onCommand(which); }); });
    if (window)
        window->addDockWidget(Qt::LeftDockWidgetArea, panel);
    panel->allowStretch(model->cm.fn > 0);
    showOptions();
    panel->show();
    followDocument();
    if (session->isMarked())
        panel->setRole(BendPanel::Handle, session->unusedTag());
}

/// The panel is seen as long as its document is: its buttons act on that.
void BendTool::followDocument() {
    QMdiArea *area = nullptr;
    QMdiSubWindow *own = nullptr;
    for (QWidget *each = view; each && !area; each = each->parentWidget()) {
        own = own ? own : qobject_cast<QMdiSubWindow *>(each);
        area = qobject_cast<QMdiArea *>(each);
    }
    if (area && own)
        connect(area, &QMdiArea::subWindowActivated, panel,
                [area, own, panel = panel.data()] { panel->setVisible(area->currentSubWindow() == own); });
}

void BendTool::takeOptions() {
    BendOptions &options = session->options;
    options.smoothness = panel->smoothness();
    options.initialPatches = panel->patches();
    options.weights = panel->weights();
    options.mirror = panel->mirror();
    options.pose = panel->pose();
}

/// The panel shows the options of the session, which has gone back to others.
void BendTool::showOptions() {
    const BendOptions &options = session->options;
    panel->setShape(options.smoothness, options.initialPatches, options.weights, options.mirror, int(options.pose));
    panel->setStretch(options.stretch);
}

void BendTool::onOptions() {
    if (!isReady() || drag)
        return;
    if (panel->mode() != BendPanel::Polyline)
        marking.reset();
    trackMouse();
    const BendOptions before = session->options;
    takeOptions();
    showStretch();
    if (!session->options.givesSameShape(before))
        solve(true);
    refresh();
    view->update();
}

void BendTool::setMode(BendPanel::Mode mode) {
    panel->setMode(mode);
    trackMouse();
    showStretch();
}

void BendTool::beginApply() {
    if (!session->moves())
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
        std::vector<char> selected = onSelectedFaces(*model);
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < selected.size(); ++i)
            if (!model->cm.vert[i].IsD() && (selected[i] || model->cm.vert[i].IsS()))
                all.push_back(i);
        if (all.empty())
            throw Error("Nothing is selected.");
        session->change();
        takeNewHandle();
        session->mark(all, panel->tag());
        session->endMarks(panel->radius() * session->diagonal());
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
        session->setMotions(panel->motions().toStdString());
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
        showOverlay();
        break;
    case BendPanel::ApplyToNewLayer:
        beginApply();
        isEnding = true; // another layer becomes the current one
        try {
            say(session->applyToNewLayer(panel->graphLayers(), remark));
        } catch (...) {
            isEnding = false;
            showVertices(true);
            throw;
        }
        // The host shows new layers when a tool ends, and they have no buffers before that; then it goes on with them.
        close();
        QTimer::singleShot(0, this, [this] {
            action->trigger();
            if (!view || !view->md() || !view->md()->mm())
                return;
            host::showTextures(*view, *view->md()->mm());
            action->trigger();
        });
        return;
    }
    refresh();
    view->update();
}

void BendTool::refresh() {
    if (!panel || !session)
        return;
    panel->showMotions(QString::fromStdString(session->motionText()));
    QString text;
    if (session->handleTags().empty()) {
        text = session->isMarked() ? "Mark a handle (red), then drag it."
                                   : "Drag a point of the surface, or mark what is fixed and what is a handle.";
    } else if (session->nodes() == 0) {
        text = "Drag a handle (red).";
        if (session->isLocal())
            text += " Nothing is marked as fixed: what is farther away than the point radius stays.";
    } else {
        const double least = std::max(0.1, milliseconds);
        text = QString("%1 nodes, %2 ms, %3 frames/s")
                   .arg(session->nodes())
                   .arg(least, 0, 'f', 1)
                   .arg(1000 / least, 0, 'f', 0);
    }
    if (drag && !drag->typed.empty())
        text += QString(drag->kind == BendDrag::Move   ? "\nmove "
                        : drag->kind == BendDrag::Turn ? "\nturn "
                                                       : "\nscale ") +
                QString::fromStdString(drag->typed);
    panel->showState(text);
}
