// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include <layer_fcd/kept_tool.h>
#include <layer_fcd/layer_labels.h>
#include <layer_fcd/session_file.h>

// Begins and ends work on a layer.

bool BendTool::start(MeshDocument &newDocument, GLArea *area) {
    enterDocument(newDocument, area);
    forgetGone(left);
    if (!newDocument.mm())
        return false;
    try {
        open(*newDocument.mm());
    } catch (...) {
        refused = newDocument.mm()->id();
        close();
        throw;
    }
    makePanel();
    enterView();
    view->setMouseTracking(true); // to highlight what is under the mouse
    showOverlay();
    refresh();
    return true;
}

void BendTool::changeLayer(MeshDocument &newDocument, GLArea *area) {
    if (isEnding || (newDocument.mm() && newDocument.mm()->id() == layerId && layer()))
        return;
    refused = -1;
    hint.clear();
    close();
    view = area;
    if (newDocument.mm() &&
        newDocument.mm()->cm.vn > 0) // a file that is being opened is empty at first: draw() starts then
        start(newDocument, area);
}

void BendTool::end() {
    close();
    if (!isEnding)
        usualMode = BendPanel::Drag;
}

void BendTool::forgetDocument() {
    preparing.stop(); // waits for it
    onionSkin.reset();
    going.reset();
    session.reset();
    left.clear();
}

/// Begins with a layer, or continues where it was left. \return whether the layer itself keeps that state
bool BendTool::open(MeshModel &newModel) {
    bool goesOn = false;
    if (const auto found = left.find(newModel.id()); found != left.end()) {
        if (found->second->isAsLeft())
            session = std::move(found->second);
        else if (!toolOf(newModel))
            say("The layer " + inQuotes(newModel) +
                " has changed since you left it: bends begin from the shape that it has now.");
        left.erase(found);
    }
    if (!session) {
        session = std::make_unique<BendSession>(*view->md(), newModel);
        session->edit().options = usual;
        setPose(session->edit(), 100);
        session->edit().options.stretch = false;
        guarded([&] { goesOn = session->goOn(); });
    }
    if (!session->takePoses())
        say("The layer " + inQuotes(newModel) +
            " keeps poses of another shape or place: they begin from the shape that it has now.");
    if (newModel.cm.vn > preparedAtOnce)
        session->readAhead();
    enterLayer(newModel);
    colors = std::make_unique<MarkColors>(newModel);
    active = hovered = keysTag = 0;
    isChosen = keysBegin = false;
    timeOfGhosts = 0;
    lit.reset();
    isLive = isShownChanged = false;
    return goesOn;
}

void BendTool::keepShown() {
    if (const std::string calls = session->leave({}); !calls.empty())
        say("The layer " + inQuotes(*model) +
            " keeps the pose: undo in the tool, or 'FCD: Reset Pose', takes it back. " + calls);
}

SessionContents BendTool::takeSession(const QString &file) {
    session->restore(); // a saved session begins from the rest shape
    SessionContents contents;
    try {
        contents = loadSession(*document, *model, file);
    } catch (...) {
        solve(true);
        throw;
    }
    const std::unique_ptr<BendSession> before = std::move(session);
    open(*model);
    session->follow(std::move(*before));
    if (session->state().poses)
        panel->unfoldPoses();
    panel->showOptions(session->model().options);
    showVertices(true);
    showChanged();
    showOverlay();
    return contents;
}

/// Gives the layer the shown shape exactly, and keeps the session for later.
void BendTool::leave() {
    if (!layer() || !(isLive || session->isUpToDate()))
        return;
    guarded([&] { keepShown(); });
    display->rest();
    display->updateShape(true);
    usual = session->edit().options;
    left[layerId] = std::move(session);
}

void BendTool::close() {
    if (preparing)
        stopPreparing();
    if (going)
        going->cancel();
    going.reset();
    moving.reset();
    linePreview.reset();
    onionSkin.reset();
    isStepWanted = false;
    leave();
    isPainted = false;
    if (session)
        usual = session->edit().options;
    session.reset();
    if (panel) {
        panel->keepSizes();
        usualMode = panel->mode() == BendPanel::Line ? BendPanel::Drag : panel->mode(); // a line is of one layer
    }
    leaveView();
    panel = nullptr;
}

bool BendTool::isReady() {
    if (!view || !view->md() || preparing)
        return false;
    if (going && going->isEndedByAll())
        going->cancel();
    MeshModel *current = view->md()->getMesh(layerId);
    if (!current || !session) {
        session.reset(); // the layer was deleted
        return false;
    }
    if (current == model && (isLive || session->isUpToDate()))
        return true;
    session.reset();
    if (open(*current))
        panel->showOptions(session->model().options);
    else
        takeOptions();
    showOverlay();
    refresh();
    return true;
}
