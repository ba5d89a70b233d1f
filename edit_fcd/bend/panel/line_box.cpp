// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/line_box.h"

#include "edit_fcd/kit/tool_window.h"

#include <QFormLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QRegularExpression>
#include <QSignalBlocker>

using vcg::fcd::Error;

/// The label without its unit, to save room.
static QString labelOf(const ParameterText &text) { return text.label.section(" (", 0, 0); }

/// A vector from three numbers, in the host's precision. \throw vcg::fcd::Error they are not three numbers
static Eigen::Vector3d directionIn(const QLineEdit &edit, const ParameterText &text) {
    const QStringList words = QString(edit.text()).replace(QRegularExpression("[,;]"), " ").simplified().split(' ');
    Eigen::Vector3d direction;
    bool isNumber = words.size() == 3;
    for (int k = 0; isNumber && k < 3; ++k)
        direction[k] = ::rounded<Scalarm>(words[k].toDouble(&isNumber));
    if (!isNumber)
        throw Error("'" + text.label.toStdString() + "' is '" + edit.text().toStdString() +
                    "': give three numbers, x y z, or 0 0 0 to follow the line.");
    return direction;
}

BendLineBox::BendLineBox(QWidget *parent) : QWidget(parent) {
    auto *form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    const auto add = [&](QHBoxLayout &row, const char *name, const QString &text, const QString &tip, Command which) {
        auto *button = named(new QPushButton(text), name, tip);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        row.addWidget(button);
    };
    source = named(new QComboBox, "line",
                   "The line to straighten along: the clicked points, in their order, or a layer with edges");
    form->addRow("Line", source);
    auto *files = new QHBoxLayout;
    add(*files, "loadline", "Load ...", "Replaces the points by those of a file (.pp, .csv, .txt)", Load);
    add(*files, "saveline", "Save ...", "Writes the points as a list (.csv), which 'FCD: Straighten Mesh' reads", Save);
    add(*files, "clearline", "Clear", "Removes all points", Clear);
    form->addRow(files);
    const StraightenTexts texts = straightenTexts();
    middle = named(new QCheckBox(texts.middle.label), "middle", texts.middle.help);
    middle->setChecked(true);
    form->addRow(middle);
    shape = named(new QComboBox, "becomes", texts.shape.help);
    shape->addItems(texts.shape.values);
    form->addRow(labelOf(texts.shape), shape);
    angle = numberBox("angle", texts.angle.help, -359, 359, 2, StraightenMeshParam().angle);
    angle->setSuffix(" \u00b0");
    form->addRow(labelOf(texts.angle), angle);
    const auto addDirection = [&](const char *name, const ParameterText &text) {
        auto *edit = named(new QLineEdit("0 0 0"), name, text.help);
        form->addRow(labelOf(text), edit);
        connect(edit, &QLineEdit::editingFinished, this, &BendLineBox::changed);
        return edit;
    };
    direction = addDirection("direction", texts.direction);
    towards = addDirection("towards", texts.towards);
    target = named(new QComboBox, "target", texts.target.help);
    form->addRow(labelOf(texts.target), target);
    reverse = named(new QCheckBox(texts.reverse.label), "reverse", texts.reverse.help);
    form->addRow(reverse);
    length = numberBox("length", texts.length.help, 0, 1e6, 4, 0);
    length->setSpecialValueText("kept");
    form->addRow(labelOf(texts.length), length);
    untwist = named(new QCheckBox(texts.untwist.label), "untwist", texts.untwist.help);
    form->addRow(untwist);
    auto *last = new QHBoxLayout;
    add(*last, "straighten", "Straighten to new layer",
        "A new layer gets the shape, as from 'FCD: Straighten Mesh'; the line becomes a layer, too", Straighten);
    form->addRow(last);
    showLayers({});
    connect(source, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendLineBox::changed);
    connect(middle, &QCheckBox::toggled, this, &BendLineBox::changed);
    connect(shape, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendLineBox::showWhatCounts);
    showWhatCounts();
}

void BendLineBox::showWhatCounts() {
    const bool isArc = shape->currentIndex() == StraightenMeshParam::Arc,
               isLine = shape->currentIndex() == StraightenMeshParam::Line;
    angle->setEnabled(isArc);
    towards->setEnabled(isArc);
    direction->setEnabled(!isLine);
    target->setEnabled(isLine);
    reverse->setEnabled(isLine);
}

void BendLineBox::showLayers(const Layers &layers) {
    if (layers == shown && source->count() > 0)
        return;
    shown = layers;
    for (QComboBox *list : {source, target}) {
        const QSignalBlocker blocked(list);
        const QVariant before = list->currentData();
        list->clear();
        if (list == source)
            list->addItem("clicked points", -1);
        else if (layers.empty())
            list->addItem("there is none", -1);
        for (const auto &[number, name] : layers)
            list->addItem(name, number);
        list->setCurrentIndex(std::max(0, list->findData(before)));
    }
}

StraightenMeshParam BendLineBox::param() const {
    StraightenMeshParam param;
    param.middle = middle->isChecked();
    param.shape = StraightenMeshParam::Shape(shape->currentIndex());
    param.angle = asTyped(angle->value());
    const StraightenTexts texts = straightenTexts();
    if (param.shape != StraightenMeshParam::Line)
        param.direction = directionIn(*direction, texts.direction);
    if (param.shape == StraightenMeshParam::Arc)
        param.towards = directionIn(*towards, texts.towards);
    param.reverse = reverse->isChecked();
    param.length = asTyped(length->value());
    param.untwist = untwist->isChecked();
    param.bend.smoothness = asTyped(param.bend.smoothness); // in the precision that filters get
    return param;
}

#include "edit_fcd/bend/panel/moc_line_box.cpp" // NOLINT(bugprone-suspicious-include)
