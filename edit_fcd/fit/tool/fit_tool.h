// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_TOOL_H
#define FCD_FIT_TOOL_H

#include "edit_fcd/fit/model/session.h" // before Qt
#include "edit_fcd/view/camera.h"       // before Qt
#include "edit_fcd/fit/panel/panel.h"
#include "edit_fcd/kit/job_runner.h"
#include "edit_fcd/kit/layer_tool.h"
#include "edit_fcd/kit/tool_window.h"

#include <map>
#include <memory>
#include <optional>

#include <QPointF>
#include <QPointer>
#include <QTimer>

/// Which marks of pairs are drawn.
struct FitMarks {
    bool showsSource = true, showsTarget = true;
    int selected = -1; ///< pair, -1: none
};

/// One end of a pair.
struct FitEnd {
    std::size_t pair = 0;
    bool isTarget = false;
};

/// The end of a pair at a place of the window; of two ends, that on the target.
std::optional<FitEnd> endAt(const FitSession &session, const FitMarks &marks, const Camera &view,
                            const Eigen::Vector2d &window);

/// Draws the curves over all else, in the colours of the pairs. Draw the pairs afterwards.
void drawCurves(const FitSession &session, const FitMarks &marks);

/// Draws the pairs over all else: ends on the layer blue, ends on the target orange, and lines between.
void drawPairs(const FitSession &session, const FitMarks &marks);

/// The tool FCD: Fit. Turns mouse, keys and panel into pairs and shape of a FitSession, and shows it.
class FitTool : public LayerTool {
    Q_OBJECT

  public:
    explicit FitTool(QAction *action);

    bool start(MeshDocument &document, GLArea *view) override;
    void changeLayer(MeshDocument &document, GLArea *view) override;
    void draw() override;
    void press(QMouseEvent *event) override;
    void move(QMouseEvent *event) override;
    void release(QMouseEvent *event) override;
    void turnWheel(QWheelEvent *event) override;
    void pressKey(QKeyEvent *event) override;

  private:
    bool takesEvent(QEvent &event) override;
    void refresh() override;
    ToolPanel *toolPanel() const override { return panel.data(); }
    void forgetDocument() override { left.clear(); }
    void step() override;

    MeshModel *layer() const;  ///< null if it is gone, or has become another mesh
    MeshModel *target() const; ///< null if there is none
    MeshModel &expectedTarget() const;
    void open(MeshModel &model);
    void takeTarget(const MeshModel &fitted);
    void leave();
    void close() override;
    bool isReady() override;
    void keepShown() override;
    SessionContents takeSession(const QString &file) override;
    void makePanel();
    void showTargets();
    void onTarget();
    void onOptions();
    void apply(bool inPlace);
    void act(int action);
    void cancelPull();
    void setShape(FitShape shape);

    void chooseFiles(bool load);
    void setCurves(const std::string &file);
    void click();
    void showPairs();
    void dragTo();
    bool place(bool isTarget);
    bool isTurnOfTarget() const;

    bool isPainting() const { return panel && panel->brush() != FitPanel::Pairs; }
    void setBrush(FitPanel::Brush which);
    void takeBrush();
    MeshModel *layerAtMouse() const;
    bool beginStroke();
    void strokeTo();
    void endStroke();
    FitMarks marks() const;

    void reshape(bool full);
    void pullAsLeft();
    void follow(bool full);
    void whenPulled(const std::shared_ptr<const LayerFit> &fit, const std::shared_ptr<FittedSurface> &fitted);
    void begin(JobRunner::Work work, std::function<void()> done);
    void stopWork();

    void showVertices(bool full) override;
    void showColors();
    void showCarried(const MeshModel &on);
    void showLayers();
    void setSeen(FitPanel::Seen which);
    QString stateText() const;

    QPointer<FitPanel> panel;
    int targetId = -1;
    std::unique_ptr<FitSession> session;
    std::map<int, std::unique_ptr<FitSession>> left; ///< sessions of other layers, by their number
    std::map<int, bool> wasVisible;                  ///< of layers that the tool shows or hides, by their number

    QPointF pressed;
    std::optional<FitEnd> dragged;
    /// A stroke of the brush that paints weights.
    struct Stroke {
        int layer;                           ///< number
        float weight;                        ///< as in FitSession::paint
        std::vector<float> depth;            ///< from depthOf
        std::optional<Eigen::Vector2d> from; ///< the last place, pixels of the device
    };
    std::optional<Stroke> stroke;
    FitPanel::Brush lastBrush = FitPanel::Carried; ///< the last one that paints
    std::unique_ptr<LayerOverlay> targetOverlay;
    int selected = -1; ///< pair
    bool isClick = false;
    JobRunner work{this};
    bool isFollowWanted = false; ///< follow() once the layer is prepared
    QTimer progressTimer, optionsTimer;
};

#endif
