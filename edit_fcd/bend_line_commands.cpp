// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include "layer_ray.h"

#include <layer_fcd/layer_straightener.h>

#include <QFileDialog>

// The line that a layer is straightened along.

namespace {

BendLinePoint pointOf(const LayerHit &hit) {
    BendLinePoint point;
    point.corner = hit.corner;
    point.weight = hit.weight;
    return point;
}

} // namespace

std::optional<std::size_t> BendTool::linePointAt(const Eigen::Vector2d &window) const {
    double least = 10; // pixels
    std::optional<std::size_t> found;
    const Eigen::Matrix3Xd points = session->line();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double distance = (seen.toWindow(points.col(i)).head<2>() - window).norm();
        if (distance < least) {
            least = distance;
            found = std::size_t(i);
        }
    }
    return found;
}

/// Takes the point of the line under the mouse, or adds one there. \return whether there is a place for it
bool BendTool::pressLine() {
    if (panel->line().lineLayer() >= 0)
        return false;
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    linePoint = linePointAt(window);
    if (linePoint) {
        session->change();
        return true;
    }
    const std::optional<LayerHit> hit = hitLayer(*model, seen, window);
    if (!hit)
        return false;
    session->change();
    std::vector<BendLinePoint> line = session->state().line;
    linePoint = line.size();
    line.push_back(pointOf(*hit));
    session->setLine(std::move(line));
    return true;
}

/// The point is where the mouse is; beside the layer, it stays where it was.
void BendTool::dragLinePoint() {
    const std::optional<LayerHit> hit = hitLayer(*model, seen, mouseInWindow().head<2>());
    std::vector<BendLinePoint> line = session->state().line;
    if (!hit || !linePoint || *linePoint >= line.size())
        return;
    line[*linePoint] = pointOf(*hit);
    session->setLine(std::move(line));
    view->update();
}

void BendTool::removeLinePoint() {
    std::vector<BendLinePoint> line = session->state().line;
    if (line.empty())
        return;
    findMouse();
    const std::size_t which = linePointAt(mouseInWindow().head<2>()).value_or(line.size() - 1);
    linePoint.reset();
    session->change();
    line.erase(line.begin() + std::ptrdiff_t(which));
    session->setLine(std::move(line));
}

void BendTool::onLineCommand(int which) {
    if (!isReady() || drag)
        return;
    hint.clear();
    switch (which) {
    case BendLineBox::Load: {
        const QString file = QFileDialog::getOpenFileName(view->window(), "Load line", QString(),
                                                          "Picked points and lists (*.pp *.csv *.txt)");
        if (file.isEmpty() || !isReady())
            return;
        session->change();
        session->loadLine(file);
        break;
    }
    case BendLineBox::Save: {
        session->expectLine();
        const QString file = fileToSave(*view, "Save line", "Lists of points (*.csv)", {".csv"});
        if (file.isEmpty() || !isReady())
            return;
        session->saveLine(file);
        say("Saved the line as " + file.toStdString() + ".");
        break;
    }
    case BendLineBox::Clear:
        session->change();
        session->setLine({});
        break;
    case BendLineBox::Straighten: straighten(); return;
    }
    refresh();
    view->update();
}

/// What the layer shows becomes straight, or bent, in a new layer.
void BendTool::straighten() {
    StraightenMeshParam param = panel->line().param();
    param.graphLayers = panel->graphLayers();
    param.targetLayer = document->getMesh(panel->line().targetLayer());
    param.lineLayer = document->getMesh(panel->line().lineLayer());
    if (!param.lineLayer) {
        session->expectLine();
        param.line = session->line();
    }
    const vcg::fcd::LineGoal goal = lineGoalOf(*model, param);
    keepShown();
    showVertices(true);
    const auto shape = std::make_shared<StraightenedShape>();
    beside(
        "Straightening",
        [=](const vcg::fcd::Progress &progress) { *shape = straightened(*model, goal, param, progress); },
        [=] {
            applyToNewLayer(
                [&] {
                    const Remark remark = [this](const std::string &text) { say(text); };
                    const StraightenedLayers made =
                        addStraightened(*document, *model, param, std::move(*shape), remark, vcg::fcd::Progress());
                    say(describe(made));
                    for (const std::string &warning : warningsOf(made))
                        say(warning, true);
                    say("In a script: " + BendSession::straightenCall(param, made.line));
                },
                true);
        });
}

void BendTool::showLines() {
    BendLineBox::Layers lines;
    for (const MeshModel *each : host::layers(*document))
        if (each->id() != layerId && each->cm.en > 0)
            lines.emplace_back(each->id(), each->label());
    panel->line().showLayers(lines);
}

QString BendTool::lineText() const {
    const std::size_t points = session->state().line.size();
    if (panel->line().lineLayer() >= 0)
        return "The line is that of the layer: 'Straighten to new layer' does it.";
    if (points < 2)
        return "Click points along the layer, in their order, from one end to the other.";
    return QString("%1 points: click more, drag one to move it, Del removes one. 'Straighten to new layer' does it.")
        .arg(points);
}
