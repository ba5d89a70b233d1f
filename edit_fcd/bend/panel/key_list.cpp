// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/key_list.h"

#include "edit_fcd/kit/tool_list.h"

#include <cmath>

#include <QSignalBlocker>

namespace {

const char *const easings[] = {"linear", "smooth", "hold"}; // in the order of Easing
const int easingCount = 3;

} // namespace

BendKeyList::BendKeyList(QWidget *parent) : QTableWidget(parent) {
    setUpList(*this,
              {{"time, s", "When it is reached; double click to type", 56},
               {"then",
                "How it goes on from there, up to the next one: linear, smooth, or hold. A click is the next one", 62},
               {"key frame", "The poses that it has; a click shows it", 0},
               {"", "Removes the key frame", 22}});
    setFixedHeight(100);
    connect(this, &QTableWidget::cellChanged, this, [this](int row, int column) {
        const BendKeyRow before = shown[std::size_t(row)];
        shown[std::size_t(row)].time = std::nan(""); // until it is said what it is
        emit edited(row, typedNumber(item(row, column)->text()).value_or(before.time), before.easing);
    });
    connect(this, &QTableWidget::cellClicked, this, [this](int row, int column) {
        const BendKeyRow &at = shown[std::size_t(row)];
        if (column == Remove)
            emit removed(row);
        else if (column == Easing)
            emit edited(row, at.time, (at.easing + 1) % easingCount);
        else if (column == Weights)
            emit chosen(row);
    });
}

void BendKeyList::showRows(const std::vector<BendKeyRow> &rows) {
    if (rows == shown || state() == EditingState)
        return;
    const QSignalBlocker blocked(this);
    shown = rows;
    setRowCount(int(rows.size()));
    for (int i = 0; i < rowCount(); ++i) {
        const BendKeyRow &row = rows[std::size_t(i)];
        const QString texts[] = {QString::number(row.time, 'g', 6), easings[row.easing], row.weights,
                                 QString(QChar(0xd7))};
        for (int column = Time; column <= Remove; ++column) {
            if (!item(i, column))
                setItem(i, column, new QTableWidgetItem);
            item(i, column)->setText(texts[column]);
            item(i, column)->setToolTip(texts[column]);
            item(i, column)->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable |
                                      (column == Time ? Qt::ItemIsEditable : Qt::ItemFlags()));
        }
    }
}

#include "edit_fcd/bend/panel/moc_key_list.cpp" // NOLINT(bugprone-suspicious-include)
