// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/fit_tool.h"
#include "edit_fcd/view/pointing.h"
#include "edit_fcd/view/colors.h"
#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/edit_host.h>
#include <layer_fcd/layer_matrix.h>

#include <algorithm>
#include <utility>

namespace {

const GLubyte sourceColor[] = {45, 110, 235}, targetColor[] = {245, 140, 25}, ringColor[] = {255, 255, 255};

void drawEnd(const Eigen::Vector3d &p, const GLubyte *color, bool isSelected) {
    for (const bool isRing : {true, false}) {
        glColor3ubv(isRing ? ringColor : color);
        drawPoint(p, (isSelected ? 14.f : 10.f) - (isRing ? 0.f : 4.f));
    }
}

/// Draws over all else, with round points.
class PairDrawing : public FlatDrawing {
  public:
    PairDrawing() {
        glEnable(GL_POINT_SMOOTH);
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    }
};

void drawLine(const std::vector<Eigen::Vector3d> &places, const GLubyte *color) {
    for (const bool isRim : {true, false}) {
        glLineWidth(isRim ? 5.f : 3.f);
        glColor3ubv(isRim ? ringColor : color);
        glBegin(GL_LINE_STRIP);
        for (const Eigen::Vector3d &p : places)
            put(p);
        glEnd();
    }
}

} // namespace

std::optional<FitEnd> endAt(const FitSession &session, const FitMarks &marks, const Camera &view,
                            const Eigen::Vector2d &window) {
    double least = 10; // pixels
    std::optional<FitEnd> found;
    const std::vector<FitPair> &pairs = session.state().pairs;
    for (const bool isTarget : {true, false})
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const FitPair &pair = pairs[i];
            std::optional<Eigen::Vector3d> p;
            if (isTarget && marks.showsTarget)
                p = pair.place;
            else if (!isTarget && marks.showsSource && pair.slot)
                p = session.positionOf(*pair.slot);
            if (!p)
                continue;
            const double distance = (view.toWindow(*p).head<2>() - window).norm();
            if (distance < least) {
                least = distance;
                found = FitEnd{i, isTarget};
            }
        }
    return found;
}

void drawCurves(const FitSession &session, const FitMarks &marks) {
    const std::shared_ptr<const FitLines> &lines = session.state().lines;
    if (!lines)
        return;
    const PairDrawing drawing;
    const RestGuard &rest = session.restShape();
    for (std::size_t c = 0; c < lines->curves.size(); ++c) {
        std::vector<Eigen::Vector3d> source;
        source.reserve(lines->curves[c].source.size());
        for (std::size_t k = 0; k < lines->curves[c].source.size(); ++k) { // moves with its nearest vertex
            const std::size_t slot = lines->nearest[c][k];
            source.emplace_back(lines->curves[c].source[k] + session.positionOf(slot) - rest.world() * rest.at(slot));
        }
        if (marks.showsTarget)
            drawLine(lines->curves[c].target, targetColor);
        if (marks.showsSource)
            drawLine(source, sourceColor);
    }
}

void drawPairs(const FitSession &session, const FitMarks &marks) {
    const PairDrawing drawing;
    const std::vector<FitPair> &pairs = session.state().pairs;
    if (marks.showsSource && marks.showsTarget) {
        glLineWidth(2);
        glColor3ub(240, 240, 240);
        glBegin(GL_LINES);
        for (const FitPair &each : pairs)
            if (each.slot && each.place)
                for (const Eigen::Vector3d &p : {session.positionOf(*each.slot), *each.place})
                    put(p);
        glEnd();
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const FitPair &each = pairs[i];
        if (marks.showsSource && each.slot)
            drawEnd(session.positionOf(*each.slot), sourceColor, int(i) == marks.selected);
        if (marks.showsTarget && each.place)
            drawEnd(*each.place, targetColor, int(i) == marks.selected);
    }
}

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
        most = 3 * std::max(fitted->report.percentile95, 1e-6 * fitted->diagonal); // farther ones have no counterpart
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
