// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/pose_list.h"

#include "edit_fcd/kit/tool_list.h"
#include "edit_fcd/kit/tool_window.h"

#include <algorithm>
#include <cmath>

#include <QSignalBlocker>
#include <QSlider>

BendPoseList::BendPoseList(QWidget *parent)
    : CellList({{"Pose", "Click shows this pose alone; double click: its name", 0},
                {"strength", "How much of it is shown, mixed with the others", 110},
                {"%", "The same as a number, also below 0 or above 100; double click to type", 44},
                {"", "Removes the pose", 22}},
               72, parent) {
    connect(this, &CellList::cellEdited, this, [this](int row, int column, const QString &text) {
        if (column == Name) {
            emit renamed(row, text);
        } else if (const std::optional<double> percent = typedNumber(text)) {
            emit begins();
            emit weighted(row, *percent);
        }
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(row);
        else if (column == Name)
            emit chosen(row);
    });
}

void BendPoseList::show(const std::vector<BendPoseRow> &poses) {
    std::vector<Row> rows;
    for (const BendPoseRow &each : poses) {
        ListCell name = ListCell::edited(each.name);
        name.tip = each.motions;
        rows.push_back({name,
                        {},
                        ListCell::edited(QString::number(each.percent, 'g', 4)),
                        {QString(QChar(0xd7)), {}, {}, {}, {}, false}});
    }
    const int before = model()->rowCount();
    if (!showRows(std::move(rows)))
        return;
    for (int row = 0; row < int(poses.size()); ++row) {
        const QModelIndex place = model()->index(row, Weight);
        auto *slider = static_cast<QSlider *>(indexWidget(place)); // kept, since the user may be dragging it
        if (!slider) {
            slider = named(new QSlider(Qt::Horizontal), QString("weight%1").arg(row), "");
            slider->setRange(0, 100);
            connectSlider(
                *slider, [this] { emit begins(); }, [this, row](int percent) { emit weighted(row, percent); });
            setIndexWidget(place, slider);
        }
        const QSignalBlocker still(slider);
        slider->setValue(int(std::lround(std::min(std::max(poses[std::size_t(row)].percent, 0.0), 100.0))));
    }
    if (int(poses.size()) > before)
        tracePlaces(*this);
}

void BendPoseList::nameLast() {
    const QModelIndex last = model()->index(model()->rowCount() - 1, Name);
    scrollTo(last);
    setCurrentIndex(last);
    edit(last);
}

#include "edit_fcd/bend/panel/moc_pose_list.cpp" // NOLINT(bugprone-suspicious-include)
