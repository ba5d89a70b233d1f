// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/bend_tool.h"

#include "edit_fcd/bend/model/guide_line.h"
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/view/pointing.h"

#include <layer_fcd/layer_labels.h>

#include <QCursor>

// What the tool shows in view and panel.

/// Shows the stretch if the panel says so; while marking, shows marks.
void BendTool::showStretch() {
    const bool wanted = panel->showsStretch() && panel->isBending();
    if (session->edit().options.stretch == wanted)
        return;
    session->edit().options.stretch = wanted;
    showOverlay();
}

void BendTool::draw() {
    if (going)
        going->beforeDraw();
    beginDraw();
    if (wasHidden != isHidden()) {
        wasHidden = !wasHidden;
        later([this] {
            hint.clear();
            forgetForeseen();
            refresh();
        });
    }
    if (wasHidden)
        return;
    if (layer()) {
        if (moving && !moving->draw(seen)) { // there is none while it is prepared
            moving.reset();
            showVertices(false);
        }
        if (!moving)
            overlay->draw(model->cm);
        if (onionSkin)
            onionSkin->draw(model->cm);
        if (!preparing)
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

bool BendTool::isHidden() const { return layer() && !model->isVisible(); }

std::string BendTool::hiddenText() const {
    return "The layer " + inQuotes(*model) + " is hidden: its eye in the list of layers shows it.";
}

void BendTool::expectSeen() const {
    if (isHidden())
        throw vcg::fcd::Error(hiddenText());
}

void BendTool::drawOverlay() const {
    const BendDrag *drag = this->drag();
    const bool isBending = panel && panel->isBending() && !isSuspended && !(going && going->isEndedByAll());
    if (going && panel && !isSuspended)
        going->draw();
    drawPoints(*session, isBending && !drag ? hovered : 0);
    if (!panel || isSuspended)
        return;
    if (panel->mode() == BendPanel::Line)
        drawLine(panel->line().lineLayer() < 0 ? lineOf(*session) : Eigen::Matrix3Xd(3, 0),
                 linePreview ? linePreview->last().path : Eigen::Matrix3Xd(3, 0));
    if (const std::optional<Gizmo> shown = isBending ? gizmo() : std::nullopt)
        drawGizmo(seen, *shown, drag, lit);
    if (isBending && !drag)
        for (const Eigen::Vector3d &place : foreseenPivots)
            drawPivot(place);
    if (panel->mode() == BendPanel::Brush) {
        const QPointF at = going ? mouse : QPointF(view->mapFromGlobal(QCursor::pos()));
        const Eigen::Vector2d place = windowOf(*view, seen, at).head<2>();
        drawBrush(seen, place, panel->brush() * view->devicePixelRatioF());
    }
}

// --- texts of the panel ---

/// What a mark makes of the surface.
QString BendTool::roleText() const {
    const int tag = tagToMark();
    return tag >= 2 ? nameOf(tag) : tag == 1 ? "free" : tag == 0 ? "fixed" : "ignored";
}

/// How to mark in this mode.
QString BendTool::markingText() const {
    const QString role = roleText(), what = panel->isThrough() ? "all in it, hidden or not," : "all that you see in it";
    switch (panel->mode()) {
    case BendPanel::Rectangle: return QString("Drag a rectangle: %1 becomes %2.").arg(what, role);
    case BendPanel::Polyline:
        return QString("Click the corners of a polygon; Enter or a double click ends it: %1 becomes %2.")
            .arg(what, role);
    default: return QString("Paint over the surface: it becomes %1. The wheel sets the brush's size.").arg(role);
    }
}

/// What G, R and S would move. \pre there is a handle
QString BendTool::textOfKeys() const { return keysBegin ? "this point" : nameOf(keysTag ? keysTag : selected()); }

QString BendTool::stateText() const {
    if (isSuspended)
        return "Camera mode. Esc: back to bending.";
    if (going && going->isEndedByAll())
        return going->text();
    if (!hint.isEmpty())
        return hint;
    if (isHidden())
        return QString::fromStdString(hiddenText());
    if (panel->mode() == BendPanel::Line)
        return lineText();
    const BendDrag *drag = this->drag();
    QString text;
    const std::size_t inContact = session->contact().face.size();
    if (const QString doing = going ? going->text() : QString(); !doing.isEmpty())
        text = doing;
    else if (!panel->isBending())
        text = markingText();
    else if (isReading)
        text = "Reading the surface: in a moment you see what a drag moves.";
    else if (session->model().influence.handles().empty() && !isLimbForeseen)
        text = session->state().marks
                   ? "Drag a point: all that is not fixed bends. Or mark a handle (red), and drag that."
                   : "Drag a point of the surface, or mark what stays (F) and what moves (H).";
    else if (lit && !(isLimbForeseen && lit->axis < 0))
        text = nameOf(selected()) +
               (lit->axis < 0
                    ? QString(": drag moves it in the view")
                    : QString(lit->kind == BendDrag::Turn ? ": drag turns it about %1" : ": drag moves it along %1")
                          .arg("xyz"[lit->axis])) +
               (lit->axis < 0 ? QString() : ". G, R, S: " + textOfKeys() + ".");
    else if (isLimbForeseen)
        text = "Drag this: its limb turns so that it follows. G pulls it alone.";
    else if (hovered)
        text = nameOf(hovered) + ": drag it, or press G, R or S.";
    else if (keysBegin)
        text = "Drag this point, or press G, R, S, or J: that turns the limb.";
    else
        text = "Drag a handle (red), or a point of the surface. G, R, S: " + textOfKeys() + ".";
    if (drag && !drag->carried.empty())
        text += "\nHandles farther out go along, except locked ones.";
    if (drag && lacksTwin(session->model(), drag->tag))
        text += "\nSymmetry finds nothing on the other side: this side moves alone.";
    if (drag && isKeptApart(session->model(), drag->tag))
        text += "\nParts that other handles bend stay; the wheel includes them.";
    else if (session->model().influence.isLocal)
        text += "\nParts beyond the reach stay.";
    if (inContact > 0 && !drag)
        text += QString("\n%1 triangles pass through others%2.")
                    .arg(inContact)
                    .arg(colors->isStretch(*session) ? ", shown in magenta" : "");
    return text;
}

QString BendTool::figuresText() const {
    if (session->nodes() == 0 || milliseconds <= 0)
        return {};
    return QString("%1 nodes, %2 ms a step").arg(session->nodes()).arg(milliseconds, 0, 'f', 1) +
           (frame > 0 ? QString(", drawn %1/s").arg(1000 / frame, 0, 'f', frame > 200 ? 1 : 0) : QString());
}

void BendTool::refresh() {
    if (!panel || !session)
        return;
    if (preparing) {
        if (onionSkin)
            onionSkin->pause();
        panel->showState(
            preparing.cancelled()
                ? "Stopping ..."
                : QString("%1: %2 %. Esc or a right click stops that.").arg(preparingWhat).arg(preparing.percent()));
        return;
    }
    if (!session->model().influence.isHandle(hovered))
        hovered = 0; // it was undone or removed
    if (!session->model().influence.isHandle(keysTag))
        keysTag = 0;
    panel->setPose(int(session->edit().options.pose));
    panel->showMotions(QString::fromStdString(vcg::fcd::WriteMotionText(session->state().motion)));
    showHandles();
    showPoses();
    showLines();
    lookForLine();
    lookForGhosts();
    panel->showState(stateText());
    panel->showFigures(figuresText());
}

#include "edit_fcd/bend/tool/moc_bend_tool.cpp" // NOLINT(bugprone-suspicious-include)
