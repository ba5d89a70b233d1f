// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"

#include "edit_fcd/view/brush.h"
#include "edit_fcd/view/colors.h"
#include "edit_fcd/view/layer_ray.h"
#include <layer_fcd/layer_matrix.h>

#include <algorithm>
#include <utility>

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
    stroke = Stroke{on->id(), panel->brush() == FitPanel::Counts ? 1.f : 0.f, depthOf(*view, seen), {}};
    session->beginStroke(*on);
    strokeTo();
    return true;
}

/// Paints the visible vertices near the mouse's path since the last call.
void FitTool::strokeTo() {
    if (!stroke || !layer())
        return;
    const MeshModel *on = view->md()->getMesh(stroke->layer);
    if (!on)
        return;
    const double radius = panel->brushSize() * view->devicePixelRatioF();
    const Eigen::Vector2d to = windowOfMouse().head<2>(), from = std::exchange(stroke->from, to).value_or(to);
    const SeenPart::IsIn isIn = [&](const Eigen::Vector2d &p) { return distanceToSegment(p, from, to) <= radius; };
    const SeenPart part(seen, isIn, stroke->depth, session->restShape().diagonal());
    const Eigen::Affine3d world = matrixOf(*on);
    const auto isSeen = [&](std::size_t i) {
        const CVertexO &vertex = on->cm.vert[i];
        return !vertex.IsD() && part.has(world * toVector(vertex.cP()));
    };
    session->paint(slotsThat(on->cm.vert.size(), isSeen), stroke->weight);
    showCarried(*on);
    view->update();
}

void FitTool::endStroke() {
    if (!stroke)
        return;
    const bool isChanged = session->endStroke();
    MeshModel *on = layer() ? view->md()->getMesh(stroke->layer) : nullptr;
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
    FitWeights weights;
    try {
        weights = session->weightsOf(on);
    } catch (const vcg::fcd::Error &) { // the layer lacks weights; a pull reports that
    }
    std::vector<vcg::Color4b> colors;
    if (std::any_of(weights.begin(), weights.end(), [](float weight) { return !(weight >= 1); }))
        for (const float weight : weights)
            colors.emplace_back(150, 60, 200, (unsigned char)(weight >= 0 ? 170 * (1 - std::min(weight, 1.f)) : 170));
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
