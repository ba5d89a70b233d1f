// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/panel/pair_list.h"

#include "edit_fcd/kit/tool_list.h"

#include <QSignalBlocker>

FitPairList::FitPairList(QWidget *parent) : QTableWidget(parent) {
    setUpList(*this, {{"Pair", "Click selects, double click: its name", 0},
                      {"this", "Whether its place on this layer is given", 44},
                      {"target", "Whether its place on the target is given", 52},
                      {"", "Removes the pair", 22}});
    setFixedHeight(160);
    connect(this, &QTableWidget::cellChanged, this, [this](int row, int column) {
        if (column != Name)
            return;
        shown[std::size_t(row)].name = item(row, Name)->text(); // until it is said what it is
        emit renamed(row, item(row, Name)->text());
    });
    connect(this, &QTableWidget::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(row);
        else
            emit selected(row);
    });
}

void FitPairList::showRows(const std::vector<FitPairRow> &rows) {
    if (rows == shown || state() == EditingState)
        return;
    shown = rows;
    const QSignalBlocker blocked(this);
    setRowCount(int(rows.size()));
    clearSelection();
    for (int i = 0; i < int(rows.size()); ++i) {
        const FitPairRow &row = rows[std::size_t(i)];
        const QString texts[] = {row.name, row.hasSource ? "\u2713" : "", row.hasTarget ? "\u2713" : "", "\u2715"};
        for (int column = Name; column <= Remove; ++column) {
            auto *cell = new QTableWidgetItem(texts[column]);
            if (column != Name) {
                cell->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable);
                cell->setTextAlignment(Qt::AlignCenter);
            }
            setItem(i, column, cell);
        }
        if (row.isSelected)
            selectRow(i);
    }
}

#include "edit_fcd/fit/panel/moc_pair_list.cpp" // NOLINT(bugprone-suspicious-include)
