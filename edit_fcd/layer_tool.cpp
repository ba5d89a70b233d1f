// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_tool.h"

#include <QTimer>

void LayerTool::enterView() {
    view->installEventFilter(this);
    connect(view, &QObject::destroyed, this, [this] { guarded([&] { close(); }); });
    view->setFocus();
    // The host takes a layer for changed as soon as a tool has begun with it.
    QTimer::singleShot(0, this, [this, layer = layerId, isChanged = model->meshModified()] {
        MeshModel *same = view && view->md() && layer == layerId ? view->md()->getMesh(layer) : nullptr;
        if (same)
            same->setMeshModified(isChanged);
    });
}

void LayerTool::leaveView(QDockWidget *panel) {
    display.reset();
    overlay.reset();
    model = nullptr;
    layerId = -1;
    if (panel)
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
    display = std::make_unique<BendDisplay>(*view, newModel);
    overlay = std::make_unique<LayerOverlay>();
}

void LayerTool::applyToNewLayer(const std::function<void()> &apply, bool goesOn) {
    isEnding = true; // another layer becomes the current one
    try {
        apply();
    } catch (...) {
        isEnding = false;
        showVertices(true);
        throw;
    }
    // The host shows new layers when a tool ends, and they have no buffers before that.
    close();
    QTimer::singleShot(0, this, [this, goesOn] {
        action->trigger();
        if (!view || !view->md() || !view->md()->mm())
            return;
        host::showTextures(*view, *view->md()->mm());
        view->md()->mm()->setMeshModified(); // no file has it
        if (goesOn)
            action->trigger();
    });
}

#include "moc_layer_tool.cpp" // NOLINT(bugprone-suspicious-include)
