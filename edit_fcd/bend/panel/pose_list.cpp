// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/pose_list.h"

#include "edit_fcd/kit/tool_list.h"
#include "edit_fcd/kit/tool_window.h"

#include <cmath>

#include <QSignalBlocker>
#include <QSlider>

BendPoseList::BendPoseList(QWidget *parent) : QTableWidget(parent) {
    setUpList(*this, {{"Pose", "Click shows this pose alone; double click: its name", 0},
                      {"how much", "How much of it is shown, mixed with the others", 110},
                      {"%", "The same as a number, also below 0 or above 100; double click to type", 44},
                      {"", "Removes the pose", 22}});
    setFixedHeight(100);
    connect(this, &QTableWidget::cellChanged, this, &BendPoseList::onChanged);
    connect(this, &QTableWidget::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(row);
        else if (column == Name)
            emit chosen(row);
    });
}

QSlider *BendPoseList::sliderOf(int row) const { return static_cast<QSlider *>(cellWidget(row, Weight)); }

void BendPoseList::onChanged(int row, int column) {
    if (column == Name) {
        shown[std::size_t(row)].name = item(row, Name)->text(); // until it is said what it is
        emit renamed(row, item(row, Name)->text());
    } else if (column == Percent) {
        const std::optional<double> percent = typedNumber(item(row, Percent)->text());
        if (!percent) {
            showPercent(row, shown[std::size_t(row)].percent);
            return;
        }
        emit begins();
        emit weighted(row, *percent);
    }
}

void BendPoseList::makeRow(int row) {
    const auto put = [&](int column, const QString &text, Qt::ItemFlags flags) {
        auto *cell = new QTableWidgetItem(text);
        cell->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | flags);
        setItem(row, column, cell);
    };
    put(Name, {}, Qt::ItemIsEditable);
    put(Weight, {}, {});
    put(Percent, {}, Qt::ItemIsEditable);
    put(Remove, QString(QChar(0xd7)), {});
    auto *slider = new QSlider(Qt::Horizontal);
    slider->setObjectName(QString("weight%1").arg(row));
    slider->setRange(0, 100);
    slider->setFocusPolicy(Qt::NoFocus); // keys stay with the view
    connectSlider(
        *slider, [this] { emit begins(); }, [this, row](int percent) { emit weighted(row, percent); });
    setCellWidget(row, Weight, slider);
}

void BendPoseList::showPercent(int row, double percent) {
    const QSignalBlocker blocked(this), still(sliderOf(row));
    item(row, Percent)->setText(QString::number(percent, 'g', 4));
    sliderOf(row)->setValue(int(std::lround(std::min(std::max(percent, 0.0), 100.0))));
}

void BendPoseList::showRows(const std::vector<BendPoseRow> &rows) {
    if (rows == shown || state() == EditingState)
        return;
    const QSignalBlocker blocked(this);
    const bool isLonger = rows.size() > shown.size();
    shown = rows;
    const int before = rowCount();
    setRowCount(int(rows.size())); // sliders stay, as one may be in use
    for (int row = 0; row < rowCount(); ++row) {
        const BendPoseRow &each = rows[std::size_t(row)];
        if (row >= before)
            makeRow(row);
        item(row, Name)->setText(each.name);
        item(row, Name)->setToolTip(each.motions);
        showPercent(row, each.percent);
    }
    if (isLonger)
        tracePlaces(*this);
}

void BendPoseList::nameLast() {
    const int row = rowCount() - 1;
    scrollToItem(item(row, Name));
    setCurrentCell(row, Name);
    editItem(item(row, Name));
}

#include "edit_fcd/bend/panel/moc_pose_list.cpp" // NOLINT(bugprone-suspicious-include)
