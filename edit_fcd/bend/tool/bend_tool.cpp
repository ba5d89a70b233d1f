// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/guide_line.h"

#include <cmath>

#include <QCursor>

void BendTool::say(const std::string &text, bool warning) {
    if (!view)
        return;
    view->Log(warning ? GLLogStream::WARNING : GLLogStream::FILTER, ("FCD: Bend: " + plainForLog(text)).c_str());
    if (panel && warning) {
        hint = QString::fromStdString(text); // until the next press or key
        panel->showState(hint);
    }
}

// --- marks ---

/// What is marked next to a handle that was moved is another handle, at rest.
int BendTool::tagToMark() const {
    return panel->tag() >= 2 && session->state().motion.count(panel->tag()) ? session->model().influence.unusedTag()
                                                                            : panel->tag();
}

void BendTool::takeNewHandle() {
    if (const int tag = tagToMark(); tag != panel->tag())
        panel->setRole(BendPanel::Handle, tag);
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

/// The layer is not what its file has: the list of layers says so. (The host says it of any layer that is edited, when
/// it writes that list anew.)
void BendTool::showChanged() {
    if (isShownChanged && model->meshModified())
        return;
    model->setMeshModified();
    host::showLayers(*view);
    isShownChanged = true;
}

/// Shows the marks, or the stretch.
void BendTool::showOverlay() {
    if (!layer())
        return;
    const std::vector<vcg::Color4b> color = colors->of(*session);
    if (color.empty())
        overlay->hide();
    else
        overlay->show(model->cm, color);
    view->update();
}

/// Shows the stretch as the panel says while one bends; while one marks, the marks are seen.
void BendTool::showStretch() {
    const bool wanted = panel->showsStretch() && panel->mode() == BendPanel::Bend;
    if (session->edit().options.stretch == wanted)
        return;
    session->edit().options.stretch = wanted;
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
        later([this] { refresh(); });
    }
    seen = viewNow();
    if (isStepWanted)
        later([this] {
            if (isStepWanted)
                step();
        });
    if (preparing) {
        if (layer())
            overlay->draw(model->cm);
    } else if (layer()) {
        if (moving && !moving->draw(seen)) {
            moving.reset();
            showVertices(false);
        }
        if (!moving)
            overlay->draw(model->cm);
        drawOverlay();
    } else if (!session && !isEnding && view)
        later([this] {
            if (session || isEnding || !view || !view->md() || !view->md()->mm())
                return;
            const MeshModel &current = *view->md()->mm();
            if (current.cm.vn > 0 && current.id() != refused)
                start(*view->md(), view);
        });
}

void BendTool::drawOverlay() const {
    const bool isBending = panel && panel->mode() == BendPanel::Bend && !isSuspended && !playing.isActive();
    drawPoints(*session, drag.get(), isBending && !drag ? hovered : 0);
    if (!panel || isSuspended)
        return;
    if (panel->mode() == BendPanel::Line)
        drawLine(panel->line().lineLayer() < 0 ? lineOf(*session) : Eigen::Matrix3Xd(3, 0),
                 linePreview ? linePreview->last().way : Eigen::Matrix3Xd(3, 0));
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

#include "edit_fcd/bend/tool/moc_bend_tool.cpp" // NOLINT(bugprone-suspicious-include)
