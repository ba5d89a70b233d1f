// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_ACTION_TABLE_H
#define FCD_ACTION_TABLE_H

#include <utility>
#include <vector>

#include <QKeyEvent>
#include <QString>

/// What the keys of a tool do in its view. Keys, tool tips and the page of keys come from this one table.
class ActionTable {
  public:
    struct Row {
        int action;            ///< as the tool numbers them
        const char *keys;      ///< one, or several separated by bars
        const char *text = ""; ///< for the page of keys
    };
    ActionTable(std::initializer_list<Row> rows) : rows(rows) {}

    /// The row of a key, null if it has none.
    const Row *of(const QKeyEvent &event) const;
    /// A tool tip that ends with the keys of an action.
    QString withKeys(const QString &tip, int action) const;
    /// The page of keys, HTML. \param more additional rows: keys and texts
    QString page(const std::vector<std::pair<QString, QString>> &more) const;

  private:
    std::vector<Row> rows;
};

#endif
