// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/panel.h"

#include "edit_fcd/bend/panel/actions.h"
#include "edit_fcd/kit/tool_window.h"

#include <layer_fcd/parameters.h>

#include <QFormLayout>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QScrollArea>
#include <QTimer>
#include <QVBoxLayout>

// The buttons of the panel, and what they unfold.

void BendPanel::addCommands(QBoxLayout &column) {
    auto *grid = new QGridLayout;
    grid->setSpacing(3);
    const auto add = [&](const char *text, const QString &tip, Command which, int row, int place) {
        auto *button = new QPushButton(text);
        button->setToolTip(tip);
        button->setFocusPolicy(Qt::NoFocus);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        grid->addWidget(button, row, place);
    };
    add("Mark selection", "Marks the selected vertices and faces", MarkSelection, 0, 0);
    add("Clear marks", "All is free, and nothing is a handle", ClearMarks, 0, 1);
    add("Undo", bendActions().withKeys("Undo, also over applies", BendAction::Undo), Undo, 1, 0);
    add("Redo", bendActions().withKeys("Redo", BendAction::Redo), Redo, 1, 1);
    add("Apply in place",
        bendActions().withKeys("The layer keeps the shape, and the next pose begins from it", BendAction::ApplyInPlace),
        ApplyInPlace, 2, 0);
    add("Apply to new layer",
        bendActions().withKeys("A new layer gets the shape, and this one is as it was", BendAction::ApplyToNewLayer),
        ApplyToNewLayer, 2, 1);
    add("Reset", bendActions().withKeys("Takes all motions back", BendAction::Reset), Reset, 3, 0);
    auto *folds = new QHBoxLayout;
    folds->addWidget(fold("poses_fold", "Poses", "Poses that have names, blended by sliders", poseBox));
    folds->addWidget(fold("more", "More", "What shapes a deformation, motions as text, graph layers", moreOptions));
    grid->addLayout(folds, 3, 1);
    column.addLayout(grid);
}

/// A button that shows, or hides, a part of the panel.
QToolButton *BendPanel::fold(const char *name, const char *text, const QString &tip, QWidget *part) {
    auto *button = new QToolButton;
    button->setObjectName(name);
    button->setText(text);
    button->setToolTip(tip);
    button->setCheckable(true);
    button->setFocusPolicy(Qt::NoFocus);
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setArrowType(Qt::RightArrow);
    button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    connect(button, &QToolButton::toggled, this, [this, button, part](bool shown) {
        button->setArrowType(shown ? Qt::DownArrow : Qt::RightArrow);
        part->setVisible(shown);
        if (shown)
            scrollTo(part);
        tracePlaces(*this);
    });
    return button;
}

void BendPanel::addMore(QBoxLayout &column) {
    auto *form = new QFormLayout(moreOptions);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    smoothnessValue = new NumberBox;
    smoothnessValue->setToolTip("How evenly turns are spread over the surface: higher is stiffer");
    smoothnessValue->setDecimals(4);
    smoothnessValue->setRange(0, 10);
    smoothnessValue->setSingleStep(0.002);
    smoothnessValue->setValue(0.0058);
    form->addRow("Smoothness", smoothnessValue);
    patchCount = new QSpinBox;
    patchCount->setToolTip("How many patches the surface is divided into: more bend in more places, and take longer. "
                           "Automatic (0): 100 to 1500, as many as the surface is worth");
    patchCount->setRange(0, 20000);
    patchCount->setSpecialValueText("automatic");
    form->addRow("Initial patches", patchCount);
    const ParameterText words = weightsText();
    weightsChoice = new QComboBox;
    weightsChoice->setObjectName("distances");
    weightsChoice->addItems(words.values);
    weightsChoice->setToolTip(words.help);
    form->addRow(words.label, weightsChoice);
    motionText = new QPlainTextEdit;
    motionText->setObjectName("motions");
    motionText->setFixedHeight(58);
    motionText->setPlaceholderText("Motions as text");
    motionText->setToolTip("The motions of the handles as the filters take them ('Motions as text'); type or paste, "
                           "then press 'Take motions'");
    form->addRow(motionText);
    auto *take = new QPushButton("Take motions");
    take->setObjectName("take");
    take->setToolTip("Moves the handles as the text says");
    take->setFocusPolicy(Qt::NoFocus);
    connect(take, &QPushButton::clicked, this, [this] { emit command(TakeMotions); });
    graphs = new QCheckBox("with graph layers");
    graphs->setObjectName("graphs");
    graphs->setToolTip("'Apply to new layer' also adds the deformation graph at rest and deformed");
    form->addRow(graphs, take);
    column.addWidget(moreOptions);
}

/// Once it has a place.
void BendPanel::scrollTo(QWidget *part) {
    QTimer::singleShot(50, this, [this, part] { static_cast<QScrollArea *>(widget())->ensureWidgetVisible(part); });
}
