// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/handle_list.h"

#include "edit_fcd/kit/tool_list.h"

#include <utility>

#include <QPixmap>
#include <QSignalBlocker>

namespace {

/// A motion, which is shorter as long as it is not edited.
class MotionItem : public QTableWidgetItem {
  public:
    MotionItem(const QString &text, QString shown) : QTableWidgetItem(text), shown(std::move(shown)) {
        setToolTip(text);
    }
    QVariant data(int role) const override { return role == Qt::DisplayRole ? shown : QTableWidgetItem::data(role); }

  private:
    QString shown;
};

} // namespace

BendHandleList::BendHandleList(QWidget *parent) : QTableWidget(parent) {
    setUpList(*this,
              {{"Handle", "Click selects: the gizmo is on it, and G, R and S move it. Double click: its name", 104},
               {"seen", "Whether its marks and its gizmo are shown", 38},
               {"lock", "A locked handle is not moved by the mouse, nor taken along by others", 38},
               {"Motion", "Its motion; double click to type it as the filters take it, empty for none", 0},
               {"", "Removes the handle: what it held is free", 22}});
    setWordWrap(false);
    setFixedHeight(116);
    connect(this, &QTableWidget::cellChanged, this, [this](int row, int) { onChanged(row); });
    connect(this, &QTableWidget::cellClicked, this, [this](int row, int column) {
        if (column == Remove) {
            emit removed(shown[std::size_t(row)].tag);
            return;
        }
        if (column == Shown || column == Locked) // beside the box, too
            item(row, column)->setCheckState(item(row, column)->checkState() ? Qt::Unchecked : Qt::Checked);
        emit selected(shown[std::size_t(row)].tag);
    });
}

void BendHandleList::onChanged(int row) {
    BendHandleRow &now = shown[std::size_t(row)]; // until it is said what it is
    now.name = item(row, Name)->text();
    now.motion = item(row, Motion)->data(Qt::EditRole).toString();
    emit edited(now.tag, now.name, now.motion, item(row, Shown)->checkState() == Qt::Checked,
                item(row, Locked)->checkState() == Qt::Checked);
}

void BendHandleList::showRows(const std::vector<BendHandleRow> &rows) {
    if (rows == shown || state() == EditingState)
        return;
    const QSignalBlocker blocked(this);
    shown = rows;
    setRowCount(int(rows.size()));
    for (int row = 0; row < rowCount(); ++row) {
        const BendHandleRow &each = rows[std::size_t(row)];
        const auto putItem = [&](int column, QTableWidgetItem *cell, Qt::ItemFlags flags) {
            cell->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | flags);
            setItem(row, column, cell);
            return cell;
        };
        const auto put = [&](int column, const QString &text, Qt::ItemFlags flags) {
            return putItem(column, new QTableWidgetItem(text), flags);
        };
        QPixmap square(12, 12);
        square.fill(each.color);
        put(Name, each.name, Qt::ItemIsEditable)->setIcon(QIcon(square));
        put(Shown, {}, {})->setCheckState(each.isShown ? Qt::Checked : Qt::Unchecked);
        put(Locked, {}, {})->setCheckState(each.isLocked ? Qt::Checked : Qt::Unchecked);
        putItem(Motion, new MotionItem(each.motion, each.shortMotion), Qt::ItemIsEditable);
        put(Remove, QString(QChar(0xd7)), {});
        if (each.isSelected)
            selectRow(row);
    }
}

#include "edit_fcd/bend/panel/moc_handle_list.cpp" // NOLINT(bugprone-suspicious-include)
