// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/panel.h"

#include <layer_fcd/parameters.h>

#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QSettings>
#include <QTimer>

// The buttons of the panel, and the parts that they unfold.

const char *const onionSetting = "fcd/bend/onion_skin";

void BendPanel::addCommands(QBoxLayout &column) {
    auto *grid = new QGridLayout;
    grid->setSpacing(3);
    const auto add = [&](const char *text, const QString &tip, BendAction::Id which, int row, int place, int width) {
        auto *button = named(new QPushButton(text), "", bendActions().withKeys(tip, which));
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        grid->addWidget(button, row, place, 1, width);
    };
    add("Mark selection", "Marks the selected vertices and faces", BendAction::MarkSelection, 0, 0, 6);
    add("Clear marks", "Removes all marks: all is free", BendAction::ClearMarks, 0, 6, 6);
    add("Undo", "Undo, also over applies", BendAction::Undo, 1, 0, 3);
    add("Redo", "Redo", BendAction::Redo, 1, 3, 3);
    add("Reset", "Takes all motions back", BendAction::Reset, 1, 6, 3);
    add("Apply in place", "The layer keeps the shape, and the next pose begins from it", BendAction::ApplyInPlace, 2, 0,
        6);
    add("Apply to new layer", "A new layer gets the shape, and this one is as it was", BendAction::ApplyToNewLayer, 2,
        6, 6);
    grid->addWidget(
        sessionButton("marks, handles, motions, poses, key frames, the line, the rest shape",
                      [this](bool load) { emit command(load ? BendAction::LoadSession : BendAction::SaveSession); }),
        1, 9, 1, 3);
    column.addLayout(grid);
}

/// Adds the buttons that show or hide parts of the panel, in the state of the last time.
void BendPanel::addFolds(QBoxLayout &column) {
    auto *row = new QHBoxLayout;
    row->setSpacing(3);
    const auto add = [&](const char *name, const char *text, const QString &tip, QWidget *part, bool usual) {
        auto *button = named(new QToolButton, name, tip);
        button->setText(text);
        button->setCheckable(true);
        button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        const QString setting = QString("fcd/bend/shows_") + name;
        button->setChecked(QSettings().value(setting, usual).toBool());
        connect(button, &QToolButton::toggled, this, [this, setting, part](bool shown) {
            QSettings().setValue(setting, shown);
            showParts();
            if (shown)
                scrollTo(part);
        });
        row->addWidget(button);
        folds.emplace_back(button, part);
    };
    add("marks_fold", "Marks", "How you mark, symmetry, stretch", marking, true);
    add("handles_fold", "Handles", "The list of handles", list, true);
    add("poses_fold", "Poses", "Named poses, blended by sliders, and key frames", poseBox, false);
    add("more", "More", "Smoothness, detail, falloff, motions as text, graph layers, figures", moreOptions, false);
    auto *keys = named(new QToolButton, "keys", bendActions().withKeys("What the keys do", BendAction::Page));
    keys->setText("?");
    connect(keys, &QToolButton::clicked, this, &BendPanel::showKeys);
    row->addWidget(keys);
    column.addLayout(row);
}

void BendPanel::unfoldPoses() {
    for (const auto &[button, part] : folds)
        if (part == poseBox)
            button->setChecked(true);
}

/// Shows the unfolded parts; in the mode Line, neither marks nor handles.
void BendPanel::showParts() {
    const bool isLine = mode() == Line;
    lineBox->setVisible(isLine);
    for (const auto &[button, part] : folds) {
        button->setArrowType(button->isChecked() ? Qt::DownArrow : Qt::RightArrow);
        part->setVisible(button->isChecked() && !(isLine && (part == marking || part == list)));
    }
    tracePlaces(*this);
}

/// A row with the choices of a parameter.
static QComboBox *addShapeChoice(QFormLayout &form, const char *name, const ParameterText &words) {
    auto *choice = named(new QComboBox, name, words.help);
    choice->addItems(words.values);
    form.addRow(words.label, choice);
    return choice;
}

void BendPanel::addMore(QBoxLayout &column) {
    auto *form = new QFormLayout(moreOptions);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    smoothnessValue =
        numberBox("smoothness", "How evenly turns spread over the surface: higher is stiffer", 0, 10, 4, 0.0058);
    smoothnessValue->setSingleStep(0.002);
    form->addRow("Smoothness", smoothnessValue);
    falloffChoice = addShapeChoice(*form, "falloff", falloffText());
    const ParameterText words = elasticText();
    elastic = named(new QCheckBox(words.label), "elastic", words.help);
    form->addRow(elastic);
    rigidityValue = numberBox("rigidity", rigidityText().help, 0, 1, 3, 1);
    rigidityValue->setSingleStep(0.1);
    form->addRow("Rigidity", rigidityValue);
    connect(elastic, &QCheckBox::toggled, rigidityValue, &QWidget::setDisabled); // what keeps its volume is rigid
    patchCount = named(new CountBox, "patches",
                       "Number of patches of the surface: more bend more finely, and take longer. Automatic (0): 100 "
                       "to 1500, as many as it needs");
    patchCount->setRange(0, 20000);
    patchCount->setSpecialValueText("automatic");
    form->addRow("Detail", patchCount);
    weightsChoice = addShapeChoice(*form, "distances", weightsText());
    motionText = new QPlainTextEdit;
    motionText->setObjectName("motions");
    motionText->setFixedHeight(58);
    motionText->setPlaceholderText("Motions as text");
    motionText->setToolTip("The motions of the handles as the filters take them ('Motions as text'); type or paste, "
                           "then press 'Apply text'");
    form->addRow(motionText);
    auto *take = named(new QPushButton("Apply text"), "take", "Moves the handles as the text says");
    connect(take, &QPushButton::clicked, this, [this] { emit command(BendAction::TakeMotions); });
    graphs = named(new QCheckBox("with graph layers"), "graphs",
                   "'Apply to new layer' also adds the deformation graph at rest and deformed");
    form->addRow(graphs, take);
    onion = named(new QCheckBox, "onion", ""); // see setGhostsArePoints()
    onion->setChecked(QSettings().value(onionSetting, false).toBool());
    connect(onion, &QCheckBox::toggled, this, [](bool shown) { QSettings().setValue(onionSetting, shown); });
    setGhostsArePoints(false);
    form->addRow(onion);
    figures = new QLabel;
    figures->setObjectName("figures");
    form->addRow(figures);
    column.addWidget(moreOptions);
}

void BendPanel::setGhostsArePoints(bool arePoints) {
    onion->setText(arePoints ? "Onion skin (points: the layer is large)" : "Onion skin");
    onion->setToolTip(
        QString("Shows the neighbouring key frames as ghosts: the one before in green, the one after in blue%1")
            .arg(arePoints
                     ? ". This layer has so many faces that they would slow a drag: ghosts are some of its vertices"
                     : ""));
}

/// Scrolls to a part, once it is laid out.
void BendPanel::scrollTo(QWidget *part) {
    QTimer::singleShot(50, this, [this, part] { scroll->ensureWidgetVisible(part); });
}

const ActionTable &bendActions() {
    static const ActionTable all = {
        {BendAction::Drag, "D|Shift+J",
         "drag: a limb turns so that the place under the mouse follows; a handle, or a place elsewhere, is pulled"},
        {BendAction::Pull, "M", "pull: drag a handle, or a point of the surface, also of a limb"},
        {BendAction::Brush, "B", "mark with the brush; its size is on the wheel"},
        {BendAction::Rectangle, "V", "mark all in a rectangle"},
        {BendAction::Polyline, "L", "mark all in a polygon: click its corners, Enter or a double click ends it"},
        {BendAction::Line, "N",
         "straighten the layer along a line: click points along it, drag them; a layer, or a file, may be the line, "
         "too"},
        {BendAction::RemovePoint, "Del", "remove the point of the line under the mouse, or else the last one"},
        {BendAction::Fixed, "F", "marks become fixed"},
        {BendAction::Free, "U", "free"},
        {BendAction::Handle, "H", "part of the selected handle, or a new one after that was moved"},
        {BendAction::NextHandle, "Shift+H", "the next handle"},
        {BendAction::Outside, "O", "ignored: it never moves"},
        {BendAction::Through, "T", "mark only what you see, or through the mesh"},
        {BendAction::Move, "G", "move what is under the mouse, a handle or a place, or else the selected handle"},
        {BendAction::Turn, "R", "turn it; then drag from there along a limb: the part beyond turns about that place"},
        {BendAction::Scale, "S", "scale it"},
        {BendAction::Limb, "J",
         "turn the limb under the mouse so that this place follows: at the joint that you turned last, or where the "
         "limb begins"},
        {BendAction::Pivot, "P",
         "put the pivot of the selected handle under the mouse, on a place or another handle's middle; beside the "
         "mesh: on its own middle again"},
        {BendAction::Undo, "Ctrl+Z", "undo, also over applies"},
        {BendAction::Redo, "Ctrl+Shift+Z", "redo"},
        {BendAction::Reset, "Backspace", "take all motions back"},
        {BendAction::Cancel, "Esc", "cancel a move or a mark; else camera mode, until you press Esc again"},
        {BendAction::End, "Return|Enter", "keep a move; end a polygon"},
        {BendAction::ApplyInPlace, "Ctrl+Return|Ctrl+Enter", "apply in place"},
        {BendAction::ApplyToNewLayer, "Ctrl+Shift+Return|Ctrl+Shift+Enter", "apply to a new layer"},
        {BendAction::Page, "?|Shift+?", "this page"},
    };
    return all;
}

QString bendKeyPage() {
    return bendActions().page(
        {{"while moving",
          "X, Y, Z: along or about an axis; a number; G, R, S; Ctrl: in steps; Shift: onto another layer under the "
          "mouse; wheel: how far it bends, or which joint turns; click or Enter keeps, right click or Esc cancels"},
         {"Ctrl, wheel", "width of the free rim around the mark under the mouse"},
         {"camera",
          "drag beside the mesh, or with the right or middle button; wheel; a double click centers a place"}});
}
