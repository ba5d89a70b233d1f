// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_line_box.h"

#include <QFormLayout>
#include <QHBoxLayout>
#include <QPushButton>
#include <QSignalBlocker>

BendLineBox::BendLineBox(QWidget *parent) : QWidget(parent) {
    auto *form = new QFormLayout(this);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    const auto named = [](auto *widget, const char *name, const QString &tip) {
        widget->setObjectName(name);
        widget->setToolTip(tip);
        if (!qobject_cast<QDoubleSpinBox *>(widget))
            widget->setFocusPolicy(Qt::NoFocus); // keys stay with the view
        return widget;
    };
    const auto add = [&](QHBoxLayout &row, const char *name, const QString &text, const QString &tip, Command which) {
        auto *button = named(new QPushButton(text), name, tip);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        row.addWidget(button);
    };
    source = named(new QComboBox, "line",
                   "The line that the layer is straightened along: the points that are clicked, in their order, or a "
                   "layer with edges");
    form->addRow("Line", source);
    auto *files = new QHBoxLayout;
    add(*files, "loadline", "Load ...", "The points of a file (.pp, .csv, .txt) take the place of those that there are",
        Load);
    add(*files, "saveline", "Save ...", "Writes the points as a list (.csv), which 'FCD: Straighten Mesh' reads", Save);
    add(*files, "clearline", "Clear", "Takes all points away", Clear);
    form->addRow(files);
    middle = named(new QCheckBox("Through the middle"), "middle",
                   "Takes the line through the middles of the cross-sections: it may then be clicked on the surface");
    middle->setChecked(true);
    form->addRow(middle);
    shape = named(new QComboBox, "becomes", "What the line becomes");
    shape->addItems({"A straight line", "An arc", "The line of a layer"});
    form->addRow("Becomes", shape);
    angle = named(new QDoubleSpinBox, "angle",
                  "By how many degrees the arc bends from end to end; negative: to the other side");
    angle->setRange(-359, 359);
    angle->setValue(StraightenMeshParam().angle);
    form->addRow("Angle", angle);
    target = named(new QComboBox, "target", "A layer with edges, along whose line this one is laid from its beginning");
    form->addRow("Along", target);
    reverse = named(new QCheckBox("From its other end"), "reverse", "Lays it along that line from its other end");
    form->addRow(reverse);
    length = named(new QDoubleSpinBox, "length",
                   "How long the line gets, in world units: the layer is stretched along it; 0: as long as it is");
    length->setRange(0, 1e6);
    length->setDecimals(4);
    length->setSpecialValueText("kept");
    form->addRow("Length", length);
    untwist = named(new QCheckBox("Take the twist out"), "untwist",
                    "Turns the cross-sections about the line so that their longest axes lie alike");
    form->addRow(untwist);
    auto *last = new QHBoxLayout;
    add(*last, "straighten", "Straighten to new layer",
        "A new layer gets the shape, as 'FCD: Straighten Mesh' gives it; the line becomes a layer, too", Straighten);
    form->addRow(last);
    showLayers({});
    connect(source, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendLineBox::changed);
    connect(shape, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BendLineBox::showWhatCounts);
    showWhatCounts();
}

void BendLineBox::showWhatCounts() {
    angle->setEnabled(shape->currentIndex() == StraightenMeshParam::Arc);
    for (QWidget *each : {static_cast<QWidget *>(target), static_cast<QWidget *>(reverse)})
        each->setEnabled(shape->currentIndex() == StraightenMeshParam::Line);
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
    param.angle = rounded<Scalarm>(angle->value());
    param.reverse = reverse->isChecked();
    param.length = rounded<Scalarm>(length->value());
    param.untwist = untwist->isChecked();
    param.bend.smoothness = rounded<Scalarm>(param.bend.smoothness); // as a filter is handed it
    return param;
}

#include "moc_bend_line_box.cpp" // NOLINT(bugprone-suspicious-include)
