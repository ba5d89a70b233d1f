// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/guide_line.h"
#include "edit_fcd/bend/tool/interactions.h"
#include "edit_fcd/view/trace.h"

#include <layer_fcd/point_sources.h>

// The panel's commands for the line that a layer is straightened along.

void BendTool::removeLinePoint() {
    std::vector<BendLinePoint> &line = session->edit().state.line;
    if (line.empty())
        return;
    findMouse();
    const std::size_t which = linePointAt(*this).value_or(line.size() - 1);
    going.reset();
    session->change();
    line.erase(line.begin() + std::ptrdiff_t(which));
}

void BendTool::onLineCommand(int which) {
    if (!isForPanel())
        return;
    hint.clear();
    switch (which) {
    case BendLineBox::Load: {
        const QString file = fileToLoad("Load line", "Picked points and lists (*.pp *.csv *.txt)");
        if (file.isEmpty())
            return;
        session->change();
        session->edit().state.line = loadLine(file);
        break;
    }
    case BendLineBox::Save: {
        expectedLine(*session);
        const QString file = fileToSave("Save line", "Lists of points (*.csv)");
        if (file.isEmpty())
            return;
        saveLine(*session, file);
        tell("Saved the line as " + file.toStdString() + ".");
        break;
    }
    case BendLineBox::Clear:
        session->change();
        session->edit().state.line.clear();
        break;
    case BendLineBox::Straighten: straighten(); return;
    }
    refreshAll();
}

/// Looks for the line that will be used, and shows it, in the mode Line.
void BendTool::lookForLine() {
    if (!layer() || panel->mode() != BendPanel::Line) {
        linePreview.reset();
        return;
    }
    if (!linePreview)
        linePreview = std::make_unique<BendLinePreview>([this] {
            guarded([&] {
                if (!layer() || !panel)
                    return;
                panel->showState(stateText());
                view->update();
                if (linePreview->isFound())
                    trace("line: %d vertices, %d points, length %.6g, in %.1f ms", model->cm.vn,
                          int(session->state().line.size()), linePreview->last().length, linePreview->milliseconds());
            });
        });
    guarded([&] {
        vcg::fcd::LineGoal goal;
        const MeshModel *other = document->getMesh(panel->line().lineLayer());
        goal.line = other ? readLine(*other) : lineOf(*session);
        goal.middle = panel->line().isMiddle();
        linePreview->look(*model, session->restShape().known(), goal, StraightenMeshParam().bend);
    });
}

/// Straightens, or bends, the shown shape in a new layer.
void BendTool::straighten() {
    StraightenMeshParam param = panel->line().param();
    param.graphLayers = panel->graphLayers();
    param.targetLayer = document->getMesh(panel->line().targetLayer());
    param.lineLayer = document->getMesh(panel->line().lineLayer());
    if (!param.lineLayer)
        param.line = expectedLine(*session);
    const vcg::fcd::LineGoal goal = lineGoalOf(*model, param);
    const KnownLine known = linePreview ? linePreview->stop(goal) : KnownLine();
    keepShown();
    showVertices(true);
    const auto surface = std::make_shared<LineSurface>(*model); // a copy: the layer may be saved or deleted meanwhile
    const auto shape = std::make_shared<StraightenedShape>();
    beside(
        "Straightening",
        [=](const vcg::fcd::Progress &progress) {
            *shape = straightened(std::move(*surface), goal, param, progress, known);
        },
        [=] {
            applyToNewLayer(
                [&] {
                    const StraightenedLayers made =
                        addStraightened(*document, *model, param, std::move(*shape), toLog(), {});
                    say(describe(made));
                    for (const std::string &warning : warningsOf(made))
                        say(warning, true);
                    say("In a script: " + straightenCall(param, made.line));
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
    const bool isOfLayer = panel->line().lineLayer() >= 0;
    const std::size_t points = session->state().line.size();
    if (!isOfLayer && points < 2)
        return QString("Click points along the layer, in their order, from one end to the other.") +
               (points == 1 ? " There is one." : "");
    QString text = isOfLayer ? QString("The line of the layer") : QString("%1 points").arg(points);
    if (!linePreview || !linePreview->isFound())
        text += ": finding the middle ...";
    else if (const BendLinePreview::Found &line = linePreview->last(); !line.error.empty())
        text += ": " + QString::fromStdString(line.error);
    else
        text +=
            QString(", %1 long%2.").arg(line.length, 0, 'g', 6).arg(panel->line().isMiddle() ? " in the middle" : "");
    return text + (isOfLayer ? "" : "\nClick more, drag one to move it, Del removes one.") +
           "\n'Straighten to new layer' does it.";
}
