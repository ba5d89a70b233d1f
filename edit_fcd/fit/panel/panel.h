// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_PANEL_H
#define FCD_FIT_PANEL_H

#include "edit_fcd/fit/model/session.h" // before Qt
#include "edit_fcd/kit/action_table.h"
#include "edit_fcd/kit/cell_list.h"
#include "edit_fcd/kit/tool_window.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QSlider>

/// The actions of keys in the view and of the panel's buttons.
struct FitAction {
    // clang-format off
    enum Id {
        Undo, Redo, Remove, Reset, Pull, Cancel,
        InTurn, Both, Source, Target, // in the order of FitPanel::Seen
        Brush, OtherBrush, ApplyInPlace, ApplyToNew,
        Load, Save, Clear, LoadCurves, ClearCurves, SaveSession, LoadSession // without a key
    };
    // clang-format on
};

const ActionTable &fitActions();

/// The panel of the tool FCD: Fit. It shows and sets values, and decides nothing.
class FitPanel : public ToolPanel {
    Q_OBJECT

  public:
    /// Which layers are visible: the one to be clicked next, or as chosen.
    enum Seen { InTurn, Both, Source, Target };
    /// What a press on a layer does: places an end of a pair, paints weight 1 (counts), or weight 0 (carried along).
    enum Brush { Pairs, Counts, Carried };

    explicit FitPanel(QWidget *parent);

    /// Offers target layers. \param chosen one of their numbers, or -1
    void showTargets(const std::vector<std::pair<int, QString>> &layers, int chosen);
    int target() const; ///< number of a layer, -1: none
    Seen seen() const { return Seen(seenButtons->checkedId()); }
    void setSeen(Seen which) { seenButtons->button(which)->setChecked(true); }
    Brush brush() const { return Brush(brushButtons->checkedId()); }
    void setBrush(Brush which) { brushButtons->button(which)->setChecked(true); }
    int brushSize() const { return brushPixels->value(); } ///< radius, pixels of the screen
    void setBrushSize(int pixels) { brushPixels->setValue(pixels); }
    FitOptions options() const;
    void showOptions(const FitOptions &options);
    FitShape shape() const { return FitShape(shapes->checkedId()); }
    void showShape(FitShape shape) { shapes->button(int(shape))->setChecked(true); }
    /// \param file with the curves; empty: none
    void showCurves(const QString &file);
    bool showsDistance() const { return distance->isChecked(); }
    bool graphLayers() const { return graphs->isChecked(); }

    /// \param most the distance that is red; 0: no colours are shown
    void showLegend(double most);
    /// \param percent of the running work; -1: none runs
    void showProgress(int percent);
    /// \param selected row, -1: none
    void showPairs(const std::vector<FitPair> &pairs, int selected);

  signals:
    void targetChosen();
    void seenChosen();
    void brushChosen();
    void shapeChosen();
    void optionsChanged();
    void distanceToggled();
    void command(int which); ///< a FitAction
    void pairSelected(int row);
    void pairRemoved(int row);
    void pairRenamed(int row, QString name);

  private:
    void addLayers(QBoxLayout &column);
    void addPairs(QBoxLayout &column);
    void addShape(QBoxLayout &column);
    void addCommands(QBoxLayout &column);
    QComboBox *choice(const char *name, const QStringList &texts, const QString &tip) const;
    QPushButton *button(const char *name, const QString &text, const QString &tip, FitAction::Id which);

    QComboBox *targets, *start, *weights, *targetWeights;
    QButtonGroup *seenButtons, *brushButtons, *shapes;
    QSpinBox *brushPixels;
    QSlider *stiffness;
    QLabel *stiffnessText, *legend;
    QDoubleSpinBox *largest;
    QCheckBox *distance, *graphs;
    QProgressBar *progress;
    QPushButton *cancel, *curves, *noCurves;
    CellList *list;
};

#endif
