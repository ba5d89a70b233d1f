// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/key_list.h"

#include "edit_fcd/kit/tool_list.h"

namespace {

const char *const easings[] = {"linear", "smooth", "hold"}; // in the order of Easing
const int easingCount = 3;

} // namespace

BendKeyList::BendKeyList(QWidget *parent)
    : CellList({{"time, s", "When it is reached; double click to type", 56},
                {"easing", "How it goes on to the next key frame: linear, smooth or hold. A click changes it", 62},
                {"key frame", "The poses that it has; a click shows it", 0},
                {"", "Removes the key frame", 22}},
               72, parent) {
    connect(this, &CellList::cellEdited, this, [this](int row, int, const QString &text) {
        const BendKeyRow &at = shown[std::size_t(row)];
        emit edited(row, typedNumber(text).value_or(at.time), at.easing);
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        const BendKeyRow &at = shown[std::size_t(row)];
        if (column == Remove)
            emit removed(row);
        else if (column == Easing)
            emit edited(row, at.time, (at.easing + 1) % easingCount);
        else if (column == Weights)
            emit chosen(row);
    });
}

void BendKeyList::show(const std::vector<BendKeyRow> &keys, int selected) {
    std::vector<Row> rows;
    for (const BendKeyRow &each : keys) {
        Row row;
        for (const QString &text :
             {QString::number(each.time, 'g', 6), QString(easings[each.easing]), each.weights, QString(QChar(0xd7))})
            row.push_back({text, text, {}, {}, {}, false});
        row[Time].typed = row[Time].text;
        rows.push_back(std::move(row));
    }
    if (showRows(std::move(rows), selected))
        shown = keys;
}

#include "edit_fcd/bend/panel/moc_key_list.cpp" // NOLINT(bugprone-suspicious-include)
