// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"

#include "edit_fcd/view/pointing.h"

#include <QFileDialog>

// Events of mouse, keys and panel.

using vcg::fcd::Error;

// --- the mouse ---

void FitTool::press(QMouseEvent *event) {
    hint.clear();
    mouse = pressed = event->localPos();
    const bool plain = event->button() == Qt::LeftButton && event->modifiers() == Qt::NoModifier && !isCamera;
    if (plain && isReady() && isPainting()) {
        if (beginStroke())
            return;
    } else if (plain && isReady()) {
        dragged = endAt(*session, marks(), seen, windowOfMouse().head<2>());
        if (dragged) {
            session->change();
            selected = int(dragged->pair);
            display->move();
            refreshAll();
            return;
        }
    }
    isClick = plain && !isPainting(); // if the mouse moves before the release, it moves the camera
    isCamera = true;
    toCamera(*view, event);
}

void FitTool::move(QMouseEvent *event) {
    mouse = event->localPos();
    if (isCamera) {
        if ((mouse - pressed).manhattanLength() > 4)
            isClick = false;
        toCamera(*view, event);
    } else if (stroke && !(event->buttons() & Qt::LeftButton)) {
        endStroke(); // it was released elsewhere
    } else if (dragged || stroke) {
        requestStep();
    } else if (isPainting()) {
        view->update(); // draws the brush
    }
}

void FitTool::release(QMouseEvent *event) {
    mouse = event->localPos();
    if (isCamera) {
        isCamera = false;
        toCamera(*view, event);
        if (isClick && isReady())
            click();
        isClick = false;
    } else if (stroke) {
        guarded([&] { strokeTo(); });
        endStroke();
    } else if (dragged) {
        const std::size_t pair = dragged->pair;
        guarded([&] { dragTo(); });
        const bool isWhole = session->state().pairs[pair].isWhole();
        dragged.reset();
        isStepWanted = false;
        display->rest();
        if (isWhole)
            showPairs();
    }
    refresh();
}

/// Puts an end of a pair at the place under the mouse. \return whether there is one \throw vcg::fcd::Error
bool FitTool::place(bool isTarget) {
    const Eigen::Vector2d window = windowOfMouse().head<2>();
    const MeshModel &on = isTarget ? expectedTarget() : *model;
    const std::optional<LayerHit> hit = hitLayer(on, seen, window);
    if (!hit) {
        hint = "There is nothing of " + on.label() + " at that place.";
        return false;
    }
    if (!dragged)
        session->change();
    std::vector<FitPair> &pairs = session->edit().pairs;
    if (isTarget)
        pairs[dragged ? dragged->pair : pairs.size() - 1].place = hit->place;
    else if (dragged)
        setSource(pairs, dragged->pair, hit->slot);
    else
        addPair(pairs, hit->slot);
    return true;
}

/// Puts an end on the layer whose turn it is.
void FitTool::click() {
    const bool isTarget = isTurnOfTarget();
    if (!isTarget)
        expectedTarget();
    if (!place(isTarget))
        return;
    selected = int(session->state().pairs.size()) - 1;
    if (isTarget)
        showPairs();
    showLayers();
}

/// Shows the shape after a change of pairs.
void FitTool::showPairs() {
    if (session->state().shape == FitShape::Rest)
        session->edit().shape = FitShape::Landmarks;
    reshape(true);
}

/// A step of a drag. Errors are shown once the drag ends.
void FitTool::step() {
    try {
        if (stroke)
            strokeTo();
        else
            dragTo();
    } catch (const Error &e) {
        hint = e.what();
        refresh();
    }
}

/// Moves the dragged end to the mouse; beside its layer, it stays.
void FitTool::dragTo() {
    if (!dragged || !layer())
        return;
    const FitEnd which = *dragged;
    const FitPair before = session->state().pairs[which.pair];
    if (!place(which.isTarget) || session->state().pairs[which.pair] == before)
        return;
    if (session->state().pairs[which.pair].isWhole())
        reshape(false);
    view->update();
}

// --- the keys ---

bool FitTool::takesEvent(QEvent &event) {
    if (!session || view->suspendedEditor)
        return false;
    if (event.type() == QEvent::Enter)
        view->setFocus();                           // keys go to what is under the mouse
    if (event.type() == QEvent::ShortcutOverride) { // before the host's shortcuts
        const ActionTable::Row *key = fitActions().of(static_cast<QKeyEvent &>(event));
        if (key && (key->action != FitAction::Cancel || work)) { // the host gets Esc if there is nothing to cancel
            event.accept();
            return true;
        }
    }
    if (event.type() != QEvent::MouseButtonDblClick)
        return false;
    guarded([&] { press(static_cast<QMouseEvent *>(&event)); }); // counts as two clicks, and does not reach the host
    return true;
}

void FitTool::pressKey(QKeyEvent *event) {
    const ActionTable::Row *key = fitActions().of(*event);
    if (!key || !layer() || !panel) {
        event->ignore();
        return;
    }
    event->accept();
    hint.clear();
    if (!dragged && !stroke)
        act(key->action);
    refreshAll();
}

// --- the panel ---

/// Takes the options. The surface follows once the slider rests for a moment.
void FitTool::onOptions() {
    if (!isReady())
        return;
    session->change();
    session->edit().options = panel->options();
    showColors();
    if (session->state().shape != FitShape::Rest)
        optionsTimer.start(150);
}

/// Does the action of a key or a button.
void FitTool::act(int action) {
    switch (action) { // actions that need no layer
    case FitAction::Cancel: cancelPull(); return;
    case FitAction::InTurn:
    case FitAction::Both:
    case FitAction::Source:
    case FitAction::Target: setSeen(FitPanel::Seen(action - FitAction::InTurn)); return;
    case FitAction::Brush: setBrush(isPainting() ? FitPanel::Pairs : lastBrush); return;
    case FitAction::OtherBrush:
        if (isPainting())
            setBrush(lastBrush == FitPanel::Carried ? FitPanel::Counts : FitPanel::Carried);
        return;
    }
    if (!isReady() || dragged || stroke)
        return;
    switch (action) {
    case FitAction::Undo:
    case FitAction::Redo:
        stopWork();
        if (action == FitAction::Undo ? session->undo() : session->redo()) {
            selected = -1;
            panel->showOptions(session->state().options);
            reshape(true);
            showLayers();
        }
        break;
    case FitAction::Remove:
    case FitAction::Clear:
        if (action == FitAction::Remove && (selected < 0 || selected >= int(session->state().pairs.size())))
            break;
        session->change();
        if (action == FitAction::Remove)
            session->edit().pairs.erase(session->edit().pairs.begin() + selected);
        else
            session->edit().pairs.clear();
        selected = -1;
        reshape(true);
        showLayers();
        break;
    case FitAction::Reset:
    case FitAction::Pull: setShape(action == FitAction::Reset ? FitShape::Rest : FitShape::Pulled); break;
    case FitAction::Load:
    case FitAction::Save: chooseFiles(action == FitAction::Load); break;
    case FitAction::LoadCurves:
        if (const QString file = fileToLoad("Load curves", "Tables (*.csv)"); !file.isEmpty())
            setCurves(file.toStdString());
        break;
    case FitAction::ClearCurves: setCurves(""); break;
    case FitAction::SaveSession:
    case FitAction::LoadSession: chooseSession(action == FitAction::LoadSession); break;
    case FitAction::ApplyInPlace:
    case FitAction::ApplyToNew: apply(action == FitAction::ApplyInPlace); break;
    }
}

void FitTool::cancelPull() {
    if (!work)
        return;
    stopWork();
    if (session->state().shape == FitShape::Pulled && !session->isAsLeft() &&
        !(target() && session->pulled(*target()))) {
        session->edit().shape = FitShape::Landmarks;
        reshape(true);
    }
}

void FitTool::setShape(FitShape shape) {
    session->change();
    session->edit().shape = shape;
    if (shape != FitShape::Rest && panel->seen() == FitPanel::InTurn)
        setSeen(FitPanel::Both);
    reshape(true);
}

/// \param file empty: none
void FitTool::setCurves(const std::string &file) {
    session->change();
    session->edit().lines = file.empty() ? nullptr : loadLines(*model, session->restShape().positions().data(), file);
    if (session->state().shape == FitShape::Pulled)
        reshape(true);
    view->update();
}

void FitTool::chooseFiles(bool load) {
    const QString kinds = "Lists and picked points (*.csv *.pp)";
    if (load) {
        const QStringList files = QFileDialog::getOpenFileNames(view->window(), "Load pairs", QString(), kinds);
        if (files.size() > 2)
            hint = "Choose one file with pairs, or the picked points (.pp) of both layers.";
        if (files.empty() || files.size() > 2 || !isReady())
            return;
        session->change();
        session->edit().pairs = loadPairs(*model, session->restShape().positions().data(), files);
        selected = -1;
        showPairs();
        showLayers();
    } else {
        expectSavable(session->state().pairs);
        const QString file = fileToSave("Save pairs", kinds);
        if (file.isEmpty())
            return;
        savePairs(*model, session->restShape().positions().data(), session->state().pairs, file);
        tell("Saved the pairs as " + file.toStdString() + ".");
    }
}

void FitTool::apply(bool inPlace) {
    const MeshModel &onto = expectedTarget();
    const auto tellCall = [this](const std::string &call) { say("In a script: " + call); };
    session->expectFitted(onto);
    stopWork(); // it belongs to the shape before
    session->change();
    if (inPlace) {
        const bool hadCurves = session->state().lines != nullptr;
        tellCall(session->applyInPlace(onto));
        if (hadCurves)
            tell("The curves are gone: they belonged to the earlier shape. Load curves of this one.");
        showVertices(true);
        showColors();
        return;
    }
    wasVisible.erase(layerId); // the new layer is shown in its place
    applyToNewLayer([&] { tellCall(session->applyToNewLayer(onto, panel->graphLayers(), toLog())); }, false);
}
