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
    int width; ///< pixels; 0: what the others leave
};

struct ListCell {
    QString text, tip;
    std::optional<QString> typed;  ///< how a person edits it; none: it is not edited
    std::optional<bool> isChecked; ///< with a box
    QColor color;                  ///< of a square before the text; invalid: none
    bool isCentered = false;

    static ListCell edited(const QString &text) { return {text, {}, text, {}, {}, false}; }
    bool operator==(const ListCell &other) const {
        return text == other.text && tip == other.tip && typed == other.typed && isChecked == other.isChecked &&
               color == other.color && isCentered == other.isCentered;
    }
};

/// A list in a panel: shows rows of cells, of which one is selected, and tells what a person does with them; a double
/// click edits. What it shows is what it was given last: an edit that was refused is seen to be.
class CellList : public QTableView {
    Q_OBJECT

  public:
    using Row = std::vector<ListCell>;

    CellList(const std::vector<ListColumn> &columns, int height, QWidget *parent);
    /// \param selected row, -1: none; null: as it is \return false: a cell is edited, and nothing else is shown
    bool showRows(std::vector<Row> rows, const std::optional<int> &selected = {});

  signals:
    void cellClicked(int row, int column);
    void cellEdited(int row, int column, QString text);
    void editLeft(); ///< without a change

  protected:
    void closeEditor(QWidget *editor, QAbstractItemDelegate::EndEditHint hint) override;

  private:
    class Model;
    Model *cells;
    std::optional<int> selection;
    bool isTold = false; ///< what was edited
};

#endif
