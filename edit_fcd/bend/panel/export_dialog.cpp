// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/export_dialog.h"

#include "edit_fcd/kit/tool_window.h"

#include <algorithm>

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QPushButton>

BendExportDialog::BendExportDialog(double first, double last, QWidget *parent)
    : QDialog(parent), first(first), last(last) {
    setWindowTitle("Export animation");
    auto *form = new QFormLayout(this);
    const auto addChoice = [&](const char *name, const QString &label, const QStringList &items, const QString &tip) {
        auto *choice = named(new QComboBox, name, tip);
        choice->addItems(items);
        form->addRow(label, choice);
        return choice;
    };
    const auto add = [&](const char *name, const QString &label, double least, double most, double value,
                         const QString &tip) {
        auto *box = numberBox(name, tip, least, most, 3, value);
        form->addRow(label, box);
        return box;
    };
    what = addChoice("what", "As", {"File (.glb, .pc2, .mdd)", "Layers: each key frame", "Layers: each frame"},
                     "Layers have all that this layer carries. One of a million vertices takes some hundred MB");
    rate =
        add("rate", "Frames per second", 0.001, 1000, AnimationExport().rate, "24 as in films, 25 or 30 as in video");
    from = add("from", "From, seconds", first, last, first, "When the file begins");
    to = add("to", "To, seconds", first, last, last, "When it ends");
    shapes = addChoice("shapes", "Morph targets", {"Each frame", "Each pose"}, // as SequenceOutput::Shapes
                       "Shape keys of a .glb. Each frame: as you see it here. Each pose: a small file, to mix by hand; "
                       "turning parts shrink in between");
    auto *buttons = new QDialogButtonBox;
    QPushButton *go = buttons->addButton("Choose file ...", QDialogButtonBox::AcceptRole);
    go->setObjectName("choose");
    go->setMinimumWidth(go->sizeHint().width()); // it stays where it is, whatever it says
    buttons->addButton(QDialogButtonBox::Cancel);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    form->addRow(buttons);
    connect(what, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this, go](int which) {
        rate->setEnabled(which != SequenceParam::KeyFrames);
        shapes->setEnabled(which == SequenceParam::None);
        go->setText(which == SequenceParam::None ? "Choose file ..." : "Make layers");
    });
    tracePlaces(*this);
}

AnimationExport BendExportDialog::asked() const {
    const auto exact = [](const QDoubleSpinBox &box,
                          double offered) { // the offered value, which has more decimals than the box
        return box.value() == std::clamp(QString::number(offered, 'f', box.decimals()).toDouble(), box.minimum(),
                                         box.maximum())
                   ? offered
                   : box.value();
    };
    AnimationExport how;
    how.rate = rate->value();
    how.from = exact(*from, first);
    how.to = exact(*to, last);
    how.layers = SequenceParam::Layers(what->currentIndex());
    how.shapes = vcg::fcd::SequenceOutput::Shapes(shapes->currentIndex());
    return how;
}
