// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TOOL_H
#define FCD_BEND_TOOL_H

#include "edit_fcd/bend/tool/drag_interaction.h" // before Qt
#include "edit_fcd/bend/tool/line_preview.h"
#include "edit_fcd/bend/tool/onion_skin.h"

#include "edit_fcd/bend/panel/actions.h"

#include <map>

/// FCD: Bend: begins what mouse and keys in a view (router.cpp, key_events.cpp), and the panel (commands.cpp,
/// line_commands.cpp, pose_commands.cpp), ask for on its stage.
class BendTool : public BendStage {
    Q_OBJECT

  public:
    using BendStage::BendStage;

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
    bool isForPanel(); ///< whether it may do something now
    void takeOptions();
    void showOptions();
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
    void drawOverlay() const;
    void drawGhosts();
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
    std::map<int, std::unique_ptr<BendSession>> left; ///< of other layers of the document, by their number
    BendOptions usual;                                ///< what the next layer begins with: as the last had it
    std::unique_ptr<BendLinePreview> linePreview;     ///< while a line is given
    std::unique_ptr<BendOnionSkin> onionSkin;         ///< while it is wanted
    double timeOfGhosts = 0;                          ///< of the animation, shown last; seconds
    int hovered = 0;                                  ///< the handle under the mouse, 0: none
    bool keysBegin = false;                           ///< beginsByKey() what is under the mouse
    int keysTag = 0;                                  ///< the handle that keys find there, 0: none
    Place foreseen;                                   ///< what the mouse points at, whose influence is shown soon
    bool isForeseeing = false;                        ///< that is being done
    std::vector<Eigen::Vector3d> foreseenPivots;      ///< where that would turn, world
    bool isLimbForeseen = false;                      ///< a limb would turn, and nothing is pulled
    std::optional<GizmoPart> lit;                     ///< the part of the gizmo under the mouse
    unsigned long escaped = 0; ///< when Esc has given the mouse to the camera last, by the clock of the window system
    QElapsedTimer sinceRim;
    double frameShown = 0; ///< of the animation, asked for last; seconds
};

#endif
