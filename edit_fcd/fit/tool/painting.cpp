// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"

#include "edit_fcd/view/distance_colors.h"
#include "edit_fcd/view/layer_ray.h"

#include <algorithm>

// The brush that paints weights, and the colours over the layers.

void FitTool::setBrush(FitPanel::Brush which) {
    panel->setBrush(which);
    takeBrush();
}

/// Takes the panel's brush.
void FitTool::takeBrush() {
    if (isPainting())
        lastBrush = panel->brush();
    if (isPainting() && panel->seen() == FitPanel::InTurn)
        setSeen(FitPanel::Source); // while painting, layers do not take turns
    view->setMouseTracking(isPainting());
    showColors();
}

void FitTool::turnWheel(QWheelEvent *event) {
    if (!isPainting() || event->modifiers() != Qt::NoModifier) {
        toHost(*view, event);
        return;
    }
    panel->setBrushSize(brushAfter(panel->brushSize(), event->angleDelta().y() / 120.0));
    view->update();
}

/// The front one of the visible layers under the mouse.
MeshModel *FitTool::layerAtMouse() const {
    const FitMarks shown = marks();
    MeshModel *front = nullptr;
    double least = 2;
    for (MeshModel *each : {shown.showsSource ? model : nullptr, shown.showsTarget ? target() : nullptr}) {
        const std::optional<LayerHit> hit =
            each ? hitLayer(*each, seen, windowOfMouse().head<2>()) : std::optional<LayerHit>();
        if (hit && hit->depth < least) {
            front = each;
            least = hit->depth;
        }
    }
    return front;
}

/// \return false: there is nothing to paint on
bool FitTool::beginStroke() {
    MeshModel *on = layerAtMouse();
    if (!on)
        return false;
    stopWork(); // it has other weights
    stroke.emplace(*session, *on, panel->brush() == FitPanel::Counts ? 1.f : 0.f, *view, seen);
    strokeTo();
    return true;
}

void FitTool::strokeTo() {
    if (!stroke || !layer())
        return;
    const MeshModel *on = view->md()->getMesh(stroke->layer());
    if (!on)
        return;
    stroke->moveTo(windowOfMouse().head<2>(), panel->brushSize() * view->devicePixelRatioF(), *on, seen);
    showCarried(*on);
    view->update();
}

void FitTool::endStroke() {
    if (!stroke)
        return;
    const bool isChanged = stroke->end();
    MeshModel *on = layer() ? view->md()->getMesh(stroke->layer()) : nullptr;
    stroke.reset();
    isStepWanted = false;
    if (!on)
        return;
    if (isChanged)
        on->setMeshModified();
    panel->showOptions(session->state().options);
    showColors();
    if (session->state().shape == FitShape::Pulled)
        reshape(true); // also restarts stopped work
    refresh();
}

/// Colours what is carried along.
void FitTool::showCarried(const MeshModel &on) {
    std::vector<vcg::Color4b> colors;
    try {
        colors = colorsOfCarried(session->weightsOf(on));
    } catch (const vcg::fcd::Error &) { // the layer lacks weights; a pull reports that
    }
    LayerOverlay &over = &on == model ? *overlay : *targetOverlay;
    if (colors.empty())
        over.hide();
    else
        over.show(on.cm, colors);
}

/// Shows painted weights, or distances from the target.
void FitTool::showColors() {
    if (!layer() || !panel)
        return;
    panel->showLegend(0);
    if (isPainting()) {
        showCarried(*model);
        if (target())
            showCarried(*target());
        view->update();
        return;
    }
    double most = 0;
    std::vector<vcg::Color4b> colors;
    const FittedSurface *fitted = panel->showsDistance() && target() && !dragged ? session->pulled(*target()) : nullptr;
    if (fitted) {
        most =
            3 * std::max(fitted->report.percentile95, 1e-6 * fitted->diagonal); // farther vertices have no counterpart
        for (std::size_t i = 0; i < fitted->distance.size(); ++i)
            colors.push_back(fitted->matched[i] ? colorOfDistance(fitted->distance[i] / most) : colorOfNoCounterpart());
    }
    if (colors.empty())
        overlay->hide();
    else
        overlay->show(model->cm, colors);
    panel->showLegend(most);
    view->update();
}
