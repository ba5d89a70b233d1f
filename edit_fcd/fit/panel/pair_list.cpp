// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/panel/pair_list.h"

FitPairList::FitPairList(QWidget *parent)
    : CellList({{"Pair", "Click selects, double click: its name", 0},
                {"this", "Whether its place on this layer is given", 44},
                {"target", "Whether its place on the target is given", 52},
                {"", "Removes the pair", 22}},
               160, parent) {
    connect(this, &CellList::cellEdited, this, [this](int row, int, const QString &text) { emit renamed(row, text); });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(row);
        else
            emit selected(row);
    });
}

void FitPairList::show(const std::vector<FitPairRow> &pairs, int selected) {
    std::vector<Row> rows;
    rows.reserve(pairs.size());
    const auto centered = [](const QString &text) { return ListCell{text, {}, {}, {}, {}, true}; };
    for (const FitPairRow &each : pairs)
        rows.push_back({ListCell::edited(each.name), centered(each.hasSource ? "\u2713" : ""),
                        centered(each.hasTarget ? "\u2713" : ""), centered("\u2715")});
    showRows(std::move(rows), selected);
}

#include "edit_fcd/fit/panel/moc_pair_list.cpp" // NOLINT(bugprone-suspicious-include)
