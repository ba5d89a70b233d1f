// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TOOL_H
#define FCD_BEND_TOOL_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/bend/tool/drag.h"
#include "edit_fcd/bend/panel/actions.h"
#include "edit_fcd/bend/tool/mark_colors.h"
#include "edit_fcd/bend/tool/line_preview.h"
#include "edit_fcd/bend/tool/mark_interaction.h"
#include "edit_fcd/view/moving_part.h"
#include "edit_fcd/bend/tool/gizmo_drawing.h"
#include "edit_fcd/bend/panel/panel.h"
#include "edit_fcd/kit/job.h"
#include "edit_fcd/kit/layer_tool.h"
#include "edit_fcd/kit/tool_window.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <QElapsedTimer>
#include <QPointF>
#include <QPointer>
#include <QTimer>

/// Vertices of a layer that is prepared in less than 0.2 s (two cores; 1.2 million take 0.5 s, and their surface
/// another second); with more, that is done beside the window.
const int preparedAtOnce = 200000;

/// FCD: Bend: turns mouse and keys in a view (bend_events.cpp), and what the panel is told (bend_commands.cpp), into
/// marks and motions of a BendSession, and shows it.
class BendTool : public LayerTool {
    Q_OBJECT

  public:
    using LayerTool::LayerTool;

    bool start(MeshDocument &document, GLArea *view) override;
    void changeLayer(MeshDocument &document, GLArea *view) override;
    void draw() override;
    void press(QMouseEvent *event) override;
    void move(QMouseEvent *event) override;
    void release(QMouseEvent *event) override;
    void turnWheel(QWheelEvent *event) override;
    void pressKey(QKeyEvent *event) override;
    void say(const std::string &text, bool warning = false) override;

  private:
    bool takesEvent(QEvent &event) override;
    MeshModel *layer() const; ///< null when it is gone, or has become another mesh
    void open(MeshModel &model);
    void close() override;
    void leave();
    void keepShown();
    void forgetLayers();
    bool isReady();
    void makePanel();
    void takeOptions();
    void showOptions();
    void onOptions();
    void setMode(BendPanel::Mode mode);
    void onCommand(int which);
    void connectHandles();
    void showHandles();
    void connectPoses();
    void changePoses(const std::function<void()> &change);
    void renamePose(std::size_t number, const std::string &name);
    void showBlend(const std::vector<double> &weights);
    void onPoseCommand(int which);
    void showPoses();
    void play();
    void stopPlaying();
    void playFrame();
    void comeToRest();

    void onLineCommand(int which);
    void showLines();
    QString lineText() const;
    std::optional<std::size_t> linePointAt(const Eigen::Vector2d &window) const;
    bool pressLine();
    void dragLinePoint();
    void removeLinePoint();
    void lookForLine();
    void straighten();

    void editHandle(const BendHandleRow &to);
    QString roleText() const;
    QString markingText() const;
    QString stateText() const;
    void beginApply();
    void refresh();

    Eigen::Vector3d windowOf(const QPointF &place) const;
    Eigen::Vector3d mouseInWindow() const { return windowOf(mouse); }
    /// What the mouse points at in the world, none where there is nothing.
    std::optional<Eigen::Vector3d> pick() const;
    void toCamera(QMouseEvent *event);
    void doubleClick(QMouseEvent *event);
    bool isForLayer(QMouseEvent *event);
    void pressKeyWhileDragging(QKeyEvent *event);
    void dragByKey(BendDrag::Kind kind);
    void placePivot();
    const ActionTable::Row *keyOf(const QKeyEvent &event) const;
    void act(BendAction::Id action);
    void setRole(BendPanel::Role which, int handle = 2);
    bool grab();
    int pointAt(const Eigen::Vector2d &window, double least = 12) const;
    std::optional<GizmoPart> partAtMouse() const;
    std::optional<std::size_t> slotAtMouse() const;
    /// What is under the mouse: a handle, or else a vertex of the layer, which may go along with one.
    struct Place {
        int tag = 0; ///< 0: none
        std::optional<std::size_t> slot;
    };
    Place placeAtMouse() const;
    bool beginsByKey(const Place &place) const;
    bool changeRim(double times);
    void findMouse();
    void hover();

    int selected() const;
    std::optional<Gizmo> gizmo() const;
    Eigen::Matrix3d axesOf(int tag) const;
    /// What is going to be dragged, once the layer is prepared for it.
    struct Grip {
        int tag = 0;          ///< of a handle, or
        std::size_t slot = 0; ///< of a vertex that becomes one, where \p tag is 0
        GizmoPart part;
        bool modal = false;
        bool isNew = false; ///< what is at \p tag was made of \p slot
    };
    void beginDrag(const Grip &grip);
    void dragWhenPrepared();
    void beside(const QString &what, const Job::Work &work, std::function<void()> done,
                std::function<void()> stopped = {});
    void whenDone();
    void restFromPreparing();
    void stopPreparing();
    void changeKind(BendDrag::Kind kind);
    void endDrag(bool keep);
    void requestStep();
    void step();
    void solve(bool full);

    int tagToMark() const;
    void takeNewHandle();
    void trackMouse();
    void beginMarking(BendMarking::Kind kind);
    void brush();
    void endMarking();

    void showVertices(bool full) override;
    void showChanged();
    void showOverlay();
    void showStretch();
    void drawOverlay() const;

    QPointer<BendPanel> panel;
    int refused = -1; ///< a layer that cannot be bent
    std::unique_ptr<BendSession> session;
    std::map<int, std::unique_ptr<BendSession>> left; ///< of other layers of the document, by their number
    BendOptions usual;                                ///< what the next layer begins with: as the last one had it
    std::optional<std::pair<int, double>> usualSizes; ///< of brush and point, as the panel has them
    QPointer<MeshDocument> document;
    Camera seen;
    std::unique_ptr<BendDrag> drag;
    std::unique_ptr<MovingPart> moving; ///< while something is dragged, and the host does not draw the layer
    Grip grip;                          ///< of what is dragged
    Eigen::Vector3d gripped;            ///< where the mouse was then, window
    double tookToPrepare = 0;           ///< milliseconds
    bool isReleased = false;            ///< the button, before the layer was prepared
    bool isClicked = false;             ///< what was begun last is a new handle, which was not moved
    std::unique_ptr<Job> preparing;     ///< while it is there, nothing else touches the session
    QString preparingWhat;
    std::function<void()> whenPrepared, whenStopped;
    std::size_t preparingNumber = 0; ///< of the last
    QTimer preparingTimer;           ///< to say how far that is
    std::unique_ptr<MarkColors> colors;
    std::unique_ptr<BendMarking> marking;
    std::optional<std::size_t> linePoint;         ///< that is dragged
    std::unique_ptr<BendLinePreview> linePreview; ///< while a line is given
    QTimer playing;                               ///< of the next frame of the animation, while it is played
    QElapsedTimer sincePlay;
    double playLength = 0; ///< seconds
    QPointF mouse;
    int active = 0;               ///< the handle that was chosen last, if it is still there
    bool isChosen = false;        ///< it was clicked, or in the list: keys move it wherever the mouse is
    int hovered = 0;              ///< the handle under the mouse, 0: none
    bool keysBegin = false;       ///< beginsByKey() what is under the mouse
    std::optional<GizmoPart> lit; ///< the part of the gizmo under the mouse
    QString hint;                 ///< what could not be done, until the next press or key
    bool isSuspended = false;     ///< the mouse is the camera's
    bool isCamera = false;
    unsigned long escaped = 0;   ///< when Esc has given the mouse to the camera last, by the clock of the window system
    bool isLive = false;         ///< the layer has a shape between two full solves
    bool isShownChanged = false; ///< the list of layers shows that the layer was changed
    bool isPainted = true, isStepWanted = false;
    QElapsedTimer sinceEvent, sinceRim;
    double milliseconds = 0; ///< of the last step
    QElapsedTimer sinceDraw;
    double frame =
        0; ///< milliseconds from one drawing to the next, of the last ones while something is dragged; 0: none yet
};

#endif
