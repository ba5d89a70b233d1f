// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/kit/cell_list.h"

#include <utility>

#include <QAbstractTableModel>
#include <QHeaderView>
#include <QPixmap>

class CellList::Model : public QAbstractTableModel {
  public:
    Model(std::vector<ListColumn> columns, CellList &list)
        : QAbstractTableModel(&list), list(list), columns(std::move(columns)) {}

    int rowCount(const QModelIndex &) const override { return int(rows.size()); }
    int columnCount(const QModelIndex &) const override { return int(columns.size()); }
    QVariant headerData(int section, Qt::Orientation, int role) const override {
        const ListColumn &column = columns[std::size_t(section)];
        return role == Qt::DisplayRole ? column.title : role == Qt::ToolTipRole ? column.tip : QVariant();
    }
    QVariant data(const QModelIndex &index, int role) const override {
        const ListCell &cell = at(index);
        switch (role) {
        case Qt::DisplayRole: return cell.text;
        case Qt::EditRole: return cell.typed.value_or(cell.text);
        case Qt::ToolTipRole: return cell.tip;
        case Qt::TextAlignmentRole: return cell.isCentered ? QVariant(int(Qt::AlignCenter)) : QVariant();
        case Qt::CheckStateRole:
            return cell.isChecked ? QVariant(*cell.isChecked ? Qt::Checked : Qt::Unchecked) : QVariant();
        case Qt::DecorationRole:
            if (cell.color.isValid()) {
                QPixmap square(12, 12);
                square.fill(cell.color);
                return square;
            }
        }
        return {};
    }
    Qt::ItemFlags flags(const QModelIndex &index) const override {
        return Qt::ItemIsEnabled | Qt::ItemIsSelectable | (at(index).typed ? Qt::ItemIsEditable : Qt::NoItemFlags);
    }
    /// Only signals the edit: the next showRows() shows its result.
    bool setData(const QModelIndex &index, const QVariant &value, int) override {
        list.isTold = value.toString() != at(index).typed;
        if (list.isTold)
            emit list.cellEdited(index.row(), index.column(), value.toString());
        return false;
    }

    void show(std::vector<Row> shown) {
        const int before = int(rows.size()), after = int(shown.size());
        if (after < before) {
            beginRemoveRows({}, after, before - 1);
            rows.resize(shown.size());
            endRemoveRows();
        }
        if (after > before) // other rows stay, with an open editor
            beginInsertRows({}, before, after - 1);
        rows = std::move(shown);
        if (after > before)
            endInsertRows();
        if (after > 0)
            emit dataChanged(index(0, 0), index(after - 1, int(columns.size()) - 1));
    }

    std::vector<Row> rows;

  private:
    const ListCell &at(const QModelIndex &index) const {
        return rows[std::size_t(index.row())][std::size_t(index.column())];
    }

    CellList &list;
    std::vector<ListColumn> columns;
};

CellList::CellList(const std::vector<ListColumn> &columns, int height, QWidget *parent)
    : QTableView(parent), cells(new Model(columns, *this)) {
    setModel(cells);
    verticalHeader()->hide();
    verticalHeader()->setDefaultSectionSize(22);
    setSelectionBehavior(QTableView::SelectRows);
    setSelectionMode(QTableView::SingleSelection);
    setEditTriggers(QTableView::DoubleClicked);
    setFocusPolicy(Qt::NoFocus); // keys stay with the view, except in a cell that is edited
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    setWordWrap(false);
    setFixedHeight(height);
    horizontalHeader()->setMinimumSectionSize(16);
    for (int i = 0; i < int(columns.size()); ++i) {
        const int width = columns[std::size_t(i)].width;
        horizontalHeader()->setSectionResizeMode(i, width ? QHeaderView::Fixed : QHeaderView::Stretch);
        if (width)
            setColumnWidth(i, width);
    }
    connect(this, &QTableView::clicked, this,
            [this](const QModelIndex &at) { emit cellClicked(at.row(), at.column()); });
}

bool CellList::showRows(std::vector<Row> rows, const std::optional<int> &selected) {
    if (state() == EditingState)
        return false;
    if (rows == cells->rows && selected == selection)
        return true;
    cells->show(std::move(rows));
    const bool isOther = std::exchange(selection, selected) != selected;
    if (selected)
        clearSelection();
    if (selected && *selected >= 0)
        selectRow(*selected);
    if (selected && *selected >= 0 && isOther)
        scrollTo(cells->index(*selected, 0));
    return true;
}

void CellList::closeEditor(QWidget *editor, QAbstractItemDelegate::EndEditHint hint) {
    QTableView::closeEditor(editor, hint);
    if (!std::exchange(isTold, false))
        emit editLeft();
}

#include "edit_fcd/kit/moc_cell_list.cpp" // NOLINT(bugprone-suspicious-include)
