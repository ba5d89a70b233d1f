// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/line_interaction.h"

#include "edit_fcd/bend/model/guide_line.h"
#include "edit_fcd/view/layer_ray.h"

namespace {

/// A point of the line at the place of the layer under the mouse.
std::optional<BendLinePoint> pointAtMouse(const BendStage &stage) {
    const std::optional<LayerHit> hit = hitLayer(*stage.model, stage.seen, stage.mouseInWindow().head<2>());
    if (!hit)
        return {};
    BendLinePoint point;
    point.corner = hit->corner;
    point.weight = hit->weight;
    return point;
}

} // namespace

std::optional<std::size_t> linePointAt(const BendStage &stage) {
    double least = 10; // pixels
    std::optional<std::size_t> found;
    const Eigen::Matrix3Xd points = lineOf(*stage.session);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double distance = (stage.seen.toWindow(points.col(i)) - stage.mouseInWindow()).head<2>().norm();
        if (distance < least) {
            least = distance;
            found = std::size_t(i);
        }
    }
    return found;
}

bool LineInteraction::begin() {
    if (stage.panel->line().lineLayer() >= 0)
        return false;
    std::vector<BendLinePoint> &line = stage.session->edit().state.line;
    const std::optional<std::size_t> there = linePointAt(stage);
    const std::optional<BendLinePoint> point = there ? std::nullopt : pointAtMouse(stage);
    if (!there && !point)
        return false;
    stage.session->change();
    which = there.value_or(line.size());
    if (point)
        line.push_back(*point);
    return true;
}

/// Moves the point to the mouse; beside the layer, it stays.
void LineInteraction::move(QMouseEvent &event) {
    if (!(event.buttons() & Qt::LeftButton)) { // it was released elsewhere
        stage.ended();
        return;
    }
    std::vector<BendLinePoint> &line = stage.session->edit().state.line;
    const std::optional<BendLinePoint> point = pointAtMouse(stage);
    if (!point || which >= line.size())
        return;
    line[which] = *point;
    stage.refresh();
    stage.view->update();
}
