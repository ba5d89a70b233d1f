// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TOOL_H
#define FCD_BEND_TOOL_H

#include "edit_fcd/bend/tool/drag_interaction.h" // before Qt
#include "edit_fcd/bend/tool/previews.h"

#include "edit_fcd/bend/panel/panel.h"

#include <map>

/// The tool FCD: Bend: does what mouse (router.cpp), keys (key_events.cpp) and panel (the files of commands) ask for.
class BendTool : public BendStage {
    Q_OBJECT

  public:
    using BendStage::BendStage;

    bool start(MeshDocument &document, GLArea *view) override;
    void changeLayer(MeshDocument &document, GLArea *view) override;
    void end() override;
    void draw() override;
    void press(QMouseEvent *event) override;
    void move(QMouseEvent *event) override;
    void release(QMouseEvent *event) override;
    void turnWheel(QWheelEvent *event) override;
    void pressKey(QKeyEvent *event) override;

  private:
    bool takesEvent(QEvent &event) override;
    void close() override;
    void forgetDocument() override;
    bool isReady() override;
    void refresh() override;
    bool open(MeshModel &model);
    void leave();
    void keepShown() override;
    SessionContents takeSession(const QString &file) override;

    // the mouse
    void toCamera(QMouseEvent *event);
    void doubleClick(QMouseEvent *event);
    bool isForLayer(QMouseEvent *event);
    bool begin();
    bool grab();
    void beginDrag(const DragInteraction::Grip &grip);
    Place placeOfKeys() const;
    bool beginsByKey(const Place &place) const;
    bool changeRim(double times);
    void hover();
    void foresee();
    void forgetForeseen();

    // the keys
    const ActionTable::Row *keyOf(const QKeyEvent &event) const;
    void act(BendAction::Id action);
    void dragByKey(BendDrag::Kind kind);
    void placePivot();
    void setRole(BendPanel::Role which, int handle = 2);
    void setMode(BendPanel::Mode mode);

    // the panel
    void makePanel();
    void connectHandles();
    void connectPoses();
    bool isForPanel(); ///< whether the panel may do something now
    void takeOptions();
    void onOptions();
    void onCommand(int which);
    void apply(bool inPlace);
    void editHandle(const BendHandleRow &to);
    void onPoseCommand(int which);
    void exportAnimation();
    void changePoses(const std::function<void()> &change);
    void changePose(int row, const std::function<void()> &change);
    void changeFrame(int row, const std::function<void()> &change);
    void renamePose(std::size_t number, const std::string &name);
    void showBlend(const std::vector<double> &weights);
    void showFrame(double time);
    std::optional<double> shownFrame() const;
    void onLineCommand(int which);
    void removeLinePoint();
    void lookForLine();
    void straighten();

    // what is shown
    void showStretch();
    bool isHidden() const; ///< the layer is there, but not shown
    std::string hiddenText() const;
    void expectSeen() const; ///< \throw vcg::fcd::Error it is hidden
    void drawOverlay() const;
    void showHandles();
    void showPoses();
    void lookForGhosts();
    void showLines();
    QString roleText() const;
    QString markingText() const;
    QString lineText() const;
    QString textOfKeys() const;
    QString stateText() const;
    QString figuresText() const;

    int refused = -1;                                 ///< a layer that cannot be bent
    std::map<int, std::unique_ptr<BendSession>> left; ///< sessions of other layers, by their number
    BendOptions usual;                                ///< of the last layer, for the next
    BendPanel::Mode usualMode = BendPanel::Drag;      ///< the same, until the user ends the tool
    std::unique_ptr<BendLinePreview> linePreview;     ///< in the mode Line
    std::unique_ptr<BendOnionSkin> onionSkin;         ///< null: switched off
    double timeOfGhosts = 0;                          ///< the last shown time of the animation, seconds
    int hovered = 0;                                  ///< the handle under the mouse, 0: none
    bool keysBegin = false;                           ///< beginsByKey() under the mouse
    int keysTag = 0;                                  ///< the handle for keys there, 0: none
    Place foreseen;                                   ///< under the mouse; its preview follows
    bool isForeseeing = false;                        ///< a call of foresee() is queued
    bool isReading = false;                           ///< foresee() waits until the surface is read
    std::vector<Eigen::Vector3d> foreseenPivots;      ///< about which it would turn, world
    bool wasHidden = false;                           ///< isHidden() when it was drawn last
    bool isLimbForeseen = false;                      ///< a press would turn a limb
    std::optional<GizmoPart> lit;                     ///< the part of the gizmo under the mouse
    unsigned long escaped = 0; ///< time when Esc last gave the mouse to the camera, by the window system's clock
    QElapsedTimer sinceRim;
    double frameShown = 0; ///< the last asked time of the animation, seconds
};

#endif
