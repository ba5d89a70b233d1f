// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/tool/stage.h"
#include "edit_fcd/view/trace.h"

#include <QCursor>

// Solves and shows the layer, also in the background.

// Milliseconds: longer than between two values of a dragged slider, and too short to wait for.
const int restBeforeContact = 200;

BendStage::BendStage(QAction *action) : LayerTool(action) {
    every(preparingTimer, [this] { refresh(); });
    restingTimer.setSingleShot(true);
    every(restingTimer, [this] { lookForContact(); });
}

MeshModel *BendStage::layer() const {
    MeshModel *found = session ? presentLayer() : nullptr;
    return found && session->fits() ? found : nullptr;
}

void BendStage::step() {
    if (going)
        going->step();
}

int BendStage::tagToMark() const {
    return panel->tag() >= 2 && session->state().motion.count(panel->tag()) ? session->model().influence.unusedTag()
                                                                            : panel->tag();
}

void BendStage::takeNewHandle() const {
    if (const int tag = tagToMark(); tag != panel->tag())
        panel->setRole(BendPanel::Handle, tag);
}

void BendStage::takeMarks() {
    session->endMarks(panel->radius() * session->diagonal());
    if (panel->tag() >= 2)
        active = panel->tag();
    showOverlay();
    solve(true);
}

// --- what is shown ---

void BendStage::showVertices(bool full) {
    if (!layer())
        return;
    isPainted = false;
    if (moving) {
        moving->move(session->tags());
        if (!full) {
            view->update();
            return;
        }
    }
    display->updateShape(full || display->showsFaces());
    if (colors->isStretch(*session))
        showOverlay();
    else
        overlay->move();
}

/// Shows in the list of layers that the layer has changed. (The host's own updates show that of any edited layer.)
void BendStage::showChanged() {
    if (isShownChanged && model->meshModified())
        return;
    model->setMeshModified();
    host::showLayers(*view);
    isShownChanged = true;
}

/// Looks for contact at rest, once nothing goes on, and shows it in panel, stretch and, the first time, the log.
void BendStage::lookForContact() {
    if (!layer() || isLive)
        return;
    if (going || preparing) {
        restingTimer.start();
        return;
    }
    const vcg::fcd::Stopwatch watch;
    session->findContact();
    const std::string contact = session->contact().Text();
    trace("contact: %d triangles, %.1f ms", int(session->contact().face.size()), 1000 * watch.Seconds());
    if (!contact.empty() && !isContactTold)
        say(contact); // the panel shows it anyway
    isContactTold = !contact.empty();
    if (contact.empty())
        return;
    if (colors->isStretch(*session))
        showOverlay();
    refresh();
}

void BendStage::showOverlay() {
    if (!layer())
        return;
    if (std::optional<MarkColors::Tint> tint = colors->tint(*session)) {
        overlay->show(model->cm, std::move(tint->slot), std::move(tint->color), std::move(tint->element));
    } else {
        const std::vector<vcg::Color4b> color = colors->of(*session);
        if (color.empty())
            overlay->hide();
        else
            overlay->show(model->cm, color);
    }
    view->update();
}

void BendStage::comeToRest() {
    display->rest();
    solve(true);
    refreshAll();
}

void BendStage::solve(bool full) {
    restingTimer.stop();
    const vcg::fcd::Stopwatch watch;
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
    if (full && isMoved(session->model()))
        showChanged();
    if (full)
        restingTimer.start(restBeforeContact);
    const double solved = 1000 * watch.Seconds();
    showVertices(full);
    const double took = 1000 * watch.Seconds();
    if (!full)
        milliseconds = took;
    trace("%s: %d vertices, %d nodes, prepare %.1f, solve %.1f, write %.1f, buffers %.1f, in all %.1f, since the event "
          "%.1f ms",
          full ? "full" : "drag", model->cm.vn, session->nodes(), times.prepare, times.solve, times.write,
          took - solved, took, millisecondsSinceEvent());
}

// --- in the background ---

void BendStage::beside(const QString &what, const JobRunner::Work &work, std::function<void()> done,
                       std::function<void()> stopped, bool isLong) {
    preparingWhat = what;
    whenPrepared = std::move(done);
    whenStopped = std::move(stopped);
    session->beginBeside();
    if (!isLong && model->cm.vn <= preparedAtOnce) {
        try {
            work({});
        } catch (...) {
            stopPreparing();
            throw;
        }
        whenDone();
        return;
    }
    preparing.begin(work, [this](const std::exception_ptr &thrown) {
        restFromPreparing();
        guarded([&] {
            if (!thrown && (!layer() || session->isUpToDate())) {
                whenDone();
                return;
            }
            stopPreparing(); // keep the change by something else
            if (!thrown)
                throw vcg::fcd::Error("Nothing was done: something else has changed the layer meanwhile. Begin again.");
            try {
                std::rethrow_exception(thrown);
            } catch (const vcg::fcd::Cancelled &) { // the user cancelled it
            }
        });
    });
    view->setCursor(Qt::BusyCursor);
    preparingTimer.start(100);
    refresh();
    trace("answer: %d vertices, since the event %.1f ms", model->cm.vn, millisecondsSinceEvent());
}

void BendStage::whenDone() {
    if (!layer()) {
        if (going)
            going->cancel();
        return;
    }
    session->endBeside();
    const std::function<void()> done = std::move(whenPrepared); // it may begin other work
    done();
}

/// Removes the signs of work in the background.
void BendStage::restFromPreparing() {
    preparingTimer.stop();
    if (view)
        view->unsetCursor();
}

void BendStage::stopPreparing() {
    if (preparing) {
        preparing.stop(); // waits for it
        restFromPreparing();
    }
    const std::function<void()> stopped = std::move(whenStopped);
    if (!layer())
        return;
    session->endBeside();
    if (stopped)
        stopped();
    refreshAll();
}

// --- what the mouse points at ---

std::optional<Eigen::Vector3d> BendStage::pick() const {
    Eigen::Vector3d window = mouseInWindow();
    float depth = 1;
    view->makeCurrent();
    glReadPixels(int(window[0]), int(window[1]), 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    if (!(depth < 1))
        return {};
    window[2] = depth;
    return seen.toWorld(window);
}

void BendStage::findMouse() { mouse = view->mapFromGlobal(QCursor::pos()); }

/// The point handle at a place of the window, 0: none. \param least largest distance, pixels
int BendStage::pointAt(const Eigen::Vector2d &window, double least) const {
    int tag = 0;
    for (const auto &point : session->state().points) {
        const double d = (seen.toWindow(dotOf(session->model(), point.first)).head<2>() - window).norm();
        if (d < least && !handleOf(session->state(), point.first).isHidden) {
            least = d;
            tag = point.first;
        }
    }
    return tag;
}

std::optional<std::size_t> BendStage::slotAtMouse() const {
    const std::optional<Eigen::Vector3d> place = pick();
    double distance = 0;
    const std::optional<std::size_t> slot = place ? session->nearest(*place, distance) : std::nullopt;
    return slot && distance <= 0.02 * session->diagonal() ? slot : std::nullopt;
}

BendStage::Place BendStage::placeAtMouse() const {
    if (const int point = pointAt(mouseInWindow().head<2>()))
        return {point, {}, {}};
    const std::optional<std::size_t> slot = slotAtMouse();
    if (!slot)
        return {};
    const int tag = session->tags()[*slot];
    return tag >= 2 && !isAlong(session->model(), *slot) ? Place{tag, {}, slot} : Place{0, slot, {}};
}

bool BendStage::isForLimb(const Place &place) const {
    const BendModel &model = session->model();
    const bool isLocal = model.influence.isLocal || !session->state().marks; // else the fixed vertices bound what bends
    return panel->mode() == BendPanel::Drag && isLocal && (!place.tag || turnsLimb(model, place.tag));
}

std::optional<GizmoPart> BendStage::partAtMouse() const {
    const std::optional<Gizmo> shown = gizmo();
    const Eigen::Vector2d window = mouseInWindow().head<2>();
    const int point = shown ? pointAt(window, dotPixels / 2 + 1) : 0;
    return shown && (!point || point == selected()) ? gizmoAt(seen, *shown, window) : std::nullopt;
}

QString BendStage::nameOf(int tag) const { return QString::fromStdString(::nameOf(session->state(), tag)); }

int BendStage::selected() const {
    if (session->model().influence.isHandle(active))
        return active;
    const std::vector<int> handles = session->model().influence.handles();
    return handles.empty() ? 0 : handles.front();
}

Eigen::Matrix3d BendStage::axesOf(int tag) const {
    if (session->edit().options.axes != BendAxes::View)
        return ::axesOf(session->model(), tag);
    const Eigen::Vector3d at = pivotOf(session->model(), tag), window = seen.toWindow(at);
    Eigen::Matrix3d axes;
    axes.col(0) = (seen.toWorld({window[0] + 1, window[1], window[2]}) - at).normalized();
    axes.col(2) = seen.towardsEye(at);
    axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
    return axes;
}

std::optional<Gizmo> BendStage::gizmo() const {
    const BendDrag *dragged = drag();
    const int tag = dragged ? dragged->tag : selected();
    if (!tag || handleOf(session->state(), tag).isHidden || handleOf(session->state(), tag).isLocked)
        return {};
    return Gizmo{pivotOf(session->model(), tag), dragged ? dragged->axes : axesOf(tag)};
}
