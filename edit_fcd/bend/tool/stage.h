// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_STAGE_H
#define FCD_BEND_STAGE_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/bend/panel/panel.h"
#include "edit_fcd/bend/tool/gizmo_drawing.h"
#include "edit_fcd/bend/tool/interaction.h"
#include "edit_fcd/bend/tool/mark_colors.h"
#include "edit_fcd/kit/job_runner.h"
#include "edit_fcd/kit/layer_tool.h"
#include "edit_fcd/kit/tool_window.h"
#include "edit_fcd/view/moving_part.h"

#include <functional>
#include <memory>
#include <optional>

#include <QElapsedTimer>
#include <QPointer>
#include <QTimer>

/// Vertices of a layer that is prepared in less than 0.2 s (two cores; 1.2 million take 0.5 s, and their surface
/// another second); with more, that is done beside the window.
const int preparedAtOnce = 200000;

/// A layer in a view while it is bent: how it is shown and solved, what the mouse points at, and the one interaction
/// that goes on. What begins when is the tool's.
class BendStage : public LayerTool {
  public:
    explicit BendStage(QAction *action);

    MeshModel *layer() const; ///< null when it is gone, or has become another mesh
    bool isReady() override = 0;
    /// Whether a press is for the layer, and not for the camera.
    bool isPlain(const QMouseEvent &event) const {
        return event.button() == Qt::LeftButton && event.modifiers() == Qt::NoModifier && !isCamera;
    }

    // --- what goes on ---

    /// \pre nothing does
    template <class Interaction, class... Arguments>
    Interaction &goOn(Arguments &&...arguments) {
        auto made = std::make_unique<Interaction>(*this, std::forward<Arguments>(arguments)...);
        Interaction &begun = *made;
        going = std::move(made);
        return begun;
    }
    void ended() { gone = std::move(going); } ///< which is in the midst of saying so
    const BendDrag *drag() const { return going ? going->drag() : nullptr; }

    /// Does work on the session: at once, or, with a large layer, beside the window. \param what the panel says
    /// meanwhile \param stopped called instead of \p done when it is cancelled, or fails; may be empty
    /// \param isLong with any layer
    void beside(const QString &what, const JobRunner::Work &work, std::function<void()> done,
                std::function<void()> stopped = {}, bool isLong = false);
    /// What is done beside the window is taken back.
    void stopPreparing();

    // --- what the mouse points at ---

    Eigen::Vector3d mouseInWindow() const { return windowOfMouse(); }
    void findMouse(); ///< keys, and the wheel, come without it
    /// In the world, none where there is nothing.
    std::optional<Eigen::Vector3d> pick() const;
    /// What is under the mouse: a handle, or else a vertex of the layer, which may go along with one.
    struct Place {
        int tag = 0; ///< 0: none
        std::optional<std::size_t> slot;
        std::optional<std::size_t> held; ///< the vertex there that the handle holds
    };
    Place placeAtMouse() const;
    std::optional<std::size_t> slotAtMouse() const; ///< none where there is nothing, or another layer
    /// Whether a press there turns the limb that it is on, if it is on one, and pulls nothing: in the mode Drag, where
    /// it is no other handle and nothing is marked as fixed.
    bool isForLimb(const Place &place) const;
    /// The part of the gizmo under the mouse, none where that is on the dot of another handle, which a ring may cross.
    std::optional<GizmoPart> partAtMouse() const;
    int selected() const;               ///< the handle that keys move where none is under the mouse, 0: there is none
    std::optional<Gizmo> gizmo() const; ///< of the selected handle
    Eigen::Matrix3d axesOf(int tag) const;

    // --- what is shown ---

    void solve(bool full);
    void comeToRest(); ///< what has moved step by step is solved to the end \pre there is a layer
    void showVertices(bool full) override;
    void showChanged();
    void showOverlay(); ///< the marks, or the stretch

    int tagToMark() const;      ///< what is marked next to a handle that was moved is another handle, at rest
    void takeNewHandle() const; ///< which the panel shows
    void takeMarks();           ///< what was marked is

    using LayerTool::display;
    using LayerTool::every;
    using LayerTool::isPainted;
    using LayerTool::isStepWanted;
    using LayerTool::model;
    using LayerTool::mouse;
    using LayerTool::overlay;
    using LayerTool::refresh;
    using LayerTool::requestStep;
    using LayerTool::seen;
    using LayerTool::view;
    QPointer<BendPanel> panel;
    std::unique_ptr<BendSession> session;
    std::unique_ptr<MovingPart> moving; ///< while something is dragged, and the host does not draw the layer
    std::unique_ptr<MarkColors> colors;
    int active = 0;         ///< the handle that was chosen last, if it is still there
    bool isChosen = false;  ///< it was clicked, or in the list: keys move it wherever the mouse is
    bool isLive = false;    ///< the layer has a shape between two full solves
    bool isClicked = false; ///< what was begun last is a new handle, which was not moved
    double frame = 0;       ///< milliseconds from one drawing to the next, of the last ones while dragged; 0: none yet
    QElapsedTimer sinceEvent;
    double millisecondsSinceEvent() const { return sinceEvent.isValid() ? double(sinceEvent.nsecsElapsed()) / 1e6 : 0; }

  protected:
    void showHint() override;
    void step() override;

    std::unique_ptr<BendInteraction> going;
    JobRunner preparing{this}; ///< while it runs, nothing else touches the session
    QString preparingWhat;
    bool isShownChanged = false; ///< the list of layers shows that the layer was changed
    bool isContactTold = false;  ///< the log has told of the contact that there is
    double milliseconds = 0;     ///< of the last step

  private:
    int pointAt(const Eigen::Vector2d &window, double least = 12) const;
    void lookForContact();
    void whenDone();
    void restFromPreparing();

    std::unique_ptr<BendInteraction> gone; ///< the last one, until the next has ended
    std::function<void()> whenPrepared, whenStopped;
    QTimer preparingTimer; ///< to say how far that is
    QTimer restingTimer;   ///< since the last full pose
};

#endif
