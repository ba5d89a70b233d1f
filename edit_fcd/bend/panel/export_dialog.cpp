// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/export_dialog.h"

#include "edit_fcd/kit/tool_list.h"
#include "edit_fcd/kit/tool_window.h"

#include <algorithm>

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QPushButton>

BendExportDialog::BendExportDialog(double first, double last, QWidget *parent)
    : QDialog(parent), first(first), last(last) {
    setWindowTitle("Export animation");
    auto *form = new QFormLayout(this);
    const auto add = [&](const char *name, const QString &label, double least, double most, double value,
                         const QString &tip) {
        auto *box = named(new NumberBox, name, tip);
        box->setDecimals(3);
        box->setRange(least, most);
        box->setValue(value);
        form->addRow(label, box);
        return box;
    };
    rate =
        add("rate", "Frames per second", 0.001, 1000, AnimationExport().rate, "24 as in films, 25 or 30 as in video");
    from = add("from", "From, seconds", first, last, first, "When the file begins");
    to = add("to", "To, seconds", first, last, last, "When it ends");
    shapes = new QComboBox;
    shapes->setObjectName("shapes");
    shapes->addItems({"Each frame", "Each pose"}); // as SequenceOutput::Shapes
    shapes->setToolTip(
        "Shape keys of a .glb. Each frame: what is played here. Each pose: a small file, to mix by hand; "
        "what turns shrinks in between");
    form->addRow("Morph targets", shapes);
    auto *buttons = new QDialogButtonBox;
    buttons->addButton("Choose file ...", QDialogButtonBox::AcceptRole)->setObjectName("choose");
    buttons->addButton(QDialogButtonBox::Cancel);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    form->addRow(buttons);
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
    how.shapes = vcg::fcd::SequenceOutput::Shapes(shapes->currentIndex());
    return how;
}
