// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/session_file.h> // before Qt

#include "edit_fcd/kit/layer_tool.h"

#include <set>

#include <QFileDialog>

void LayerTool::later(const std::function<void()> &work, int milliseconds) {
    QTimer::singleShot(milliseconds, this, [this, work] { guarded(work); });
}

void LayerTool::every(QTimer &timer, const std::function<void()> &work) {
    timer.disconnect(this);
    timer.callOnTimeout(this, [this, &timer, work] {
        if (!guarded(work))
            timer.stop();
    });
}

void LayerTool::say(const std::string &text, bool warning) {
    if (!view)
        return;
    view->Log(warning ? GLLogStream::WARNING : GLLogStream::FILTER,
              (action->text().toStdString() + ": " + host::plainForLog(text)).c_str());
    if (!warning)
        return;
    hint = QString::fromStdString(text);
    showHint();
}

void LayerTool::tell(const std::string &what, const std::string &more) {
    say(what + (more.empty() ? "" : " " + more));
    hint = QString::fromStdString(what);
    showHint();
}

void LayerTool::showHint() {
    if (ToolPanel *panel = toolPanel())
        panel->showState(hint);
}

void LayerTool::refreshAll() {
    refresh();
    if (view)
        view->update();
}

void LayerTool::requestStep() {
    isStepWanted = true;
    if (isPainted)
        takeStep();
}

void LayerTool::takeStep() {
    if (!isStepWanted)
        return;
    isStepWanted = false;
    step();
}

void LayerTool::beginDraw() {
    isPainted = true;
    if (view && view->suspendedEditor != isSuspended) {
        isSuspended = view->suspendedEditor;
        later([this] { refresh(); });
    }
    seen = viewNow();
    if (isStepWanted)
        later([this] { takeStep(); });
}

void LayerTool::enterDocument(MeshDocument &newDocument, GLArea *area) {
    close();
    isEnding = false;
    view = area;
    if (document == &newDocument)
        return;
    document = &newDocument;
    when(document.data(), &QObject::destroyed, [this](QObject *) { forgetDocument(); });
}

bool LayerTool::eventFilter(QObject *object, QEvent *event) {
    bool isTaken = false;
    if (view && object == view)
        guarded([&] { isTaken = takesEvent(*event); });
    return isTaken || HostEditTool::eventFilter(object, event);
}

void LayerTool::enterView() {
    view->installEventFilter(this);
    when(view.data(), &QObject::destroyed, [this](QObject *) { close(); });
    view->setFocus();
    // The host marks a layer as changed as soon as a tool begins: undo that.
    later([this, layer = layerId, isChanged = model->meshModified()] {
        MeshModel *same = view && view->md() && layer == layerId ? view->md()->getMesh(layer) : nullptr;
        if (same)
            same->setMeshModified(isChanged);
    });
}

void LayerTool::leaveView() {
    display.reset();
    overlay.reset();
    model = nullptr;
    layerId = -1;
    if (ToolPanel *panel = toolPanel())
        panel->deleteLater();
    if (!view)
        return;
    view->removeEventFilter(this);
    disconnect(view, &QObject::destroyed, this, nullptr);
    view->setMouseTracking(false);
    view->unsetCursor();
}

void LayerTool::enterLayer(MeshModel &newModel) {
    model = &newModel;
    layerId = newModel.id();
    display = std::make_unique<DisplayState>(*view, newModel);
    overlay = std::make_unique<LayerOverlay>();
}

MeshModel *LayerTool::presentLayer() const {
    MeshModel *found = view && view->md() ? view->md()->getMesh(layerId) : nullptr;
    return found == model ? found : nullptr;
}

QString LayerTool::fileToLoad(const QString &title, const QString &kinds) {
    const QString file = QFileDialog::getOpenFileName(view->window(), title, QString(), kinds);
    return !file.isEmpty() && isReady() ? file : QString();
}

QString LayerTool::fileToSave(const QString &title, const QString &kinds) {
    const QString file = ::fileToSave(*view, title, kinds, *model);
    return !file.isEmpty() && isReady() ? file : QString();
}

void LayerTool::chooseSession(bool load) {
    const QString kinds = "Sessions (*.fcd)";
    const QString file = load ? fileToLoad("Load session", kinds) : fileToSave("Save session", kinds);
    if (file.isEmpty())
        return;
    if (load) {
        const SessionContents contents = takeSession(file);
        tell("Loaded the session " + file.toStdString() + ".", "It has " + describe(contents));
        return;
    }
    keepShown();
    showVertices(true);
    const SessionContents contents = saveSession(*model, file);
    tell("Saved the session as " + file.toStdString() + ".", "It has " + describe(contents) + " Save the layer, too.");
}

void LayerTool::applyToNewLayer(const std::function<void()> &apply, bool goesOn) {
    isEnding = true; // another layer becomes the current one
    std::set<int> before;
    for (const MeshModel *each : host::layers(*document))
        before.insert(each->id());
    try {
        apply();
    } catch (...) {
        isEnding = false;
        showVertices(true);
        throw;
    }
    // The host makes the buffers of new layers when the tool ends.
    close();
    later([this, goesOn, before, told = hint] {
        action->trigger();
        if (!view || !view->md() || !view->md()->mm())
            return;
        for (const MeshModel *each : host::layers(*view->md()))
            if (before.count(each->id()) == 0) {
                host::showTextures(*view, *each);
                view->md()->getMesh(each->id())->setMeshModified(); // no file has it
            }
        if (!goesOn)
            return;
        action->trigger();
        hint = told; // which the change of layers clears
        if (view)
            showHint();
    });
}

#include "edit_fcd/kit/moc_layer_tool.cpp" // NOLINT(bugprone-suspicious-include)
