// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_panel.h"

#include "bend_state.h"

#include <layer_fcd/parameters.h>

#include <initializer_list>

#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QScrollArea>
#include <QToolButton>
#include <QVBoxLayout>

BendPanel::BendPanel(QWidget *parent) : QDockWidget("FCD: Bend", parent) {
    setObjectName("fcdBendPanel");
    setFeatures(QDockWidget::DockWidgetMovable | QDockWidget::DockWidgetFloatable);
    auto *content = new QWidget;
    auto *column = new QVBoxLayout(content);
    column->setContentsMargins(6, 4, 6, 4);
    column->setSpacing(4);

    modes = new QButtonGroup(this);
    auto *modeRow = new QHBoxLayout;
    const char *const names[] = {"Bend", "Brush", "Rectangle", "Polyline"};
    const char *const tips[] = {"Drag a handle, or a point of the surface (M)",
                                "Mark with a brush; size on the wheel (B)", "Mark what is in a rectangle (V)",
                                "Mark what is in a polygon: click its corners, double-click the last (L)"};
    for (int i = 0; i < 4; ++i) {
        auto *button = new QToolButton;
        button->setText(names[i]);
        button->setToolTip(tips[i]);
        button->setCheckable(true);
        modes->addButton(button, i);
        modeRow->addWidget(button);
    }
    modeRow->addStretch();
    setMode(Bend);
    column->addLayout(modeRow);

    auto *form = new QFormLayout;
    form->setVerticalSpacing(3);
    auto *markRow = new QHBoxLayout;
    role = new QComboBox;
    role->addItems({"Fixed", "Free", "Handle", "Outside"});
    role->setCurrentIndex(Handle);
    role->setToolTip("What is marked becomes this (F, U, H, O)");
    number = new QSpinBox;
    number->setRange(2, 1000000);
    number->setToolTip("Number of the handle");
    through = new QCheckBox("through");
    through->setToolTip("Also what is hidden (T)");
    markRow->addWidget(role);
    markRow->addWidget(number);
    markRow->addWidget(through);
    form->addRow("Mark", markRow);

    brushPixels = new QSpinBox;
    brushPixels->setRange(2, 500);
    brushPixels->setValue(20);
    brushPixels->setSuffix(" px");
    form->addRow("Brush radius", brushPixels);
    radiusPercent = new QDoubleSpinBox;
    radiusPercent->setRange(0.5, 400);
    radiusPercent->setValue(100 * usualRadius);
    radiusPercent->setSuffix(" %");
    radiusPercent->setToolTip(
        "Where nothing is marked as fixed: how far along the surface a handle bends what is around it, of the "
        "diagonal of the bounding box. The wheel changes it while dragging.");
    form->addRow("Point radius", radiusPercent);
    mirrorAxis = new QComboBox;
    mirrorAxis->addItems({"none", "x", "y", "z"});
    mirrorAxis->setToolTip("Marks and moves on both sides of the middle of the layer");
    form->addRow("Symmetry", mirrorAxis);
    smoothnessValue = new QDoubleSpinBox;
    smoothnessValue->setDecimals(4);
    smoothnessValue->setRange(0, 10);
    smoothnessValue->setSingleStep(0.002);
    smoothnessValue->setValue(0.0058);
    form->addRow("Smoothness", smoothnessValue);
    patchCount = new QSpinBox;
    patchCount->setRange(1, 20000);
    patchCount->setValue(300);
    form->addRow("Initial patches", patchCount);
    const EnumText weightsWords = weightsText();
    weightsChoice = new QComboBox;
    weightsChoice->addItems(weightsWords.values);
    weightsChoice->setToolTip(weightsWords.help);
    form->addRow(weightsWords.label, weightsChoice);
    auto *poseRow = new QHBoxLayout;
    poseSlider = new QSlider(Qt::Horizontal);
    poseSlider->setRange(0, 200);
    poseSlider->setValue(100);
    poseLabel = new QLabel("100 %");
    poseRow->addWidget(poseSlider);
    poseRow->addWidget(poseLabel);
    form->addRow("Pose", poseRow);
    stretch = new QCheckBox("Show stretch");
    form->addRow(stretch);
    column->addLayout(form);

    motionText = new QPlainTextEdit;
    motionText->setFixedHeight(58);
    motionText->setPlaceholderText("Motions as text");
    motionText->setToolTip(
        "The motions of the handles as the filters take them ('Motions as text'); type or paste, then "
        "press 'Take motions'");
    column->addWidget(motionText);

    auto *grid = new QGridLayout;
    grid->setSpacing(3);
    const auto add = [&](const char *text, const char *tip, Command which, int row, int place) {
        auto *button = new QPushButton(text);
        button->setToolTip(tip);
        button->setFocusPolicy(Qt::NoFocus); // keys go to the view
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        grid->addWidget(button, row, place);
    };
    add("Take motions", "Moves the handles as the text says", TakeMotions, 0, 0);
    add("Mark selection", "Marks the selected vertices and faces", MarkSelection, 0, 1);
    add("Clear marks", "All is free, and nothing is a handle", ClearMarks, 1, 0);
    add("Reset", "Takes all motions back (Backspace)", Reset, 1, 1);
    add("Undo", "Ctrl+Z", Undo, 2, 0);
    add("Redo", "Ctrl+Shift+Z", Redo, 2, 1);
    add("Apply in place", "The layer keeps the shape, and the next pose begins from it (Ctrl+Enter)", ApplyInPlace, 3,
        0);
    add("Apply to new layer", "A new layer gets the shape, and this one is as it was (Ctrl+Shift+Enter)",
        ApplyToNewLayer, 3, 1);
    column->addLayout(grid);
    graphs = new QCheckBox("with graph layers");
    graphs->setToolTip("'Apply to new layer' also adds the deformation graph at rest and deformed");
    column->addWidget(graphs);

    state = new QLabel;
    state->setWordWrap(true);
    state->setMinimumHeight(48);
    state->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    column->addWidget(state);
    column->addStretch();
    auto *scroll = new QScrollArea;
    scroll->setWidget(content);
    scroll->setWidgetResizable(true);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setMinimumWidth(content->minimumSizeHint().width() + 20);
    setWidget(scroll);

    for (QWidget *widget : std::initializer_list<QWidget *>{scroll, role, mirrorAxis, weightsChoice, through, stretch,
                                                            graphs, poseSlider})
        widget->setFocusPolicy(Qt::NoFocus); // keys stay with the view
    for (QAbstractButton *button : modes->buttons())
        button->setFocusPolicy(Qt::NoFocus);
    connect(poseSlider, &QSlider::valueChanged, this, [this](int value) {
        poseLabel->setText(QString("%1 %").arg(value));
        emit optionsChanged();
    });
    connect(smoothnessValue, &QDoubleSpinBox::editingFinished, this, &BendPanel::optionsChanged);
    connect(patchCount, &QSpinBox::editingFinished, this, &BendPanel::optionsChanged);
    for (const QComboBox *choice : {mirrorAxis, weightsChoice})
        connect(choice, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendPanel::optionsChanged);
    connect(stretch, &QCheckBox::toggled, this, &BendPanel::optionsChanged);
    connect(modes, QOverload<QAbstractButton *>::of(&QButtonGroup::buttonClicked), this, &BendPanel::optionsChanged);
}

int BendPanel::tag() const {
    switch (role->currentIndex()) {
    case Fixed: return 0;
    case Free: return 1;
    case Outside: return -1;
    }
    return number->value();
}

void BendPanel::setRole(Role which, int handle) {
    role->setCurrentIndex(which);
    if (which == Handle)
        number->setValue(handle);
}

void BendPanel::setPose(int percent) {
    const bool blocked = poseSlider->blockSignals(true);
    poseSlider->setValue(percent);
    poseSlider->blockSignals(blocked);
    poseLabel->setText(QString("%1 %").arg(percent));
}

void BendPanel::setShape(double smoothness, int patches, vcg::fcd::MappingWeights weights, int mirror, int pose) {
    const QSignalBlocker blocked(this);
    smoothnessValue->setValue(smoothness);
    patchCount->setValue(patches);
    weightsChoice->setCurrentIndex(int(weights));
    mirrorAxis->setCurrentIndex(mirror + 1);
    setPose(pose);
}

void BendPanel::setStretch(bool shown) {
    const bool blocked = stretch->blockSignals(true);
    stretch->setChecked(shown);
    stretch->blockSignals(blocked);
}

void BendPanel::allowStretch(bool allowed) {
    stretch->setEnabled(allowed);
    stretch->setToolTip(
        allowed ? "Colours the layer by how much its surface is stretched against the rest shape: red where "
                  "it is twice as long or more, blue where it is half as long or less, grey where it is as "
                  "long as it was. While you mark, the marks are shown."
                : "A layer without faces has no surface that could be stretched.");
}

void BendPanel::showMotions(const QString &text) {
    if (!motionText->hasFocus() && motionText->toPlainText() != text)
        motionText->setPlainText(text);
}

#include "moc_bend_panel.cpp" // NOLINT(bugprone-suspicious-include)
