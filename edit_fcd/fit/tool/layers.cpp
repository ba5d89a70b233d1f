// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"

#include <layer_fcd/layer_labels.h>
#include <layer_fcd/session_file.h>

// Begins and ends work on a layer, and makes the panel.

using vcg::fcd::Error;

MeshModel *FitTool::layer() const {
    MeshModel *found = session ? presentLayer() : nullptr;
    return found && found->cm.vn > 0 ? found : nullptr;
}

MeshModel *FitTool::target() const {
    MeshModel *found = view && view->md() ? view->md()->getMesh(targetId) : nullptr;
    return found && found != model && found->cm.vn > 0 ? found : nullptr;
}

MeshModel &FitTool::expectedTarget() const {
    MeshModel *found = target();
    if (!found)
        throw Error("There is no other layer to fit onto. Open the scan as another layer, or choose a target.");
    return *found;
}

bool FitTool::start(MeshDocument &newDocument, GLArea *area) {
    enterDocument(newDocument, area);
    forgetGone(left);
    if (!newDocument.mm() || newDocument.mm()->cm.vn == 0)
        return false;
    try {
        open(*newDocument.mm());
    } catch (...) {
        close();
        throw;
    }
    makePanel();
    enterView();
    showLayers();
    refresh();
    return true;
}

/// Begins with a layer, or continues where it was left.
void FitTool::open(MeshModel &newModel) {
    std::unique_ptr<FitSession> before;
    if (const auto found = left.find(newModel.id()); found != left.end()) {
        before = std::move(found->second);
        left.erase(found);
    }
    if (before && before->isUpToDate())
        session.swap(before);
    else
        session = std::make_unique<FitSession>(*view->md(), newModel);
    const std::string wrong = session->goOn(before.get());
    if (!wrong.empty())
        say("The curves of the layer " + inQuotes(newModel) + " are left out: " + wrong, true);
    takeTarget(newModel);
    stroke.reset();
    enterLayer(newModel);
    targetOverlay = std::make_unique<LayerOverlay>();
    selected = -1;
    later([this] { pullAsLeft(); });
}

/// Pulls a layer again that was left pulled in another run, to know its distances from the target.
void FitTool::pullAsLeft() {
    const MeshModel *onto = layer() ? target() : nullptr;
    if (onto && onto->label().toStdString() == session->targetName && session->isAsLeft() &&
        session->state().shape == FitShape::Pulled && !session->pulled(*onto))
        reshape(true);
}

/// Finds the target of a layer that was fitted before by its name, since numbers differ in other documents.
void FitTool::takeTarget(const MeshModel &fitted) {
    const std::string &name = session->targetName;
    const MeshModel *known = view->md()->getMesh(targetId);
    if (name.empty() || (known && known != &fitted && known->cm.vn > 0 && known->label().toStdString() == name))
        return;
    if (const MeshModel *found = layerNamed(name, *view->md(), fitted))
        targetId = found->id();
    else
        say("The layer " + inQuotes(fitted) + " was fitted to '" + name +
                "', which is not here: open it and choose this layer again, or choose another target.",
            true);
}

void FitTool::changeLayer(MeshDocument &document, GLArea *area) {
    if (isEnding || (document.mm() && document.mm()->id() == layerId && layer())) {
        showTargets(); // layers may have changed
        return;
    }
    close();
    view = area;
    if (document.mm() && document.mm()->cm.vn > 0)
        start(document, area);
}

void FitTool::keepShown() {
    stopWork();
    if (session->leave())
        say("The layer " + inQuotes(*model) + " keeps the fit: undo in the tool, or 'FCD: Reset Pose', takes it back.");
    session->keep(target());
}

/// Takes a session from a file, as a change that undo takes back.
SessionContents FitTool::takeSession(const QString &file) {
    stopWork();
    session->restore(); // a saved session begins from the rest shape
    SessionContents contents;
    try {
        contents = loadSession(*document, *model, file);
    } catch (...) {
        reshape(true);
        throw;
    }
    left[layerId] = std::move(session);
    open(*model);
    if (!session->isAsLeft())
        reshape(true);
    panel->showOptions(session->state().options);
    showTargets();
    showVertices(true);
    model->setMeshModified();
    showColors();
    showLayers();
    return contents;
}

/// Leaves the layer in the shown shape, or as something else has changed it, and keeps the session for later.
void FitTool::leave() {
    if (!layer())
        return;
    if (session->isUpToDate())
        guarded([&] { keepShown(); });
    display->rest();
    display->updateShape(true);
    left[layerId] = std::move(session);
}

void FitTool::close() {
    stopWork();
    optionsTimer.stop();
    dragged.reset();
    stroke.reset();
    isStepWanted = isFollowWanted = false;
    leave();
    if (view && view->md() && !wasVisible.empty()) {
        for (const auto &[number, visible] : wasVisible)
            if (MeshModel *each = view->md()->getMesh(number))
                host::setVisible(*each, visible);
        host::showChanges(*view->md());
    }
    wasVisible.clear();
    session.reset();
    leaveView();
    panel = nullptr;
}

bool FitTool::isReady() {
    if (!layer())
        return false;
    if (session->isUpToDate())
        return true;
    stopWork();
    say("Something else has changed the layer " + inQuotes(*model) + ": the fit begins from the shape that it has now.",
        true);
    MeshModel &same = *model;
    session.reset();
    open(same);
    refresh();
    return true;
}

void FitTool::makePanel() {
    panel = new FitPanel(view->window());
    when(panel.data(), &FitPanel::targetChosen, [this] { onTarget(); });
    when(panel.data(), &FitPanel::seenChosen, [this] {
        view->setFocus();
        showLayers();
    });
    when(panel.data(), &FitPanel::brushChosen, [this] {
        view->setFocus();
        takeBrush();
        refresh();
    });
    when(panel.data(), &FitPanel::shapeChosen, [this] {
        later([this] { refresh(); });
        if (isReady())
            setShape(panel->shape());
    });
    when(panel.data(), &FitPanel::optionsChanged, [this] { onOptions(); });
    when(panel.data(), &FitPanel::distanceToggled, [this] {
        if (panel->showsDistance() && panel->seen() != FitPanel::Source)
            setSeen(FitPanel::Source); // the target would cover it
        showColors();
    });
    when(panel.data(), &FitPanel::command, [this](int which) {
        hint.clear();
        guarded([&] { act(which); });
        refresh();
    });
    when(panel.data(), &FitPanel::pairSelected, [this](int row) {
        selected = row;
        view->update();
    });
    when(panel.data(), &FitPanel::pairRenamed, [this](int row, const QString &name) {
        later([this] { refresh(); }); // after the list's own events
        if (!isReady())
            return;
        session->change();
        std::vector<FitPair> &pairs = session->edit().pairs;
        if (const std::string given = name.trimmed().toStdString(); !given.empty() && row < int(pairs.size()))
            pairs[std::size_t(row)].name = given; // the pair may be gone meanwhile
    });
    when(panel.data(), &FitPanel::pairRemoved, [this](int row) {
        selected = row;
        later([this] {
            guarded([&] { act(FitAction::Remove); });
            refresh();
        });
    });
    showTargets();
    panel->showOptions(session->state().options);
    dockPanel(*view, *panel);
}

/// Offers the other layers as targets, and chooses the one of before, or else the first.
void FitTool::showTargets() {
    if (!panel || !view || !view->md())
        return;
    std::vector<std::pair<int, QString>> layers;
    for (const MeshModel *each : host::layers(*view->md()))
        if (each != model && each->cm.vn > 0)
            layers.emplace_back(each->id(), each->label());
    if (!target() && !layers.empty())
        targetId = layers.front().first;
    panel->showTargets(layers, targetId);
}

void FitTool::onTarget() {
    targetId = panel->target();
    if (session && target())
        session->targetName = target()->label().toStdString();
    showLayers();
    showColors();
    if (isReady())
        reshape(true);
    refresh();
}
