// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/guide_line.h"
#include "edit_fcd/bend/model/session.h"
#include "edit_fcd/bend/tool/interactions.h"
#include "edit_fcd/view/trace.h"

#include <cmath>

#include <QPolygonF>

MarkInteraction::MarkInteraction(BendStage &stage, Kind kind) : BendInteraction(stage), kind(kind) {
    stage.session->change();
    stage.takeNewHandle();
    if (!stage.panel->isThrough())
        depth = depthOf(*stage.view, stage.seen);
}

void MarkInteraction::begin() {
    if (kind == Brush)
        brush();
    else
        corners.assign(kind == Rectangle ? 2 : 1, stage.mouseInWindow().head<2>());
}

/// Empty for a brush.
std::vector<Eigen::Vector2d> MarkInteraction::outline() const {
    if (kind == Rectangle && corners.size() == 2)
        return {corners[0], {corners[1][0], corners[0][1]}, corners[1], {corners[0][0], corners[1][1]}};
    return kind == Polygon ? corners : std::vector<Eigen::Vector2d>();
}

/// Marks the vertices in a part of the window, and those on the other side of the mirror.
void MarkInteraction::mark(const SeenPart::IsIn &isIn) {
    const BendSession &session = *stage.session;
    const Eigen::Affine3d mirror = mirrorOf(session.model());
    const SeenPart part(stage.seen, isIn, depth, session.diagonal());
    const std::vector<std::size_t> found = slotsThat(session.tags().size(), [&](std::size_t slot) {
        if (session.restShape().isDeleted(slot))
            return false;
        const Eigen::Vector3d p = session.positionOf(slot);
        return part.has(p) || (session.model().options.mirror >= 0 && part.has(mirror * p));
    });
    if (kind == Brush || !found.empty())
        stage.session->mark(found, stage.panel->tag());
}

/// Moves the brush to the mouse.
void MarkInteraction::brush() {
    const double radius = stage.panel->brush() * stage.view->devicePixelRatioF();
    const Eigen::Vector2d to = stage.mouseInWindow().head<2>(), from = corners.empty() ? to : corners.back();
    corners = {to};
    mark([&](const Eigen::Vector2d &p) { return distanceToSegment(p, from, to) <= radius; });
    stage.showOverlay();
    stage.view->update();
}

void MarkInteraction::end() {
    stage.ended();
    if (!stage.layer())
        return;
    QPolygonF polygon;
    for (const Eigen::Vector2d &corner : outline())
        polygon << QPointF(corner[0], corner[1]);
    if (kind != Brush)
        mark([&](const Eigen::Vector2d &p) { return polygon.containsPoint(QPointF(p[0], p[1]), Qt::OddEvenFill); });
    stage.takeMarks();
    stage.refresh();
}

void MarkInteraction::cancel() {
    stage.ended();
    if (!stage.layer())
        return;
    stage.session->cancel();
    stage.showOverlay();
}

void MarkInteraction::move(QMouseEvent &event) {
    const bool isHeld = event.buttons() & Qt::LeftButton;
    if (kind != Polygon && !isHeld)
        end(); // it was released elsewhere
    else if (kind == Brush)
        brush();
    else if (isHeld)
        corners.back() = stage.mouseInWindow().head<2>();
}

void MarkInteraction::release() {
    if (kind != Polygon)
        end();
}

/// Adds a corner to a polygon, or ends it.
bool MarkInteraction::press(QMouseEvent &event) {
    if (kind != Polygon)
        return false;
    if (stage.isPlain(event) && stage.panel->mode() == BendPanel::Polyline && stage.isReady())
        corners.emplace_back(stage.mouseInWindow().head<2>());
    else if (event.button() == Qt::RightButton)
        end();
    else
        return false;
    stage.refreshAll();
    return true;
}

bool MarkInteraction::doubleClick() {
    if (kind != Polygon)
        return false;
    end();
    return true;
}

void MarkInteraction::draw() const {
    if (kind != Brush)
        drawOutline(stage.seen, outline());
}

/// A point of the line at the place of the layer under the mouse.
static std::optional<BendLinePoint> pointAtMouse(const BendStage &stage) {
    const std::optional<LayerHit> hit = hitLayer(*stage.model, stage.seen, stage.mouseInWindow().head<2>());
    if (!hit)
        return {};
    BendLinePoint point;
    point.corner = hit->corner;
    point.weight = hit->weight;
    return point;
}

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
    stage.refreshAll();
}

void AnimationInteraction::prepare(const std::function<void()> &begun) {
    stage.beside(
        "Preparing the layer",
        [this](const vcg::fcd::Progress &progress) { length = stage.session->beginAnimation(progress); },
        [this, begun] {
            isReady = stage.isLive = true;
            first = stage.session->state().poses->key.front().time;
            stage.display->move();
            begun();
        },
        [this] { stage.ended(); });
}

void AnimationInteraction::show(double time) {
    try {
        stage.session->showAnimation(time - first);
    } catch (...) {
        cancel();
        throw;
    }
    stage.showVertices(false);
    stage.view->update();
}

void AnimationInteraction::leave() {
    isReady = stage.isStepWanted = false;
    stage.ended();
    if (stage.session)
        stage.session->endAnimation();
}

void AnimationInteraction::cancel() {
    leave();
    if (stage.layer())
        stage.comeToRest();
}

void PlayInteraction::begin() {
    prepare([this] {
        stage.every(frames, [this] {
            if (!stage.isPainted) // the last frame
                return;
            if (!stage.layer()) {
                cancel();
                return;
            }
            const double time = std::fmod(double(since.nsecsElapsed()) / 1e9, length);
            stage.panel->poses().timeline().showTime(first + time);
            show(first + time);
            trace("frame: at %.3f s", time);
        });
        frames.start(5);
        since.start();
        stage.panel->poses().showPlaying(true);
        stage.refresh();
    });
}

void PlayInteraction::cancel() {
    frames.stop();
    if (stage.panel)
        stage.panel->poses().showPlaying(false);
    AnimationInteraction::cancel();
}

void ScrubInteraction::begin(double time) {
    asked = time;
    prepare([this] {
        to(asked);
        if (isReleased)
            end();
    });
}

void ScrubInteraction::to(double time) {
    asked = time;
    if (!isReady)
        return;
    stage.panel->poses().timeline().showTime(time);
    stage.refresh();
    stage.requestStep();
}

void ScrubInteraction::step() {
    if (!isReady || !stage.layer())
        return;
    show(asked);
    trace("scrub: at %.3f s", asked);
}

void ScrubInteraction::end() {
    isReleased = true;
    if (!isReady)
        return;
    leave();
    if (!stage.layer())
        return;
    stage.display->rest();
    kept(asked);
}

QString ScrubInteraction::text() const {
    return "Shows " + stage.panel->poses().timeline().textOf(asked) + ". Esc: as before.";
}
