// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_PANEL_H
#define FCD_BEND_PANEL_H

#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "edit_fcd/bend/panel/line_box.h"
#include "edit_fcd/bend/panel/lists.h"
#include "edit_fcd/kit/action_table.h"
#include "edit_fcd/kit/tool_window.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QPlainTextEdit>
#include <QPointer>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>

/// The actions of keys in the view and of the panel's buttons.
struct BendAction {
    // clang-format off
    enum Id {
        Drag, Pull, Brush, Rectangle, Polyline, Line, // in the order of BendPanel::Mode
        RemovePoint, Fixed, Free, Handle, NextHandle, Outside, Through,
        Move, Turn, Scale, Limb, // in the order of BendDrag::Kind
        Pivot, Undo, Redo, Reset, Cancel, End, ApplyInPlace, ApplyToNewLayer, Page,
        MarkSelection, ClearMarks, TakeMotions, SaveSession, LoadSession // without a key
    };
    // clang-format on
};

const ActionTable &bendActions();
QString bendKeyPage(); ///< HTML

/// The panel of the tool. It shows and sets values, and decides nothing.
class BendPanel : public ToolPanel {
    Q_OBJECT

  public:
    enum Mode { Drag, Pull, Brush, Rectangle, Polyline, Line };
    enum Role { Fixed, Free, Handle, Outside };

    explicit BendPanel(QWidget *parent);

    Mode mode() const { return Mode(modes->checkedId()); }
    void setMode(Mode mode) { modes->button(mode)->setChecked(true); }
    bool isBending() const { return mode() == Drag || mode() == Pull; } ///< a drag moves, and marks nothing
    /// The tag for marking.
    int tag() const;
    void setRole(Role role, int handle);
    bool isThrough() const { return through->isChecked(); }
    void toggleThrough() { through->toggle(); }
    double radius() const { return radiusPercent->value() / 100; } ///< of a new handle, over the diagonal
    int brush() const { return brushPixels->value(); }             ///< radius, pixels
    void setBrush(int pixels) { brushPixels->setValue(pixels); }
    void keepSizes() const;                          ///< saves them in the settings
    int pose() const { return poseSlider->value(); } ///< percent
    void setPose(int percent);
    /// The options; pose and stretch are taken from \p before.
    BendOptions options(const BendOptions &before) const;
    /// Shows all options, without a signal.
    void showOptions(const BendOptions &options);
    bool showsStretch() const { return stretch->isChecked(); }
    void setStretch(bool shown);
    /// Enables the box for stretch; a cloud has none.
    void allowStretch(bool allowed);
    bool graphLayers() const { return graphs->isChecked(); }
    bool hasOnionSkin() const { return onion->isChecked(); }
    /// Tells in the tip whether ghosts are drawn as points, since the layer is large.
    void setGhostsArePoints(bool arePoints);
    QString motions() const { return motionText->toPlainText(); }

    /// Shows the handles' motions, unless the user is typing there.
    void showMotions(const QString &text);
    void showHandles(const std::vector<BendHandleRow> &rows) { list->show(rows); }
    void showFigures(const QString &text) { figures->setText(text); } ///< about the solution
    void showKeys();
    void unfoldPoses();
    BendHandleList &handles() { return *list; }
    BendPoseBox &poses() { return *poseBox; }
    BendLineBox &line() { return *lineBox; }

  signals:
    void optionsChanged(); ///< pose, shape, mirror, axes, stretch or onion skin
    void poseBegins();     ///< once before the pose slider is moved
    void modeChosen();
    void left();             ///< Esc was pressed in a field
    void roleChanged();      ///< by the user
    void command(int which); ///< a BendAction

  protected:
    bool event(QEvent *event) override;

  private:
    void addModes(QBoxLayout &column);
    void addMarking(QWidget &place);
    void addCommands(QBoxLayout &column);
    void addMore(QBoxLayout &column);
    void addFolds(QBoxLayout &column);
    void showParts();
    void scrollTo(QWidget *part);
    void connectOptions();

    QButtonGroup *modes;
    QComboBox *role, *mirrorAxis, *falloffChoice, *weightsChoice, *axesChoice;
    QSpinBox *number, *brushPixels, *patchCount;
    QDoubleSpinBox *radiusPercent, *smoothnessValue, *rigidityValue;
    QCheckBox *through, *elastic, *stretch, *graphs, *onion;
    QSlider *poseSlider;
    QPlainTextEdit *motionText;
    QLabel *poseLabel, *figures;
    BendHandleList *list;
    BendPoseBox *poseBox;
    BendLineBox *lineBox;
    QWidget *marking, *moreOptions;
    std::vector<std::pair<QToolButton *, QWidget *>> folds; ///< with the parts that they show
    QPointer<QScrollArea> page;                             ///< the page of keys
};

#endif
