// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/handle_list.h"

#include <algorithm>

#include <QHeaderView>

BendHandleList::BendHandleList(QWidget *parent)
    : CellList({{"Handle", "Click selects: the gizmo is on it, and G, R and S move it. Double click: its name", 104},
                {"seen", "Whether its marks and its gizmo are shown", 38},
                {"lock", "A locked handle is not moved by the mouse, nor taken along by others", 38},
                {"Motion", "Its motion; double click to type it as the filters take it, empty for none", 0},
                {"", "Removes the handle: what it held is free", 22}},
               78, parent) {
    setObjectName("handles");
    setWordWrap(true); // a motion may have several steps
    connect(this, &CellList::cellEdited, this, [this](int row, int column, const QString &text) {
        BendHandleRow to = shown[std::size_t(row)];
        (column == Name ? to.name : to.motion) = text;
        emit edited(to);
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        BendHandleRow to = shown[std::size_t(row)];
        if (column == Remove) {
            emit removed(to.tag);
            return;
        }
        if (column == Shown || column == Locked) {
            bool &is = column == Shown ? to.isShown : to.isLocked;
            is = !is;
            emit edited(to);
        }
        emit selected(to.tag);
    });
}

void BendHandleList::show(const std::vector<BendHandleRow> &handles) {
    std::vector<Row> rows;
    int chosen = -1;
    for (const BendHandleRow &each : handles) {
        if (each.isSelected)
            chosen = int(rows.size());
        ListCell name = ListCell::edited(each.name), isShown, isLocked;
        name.color = each.color;
        isShown.isChecked = each.isShown;
        isLocked.isChecked = each.isLocked;
        rows.push_back({name,
                        isShown,
                        isLocked,
                        {each.shortMotion, each.motion, each.motion, {}, {}, false},
                        {QString(QChar(0xd7)), {}, {}, {}, {}, false}});
    }
    if (!showRows(std::move(rows), chosen))
        return;
    shown = handles;
    for (int row = 0; row < int(handles.size()); ++row)
        setRowHeight(row, std::max(verticalHeader()->defaultSectionSize(), sizeHintForRow(row)));
}

#include "edit_fcd/bend/panel/moc_handle_list.cpp" // NOLINT(bugprone-suspicious-include)
