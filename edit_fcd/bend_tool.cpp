// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_tool.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <QCursor>

void BendTool::say(const std::string &text, bool warning) {
    if (!view)
        return;
    std::string line = "FCD: Bend: " + text;
    std::replace(line.begin(), line.end(), '<', '[');
    std::replace(line.begin(), line.end(), '>', ']');
    view->Log(warning ? GLLogStream::WARNING : GLLogStream::FILTER, line.c_str());
    if (panel && warning)
        panel->showState(QString::fromStdString(text));
}

// --- the drag of a handle ---

/// The handle that keys move where none is under the mouse; 0 where there is none.
int BendTool::selected() const {
    const std::vector<int> handles = session->handleTags();
    if (std::count(handles.begin(), handles.end(), active) > 0)
        return active;
    return handles.empty() ? 0 : handles.front();
}

Eigen::Matrix3d BendTool::axesOf(int tag) const {
    if (session->options.axes != BendAxes::View)
        return session->axesOf(tag);
    const Eigen::Vector3d at = session->pivotOf(tag), window = seen.toWindow(at);
    Eigen::Matrix3d axes;
    axes.col(0) = (seen.toWorld({window[0] + 1, window[1], window[2]}) - at).normalized();
    axes.col(2) = seen.towardsEye(at);
    axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
    return axes;
}

/// That of the selected handle.
std::optional<Gizmo> BendTool::gizmo() const {
    const int tag = drag ? drag->tag : selected();
    if (!tag || session->handle(tag).isHidden || session->handle(tag).isLocked)
        return {};
    return Gizmo{session->pivotOf(tag), drag ? drag->axes : axesOf(tag)};
}

/// \pre session->change()
void BendTool::beginDrag(int tag, GizmoPart part, bool modal) {
    if (session->handle(tag).isLocked)
        throw vcg::fcd::Error(session->nameOf(tag) + " is locked: the list of handles unlocks it.");
    session->setPose(100); // a drag says where that is
    panel->setPose(100);
    active = tag;
    drag = std::make_unique<BendDrag>();
    drag->tag = tag;
    drag->kind = part.kind;
    drag->axis = part.axis;
    drag->modal = modal;
    drag->pivot = session->pivotOf(tag);
    drag->isAbout = session->handle(tag).pivot.has_value();
    drag->axes = axesOf(tag);
    frame = 0;
    sinceDraw.invalidate();
    drag->from = drag->last = mouseInWindow();
    const auto steps = session->state().motion.find(tag);
    if (steps != session->state().motion.end())
        drag->begin = steps->second;
    display->move();
    try {
        const double took = session->prepare();
        if (took > 0 && session->moves())
            solve(false);
        if (std::getenv("FCD_TRACE"))
            std::fprintf(stderr, "FCD trace: press: %d vertices, prepare %.1f ms, since the event %.1f ms\n",
                         model->cm.vn, took, double(sinceEvent.nsecsElapsed()) / 1e6);
    } catch (...) {
        endDrag(false);
        throw;
    }
}

void BendTool::endDrag(bool keep) {
    if (!drag)
        return;
    if (!keep)
        session->cancel();
    else if (layer())
        session->setMotion(drag->tag, drag->motion(seen)); // solved below, to the end
    drag.reset();
    isStepWanted = false;
    sinceEvent.start();
    if (!layer())
        return;
    display->rest();
    solve(true);
    refresh();
    view->update();
}

/// One step a painted frame: the mouse moves more often.
void BendTool::requestStep() {
    isStepWanted = true;
    if (isPainted)
        step();
}

void BendTool::step() {
    isStepWanted = false;
    if (!drag || !layer())
        return;
    session->setMotion(drag->tag, drag->motion(seen));
    solve(false);
    refresh();
}

void BendTool::solve(bool full) {
    QElapsedTimer watch;
    watch.start();
    BendSession::Times times;
    try {
        times = session->pose(full, display->showsFaces());
    } catch (...) {
        session->restore();
        isLive = false;
        showVertices(true);
        throw;
    }
    isLive = !full;
    const double solved = double(watch.nsecsElapsed()) / 1e6;
    showVertices(full);
    milliseconds = double(watch.nsecsElapsed()) / 1e6;
    if (std::getenv("FCD_TRACE"))
        std::fprintf(
            stderr,
            "FCD trace: %s: %d vertices, %d nodes, prepare %.1f, solve %.1f, write %.1f, buffers %.1f, in all %.1f, "
            "since the event %.1f ms\n",
            full ? "full" : "drag", model->cm.vn, session->nodes(), times.prepare, times.solve, times.write,
            milliseconds - solved, milliseconds, sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0.0);
}

// --- marks ---

/// What is marked next to a handle that was moved is another handle, at rest.
void BendTool::takeNewHandle() {
    if (panel->tag() >= 2 && session->state().motion.count(panel->tag()))
        panel->setRole(BendPanel::Handle, session->unusedTag());
}

void BendTool::beginMarking(BendMarking::Kind kind) {
    session->change();
    takeNewHandle();
    marking = std::make_unique<BendMarking>();
    marking->kind = kind;
    if (!panel->isThrough()) {
        marking->depth.resize(std::size_t(seen.width) * std::size_t(seen.height), 1);
        view->makeCurrent();
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(0, 0, seen.width, seen.height, GL_DEPTH_COMPONENT, GL_FLOAT, marking->depth.data());
    }
}

void BendTool::brush() {
    const double radius = panel->brush() * view->devicePixelRatioF();
    session->mark(marking->strokeTo(mouseInWindow().head<2>(), radius, *session, seen), panel->tag());
    showOverlay();
    view->update();
}

void BendTool::endMarking() {
    const std::unique_ptr<BendMarking> ended = std::move(marking);
    if (!layer())
        return;
    if (ended->kind != BendMarking::Brush) {
        const std::vector<std::size_t> found = ended->inside(*session, seen);
        if (!found.empty())
            session->mark(found, panel->tag());
    }
    session->endMarks(panel->radius() * session->diagonal());
    if (panel->tag() >= 2)
        active = panel->tag();
    showOverlay();
    solve(true);
    refresh();
}

// --- what is shown ---

void BendTool::showVertices(bool full) {
    if (!layer())
        return;
    display->updateShape(full || display->showsFaces());
    if (session->isStretchShown())
        showOverlay();
    else
        overlay->move();
    isPainted = false;
}

/// Shows the marks, or the stretch.
void BendTool::showOverlay() {
    if (!layer())
        return;
    const std::vector<vcg::Color4b> color = session->overlay();
    if (color.empty())
        overlay->hide();
    else
        overlay->show(model->cm, color);
    view->update();
}

/// Shows the stretch as the panel says while one bends; while one marks, the marks are seen.
void BendTool::showStretch() {
    const bool wanted = panel->showsStretch() && panel->mode() == BendPanel::Bend;
    if (session->options.stretch == wanted)
        return;
    session->options.stretch = wanted;
    showOverlay();
}

void BendTool::draw() {
    isPainted = true;
    if (drag) {
        const double past = sinceDraw.isValid() ? double(sinceDraw.nsecsElapsed()) / 1e6 : 0;
        frame = frame > 0 ? 0.8 * frame + 0.2 * past : past; // of about the last five
        sinceDraw.start();
    }
    if (view && view->suspendedEditor != isSuspended) {
        isSuspended = view->suspendedEditor;
        QTimer::singleShot(0, this, [this] { refresh(); });
    }
    double place[16], projection[16];
    int port[4];
    glGetDoublev(GL_MODELVIEW_MATRIX, place);
    glGetDoublev(GL_PROJECTION_MATRIX, projection);
    glGetIntegerv(GL_VIEWPORT, port);
    seen.toClip = Eigen::Map<Eigen::Matrix4d>(projection) * Eigen::Map<Eigen::Matrix4d>(place);
    seen.fromClip = seen.toClip.inverse();
    seen.width = std::max(1, port[2]);
    seen.height = std::max(1, port[3]);
    if (isStepWanted)
        QTimer::singleShot(0, this, [this] {
            guarded([&] {
                if (isStepWanted)
                    step();
            });
        });
    if (layer()) {
        overlay->draw(model->cm);
        drawOverlay();
    } else if (!session && !isEnding && view)
        QTimer::singleShot(0, this, [this] {
            guarded([&] {
                if (session || isEnding || !view || !view->md() || !view->md()->mm())
                    return;
                const MeshModel &current = *view->md()->mm();
                if (current.cm.vn > 0 && current.id() != refused)
                    start(*view->md(), view);
            });
        });
}

void BendTool::drawOverlay() const {
    const bool isBending = panel && panel->mode() == BendPanel::Bend && !isSuspended;
    drawPoints(*session, drag.get(), isBending && !drag ? hovered : 0);
    if (!panel || isSuspended)
        return;
    if (const std::optional<Gizmo> shown = isBending ? gizmo() : std::nullopt)
        drawGizmo(seen, *shown, drag.get(), lit);
    if (panel->mode() == BendPanel::Brush) {
        const Eigen::Vector2d place =
            windowOf(marking ? mouse : QPointF(view->mapFromGlobal(QCursor::pos()))).head<2>();
        const double radius = panel->brush() * view->devicePixelRatioF();
        std::vector<Eigen::Vector2d> circle(40, place);
        for (std::size_t i = 0; i < circle.size(); ++i)
            circle[i] += radius * Eigen::Vector2d(std::cos(double(i) * 9 * degree), std::sin(double(i) * 9 * degree));
        drawOutline(seen, circle);
    } else if (marking) {
        drawOutline(seen, marking->outline());
    }
}

#include "moc_bend_tool.cpp" // NOLINT(bugprone-suspicious-include)
