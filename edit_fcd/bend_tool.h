// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TOOL_H
#define FCD_BEND_TOOL_H

#include "bend_session.h" // before Qt

#include "bend_panel.h"
#include "edit_host.h"

#include <memory>
#include <optional>

#include <QElapsedTimer>
#include <QPointF>
#include <QPointer>
#include <QTimer>
#include <QVector>

/// How the world is seen: from world to window coordinates (pixels of the device, y up; depth 0 to 1) and back.
struct BendView {
    Eigen::Matrix4d toClip = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d fromClip = Eigen::Matrix4d::Identity();
    int width = 1, height = 1;

    Eigen::Vector3d toWindow(const Eigen::Vector3d &world) const; ///< behind the eye: a depth above 1
    Eigen::Vector3d toWorld(const Eigen::Vector3d &window) const;
    /// A world direction at \p at that leads to the eye, of length 1.
    Eigen::Vector3d towardsEye(const Eigen::Vector3d &at) const;
    /// How many world units a pixel is at \p at.
    double pixelAt(const Eigen::Vector3d &at) const;
};

/// FCD: Bend: turns mouse and keys in a view into marks and motions of a BendSession, and shows it.
class BendTool : public HostEditTool {
    Q_OBJECT

  public:
    explicit BendTool(QAction *action) : action(action) {}

    bool start(MeshDocument &document, GLArea *view) override;
    void end() override;
    void changeLayer(MeshDocument &document, GLArea *view) override;
    void draw() override;
    void press(QMouseEvent *event) override;
    void move(QMouseEvent *event) override;
    void release(QMouseEvent *event) override;
    void turnWheel(QWheelEvent *event) override;
    void pressKey(QKeyEvent *event) override;
    void say(const std::string &text, bool warning = false) override;

    /// Takes keys before the host's shortcuts do.
    bool eventFilter(QObject *object, QEvent *event) override;

  private:
    enum Kind { Move, Turn, Scale };
    /// A handle that is being moved.
    struct Drag {
        int tag = 0;
        Kind kind = Move;
        int axis = -1;               ///< -1: in the view plane, or about the direction of the view; 0, 1, 2: x, y, z
        bool modal = false;          ///< begun by a key: the mouse moves it without a button
        QString typed;               ///< a number
        Eigen::Vector3d pivot, from; ///< the handle's middle as it begins, and where the mouse was, window
        double angle = 0;            ///< that the mouse went about the pivot, degrees
        Eigen::Vector3d last;        ///< where the mouse was, window
        std::vector<vcg::fcd::MotionStep> begin;
    };
    /// What is being marked.
    struct Marking {
        QVector<QPointF> corners; ///< window; of a brush the last place
        std::vector<float> depth; ///< of the window, where only what is seen is marked
    };

    MeshModel *layer() const; ///< null when it is gone, or has become another mesh
    void open(MeshModel &model);
    void close();
    bool isReady();
    void makePanel();
    void onOptions();
    void onCommand(int which);

    Eigen::Vector3d windowOf(const QPointF &place) const;
    /// What the mouse points at in the world, none where there is nothing.
    std::optional<Eigen::Vector3d> pick(const QPointF &place) const;
    void toCamera(QMouseEvent *event);
    bool isForLayer(QMouseEvent *event);

    bool grab(QMouseEvent *event);
    void beginDrag(int tag, Kind kind, int axis, bool modal, const Eigen::Vector3d &from);
    std::optional<vcg::fcd::MotionStep> dragStep() const;
    void dragTo(const Eigen::Vector3d &window);
    void endDrag(bool keep);
    bool isGizmoHit(const Eigen::Vector3d &window, Kind &kind, int &axis) const;

    void beginMarking();
    void brushAt(const Eigen::Vector3d &window);
    void markPolygon();
    template <class IsIn>
    std::vector<std::size_t> verticesIn(const IsIn &isIn) const;

    void requestStep();
    void step();
    void solve(bool full);
    void showVertices(bool full);
    void showColors();
    void showLayer();
    void refresh();
    void drawOverlay() const;

    QAction *action;
    QPointer<GLArea> view;
    QPointer<BendPanel> panel;
    int layerId = -1;
    int refused = -1;           ///< a layer that cannot be bent
    MeshModel *model = nullptr; ///< of the session; may be gone
    std::unique_ptr<BendSession> session;
    MLRenderingData before; ///< what the layer was shown with
    bool isBare = false;    ///< without textures, which slow down what moves, and hide colours
    BendView seen;
    std::unique_ptr<Drag> drag;
    std::unique_ptr<Marking> marking;
    QPointF mouse;
    int active = 0; ///< the handle with the gizmo
    bool isCamera = false;
    bool isEnding = false; ///< done, and about to be told so
    bool isLive = false;   ///< the layer has a shape between two full solves
    bool isPainted = true, isStepWanted = false;
    QElapsedTimer sinceEvent;
    std::string lastTimes;
    double milliseconds = 0; ///< of the last step
};

#endif
