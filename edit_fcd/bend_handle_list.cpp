// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_handle_list.h"

#include "tool_list.h"

#include <QPixmap>
#include <QSignalBlocker>

BendHandleList::BendHandleList(QWidget *parent) : QTableWidget(parent) {
    setUpList(*this,
              {{"Handle", "Click selects: the gizmo is on it, and G, R and S move it. Double click: its name", 104},
               {"seen", "Whether its marks and its gizmo are shown", 38},
               {"lock", "A locked handle is not moved by the mouse", 38},
               {"Motion", "Its motion as the filters take it; double click to type, empty for none", 0},
               {"", "Removes the handle: what it held is free", 22}});
    setWordWrap(false);
    setFixedHeight(116);
    connect(this, &QTableWidget::cellChanged, this, [this](int row, int) { onChanged(row); });
    connect(this, &QTableWidget::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(shown[std::size_t(row)].tag);
        else
            emit selected(shown[std::size_t(row)].tag);
    });
}

void BendHandleList::onChanged(int row) {
    const BendHandleRow before = shown[std::size_t(row)];
    emit edited(before.tag, item(row, Name)->text(), item(row, Motion)->text(),
                item(row, Shown)->checkState() == Qt::Checked, item(row, Locked)->checkState() == Qt::Checked);
}

void BendHandleList::showRows(const std::vector<BendHandleRow> &rows) {
    if (rows == shown || state() == EditingState)
        return;
    const QSignalBlocker blocked(this);
    shown = rows;
    setRowCount(int(rows.size()));
    for (int row = 0; row < rowCount(); ++row) {
        const BendHandleRow &each = rows[std::size_t(row)];
        const auto put = [&](int column, const QString &text, Qt::ItemFlags flags) {
            auto *cell = new QTableWidgetItem(text);
            cell->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | flags);
            setItem(row, column, cell);
            return cell;
        };
        QPixmap square(12, 12);
        square.fill(each.color);
        put(Name, each.name, Qt::ItemIsEditable)->setIcon(QIcon(square));
        put(Shown, {}, Qt::ItemIsUserCheckable)->setCheckState(each.isShown ? Qt::Checked : Qt::Unchecked);
        put(Locked, {}, Qt::ItemIsUserCheckable)->setCheckState(each.isLocked ? Qt::Checked : Qt::Unchecked);
        put(Motion, each.motion, Qt::ItemIsEditable)->setToolTip(each.motion);
        put(Remove, QString(QChar(0xd7)), {});
        if (each.isSelected)
            selectRow(row);
    }
}

#include "moc_bend_handle_list.cpp" // NOLINT(bugprone-suspicious-include)
