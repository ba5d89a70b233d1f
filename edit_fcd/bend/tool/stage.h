// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_STAGE_H
#define FCD_BEND_STAGE_H

#include "edit_fcd/bend/model/session.h" // before Qt
#include "edit_fcd/bend/tool/drag.h"     // before Qt
#include "edit_fcd/bend/panel/panel.h"
#include "edit_fcd/bend/tool/gizmo_drawing.h"
#include "edit_fcd/bend/tool/mark_colors.h"
#include "edit_fcd/kit/job_runner.h"
#include "edit_fcd/kit/layer_tool.h"
#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/moving_part.h"

#include <functional>
#include <memory>
#include <optional>

#include <QElapsedTimer>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPointer>
#include <QTimer>

class BendStage;

/// Gets mouse and keys while something goes on in the view: a drag, a marking, a move of a line's point, playing or
/// scrubbing key frames. At most one goes on. The stage owns it. It calls BendStage::ended() as its last action.
class BendInteraction {
  public:
    explicit BendInteraction(BendStage &stage) : stage(stage) {}
    BendInteraction(const BendInteraction &) = delete;
    BendInteraction &operator=(const BendInteraction &) = delete;
    virtual ~BendInteraction() = default;

    /// Takes back what was begun and has not ended. \pre there is a layer
    virtual void cancel() = 0;
    virtual void move(QMouseEvent &event) = 0;
    virtual void release() {}
    /// Each returns whether the event was for this.
    virtual bool press(QMouseEvent &) { return false; }
    virtual bool pressKey(QKeyEvent &) { return false; }
    virtual bool doubleClick() { return false; } ///< or Enter
    virtual bool turnWheel(double) { return false; }
    virtual bool takesAllKeys() const { return false; }
    virtual bool isCancelledByEsc() const { return takesAllKeys(); }
    /// Whether any other action ends this first.
    virtual bool isEndedByAll() const { return false; }
    /// Whether the panel's commands are refused until it has ended.
    virtual bool holdsPanel() const { return false; }
    /// The drag of a handle, or null.
    virtual const BendDrag *drag() const { return nullptr; }
    virtual void step() {} ///< once for each painted frame
    virtual void beforeDraw() {}
    virtual void draw() const {}
    /// A text for the panel; empty: the mode's text.
    virtual QString text() const { return {}; }

  protected:
    BendStage &stage;
};

/// Layers of up to so many vertices are prepared at once, in less than 0.2 s (two cores; 1.2 million take 0.5 s, and
/// their surface another second). Larger ones are prepared in the background.
const int preparedAtOnce = 200000;

/// A layer in a view while it is bent: shows and solves it, finds what the mouse points at, and owns the one
/// interaction that goes on. BendTool decides what begins.
class BendStage : public LayerTool {
  public:
    explicit BendStage(QAction *action);

    MeshModel *layer() const; ///< null if it is gone, or has become another mesh
    bool isReady() override = 0;
    /// Whether a press is for the layer, and not for the camera.
    bool isPlain(const QMouseEvent &event) const {
        return event.button() == Qt::LeftButton && event.modifiers() == Qt::NoModifier && !isCamera;
    }

    // --- the interaction ---

    /// Begins an interaction. \pre none goes on
    template <class Interaction, class... Arguments>
    Interaction &goOn(Arguments &&...arguments) {
        auto made = std::make_unique<Interaction>(*this, std::forward<Arguments>(arguments)...);
        Interaction &begun = *made;
        going = std::move(made);
        return begun;
    }
    void ended() { gone = std::move(going); } ///< keeps it alive: it is the caller
    const BendDrag *drag() const { return going ? going->drag() : nullptr; }

    /// Does work on the session: at once, or, for a large layer, in the background. \param what text meanwhile \param
    /// stopped called, if not empty, instead of \p done after cancel or failure \param isLong never at once
    void beside(const QString &what, const JobRunner::Work &work, std::function<void()> done,
                std::function<void()> stopped = {}, bool isLong = false);
    /// Stops the work in the background, and takes it back.
    void stopPreparing();

    // --- what the mouse points at ---

    Eigen::Vector3d mouseInWindow() const { return windowOfMouse(); }
    void findMouse(); ///< for keys and the wheel, whose events lack its place
    /// The point under the mouse, world; none if there is nothing.
    std::optional<Eigen::Vector3d> pick() const;
    /// What is under the mouse: a handle, or else a vertex of the layer, which may move along with one.
    struct Place {
        int tag = 0; ///< 0: none
        std::optional<std::size_t> slot;
        std::optional<std::size_t> held; ///< vertex there that the handle holds
    };
    Place placeAtMouse() const;
    std::optional<std::size_t> slotAtMouse() const; ///< vertex; none if there is nothing, or another layer
    /// Whether a press turns the limb there: in the mode Drag, on no handle without a limb, and if nothing is fixed.
    bool isForLimb(const Place &place) const;
    /// The part of the gizmo under the mouse; none on the dot of another handle, which a ring may cross.
    std::optional<GizmoPart> partAtMouse() const;
    QString nameOf(int tag) const;      ///< of a handle
    int selected() const;               ///< handle that keys move if none is under the mouse; 0: none
    std::optional<Gizmo> gizmo() const; ///< of the selected handle
    Eigen::Matrix3d axesOf(int tag) const;

    // --- what is shown ---

    void solve(bool full);
    void comeToRest(); ///< makes a full solve after steps \pre there is a layer
    void showVertices(bool full) override;
    void showChanged();
    void showOverlay(); ///< marks or stretch

    int tagToMark() const;      ///< the panel's tag; an unused one if that handle was moved
    void takeNewHandle() const; ///< shows tagToMark() in the panel
    void takeMarks();           ///< ends a marking

    using LayerTool::display, LayerTool::every, LayerTool::isPainted, LayerTool::isStepWanted, LayerTool::model,
        LayerTool::mouse, LayerTool::overlay, LayerTool::refresh, LayerTool::refreshAll, LayerTool::requestStep,
        LayerTool::seen, LayerTool::view;
    QPointer<BendPanel> panel;
    std::unique_ptr<BendSession> session;
    std::unique_ptr<MovingPart> moving; ///< while it draws the layer instead of the host
    std::unique_ptr<MarkColors> colors;
    int active = 0;         ///< the handle chosen last; may be gone
    bool isChosen = false;  ///< it was clicked, in view or list: keys move it, wherever the mouse is
    bool isLive = false;    ///< the shape is from steps; a full solve must follow
    bool isClicked = false; ///< the last drag made a new handle, and did not move it
    double frame = 0;       ///< mean milliseconds between drawings of a drag; 0: none yet
    QElapsedTimer sinceEvent;
    double millisecondsSinceEvent() const { return sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0; }

  protected:
    ToolPanel *toolPanel() const override { return panel.data(); }
    void step() override;

    std::unique_ptr<BendInteraction> going;
    JobRunner preparing{this}; ///< nothing else may touch the session while it runs
    QString preparingWhat;
    bool isShownChanged = false; ///< the list of layers shows the layer as changed
    bool isContactTold = false;  ///< the present contact is in the log
    double milliseconds = 0;     ///< of the last step

  private:
    int pointAt(const Eigen::Vector2d &window, double least = 12) const;
    void lookForContact();
    void whenDone();
    void restFromPreparing();

    std::unique_ptr<BendInteraction> gone; ///< the last one, until the next one ends
    std::function<void()> whenPrepared, whenStopped;
    QTimer preparingTimer; ///< shows the progress
    QTimer restingTimer;   ///< runs since the last full solve
};

#endif
