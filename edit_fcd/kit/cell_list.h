// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CELL_LIST_H
#define FCD_CELL_LIST_H

#include <optional>
#include <vector>

#include <QColor>
#include <QString>
#include <QTableView>

/// A column of a list.
struct ListColumn {
    QString title, tip;
    int width; ///< pixels; 0: the rest of the width
};

struct ListCell {
    QString text{}, tip{};
    std::optional<QString> typed = std::nullopt;  ///< the text in its editor; none: it cannot be edited
    std::optional<bool> isChecked = std::nullopt; ///< of its box; none: no box
    QColor color{};                               ///< of a square before the text; invalid: none
    bool isCentered = false;

    static ListCell edited(const QString &text) { return {text, {}, text}; }
    bool operator==(const ListCell &o) const {
        return text == o.text && tip == o.tip && typed == o.typed && isChecked == o.isChecked && color == o.color &&
               isCentered == o.isCentered;
    }
};

/// A list in a panel, with one selected row. It signals clicks and edits (by a double click), and always shows what
/// showRows() got last: so a refused edit disappears.
class CellList : public QTableView {
    Q_OBJECT

  public:
    using Row = std::vector<ListCell>;

    CellList(const std::vector<ListColumn> &columns, int height, QWidget *parent);
    /// \param selected row; -1: none; null: as before \return false: a cell is being edited, so nothing changes
    bool showRows(std::vector<Row> rows, const std::optional<int> &selected = {});

  signals:
    void cellClicked(int row, int column);
    void cellEdited(int row, int column, QString text);
    void editLeft(); ///< an editor was closed without a change

  protected:
    void closeEditor(QWidget *editor, QAbstractItemDelegate::EndEditHint hint) override;

  private:
    class Model;
    Model *cells;
    std::optional<int> selection;
    bool isTold = false; ///< cellEdited() was sent for the open editor
};

#endif
