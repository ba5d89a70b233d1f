// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_ACTION_TABLE_H
#define FCD_ACTION_TABLE_H

#include <utility>
#include <vector>

#include <QKeyEvent>
#include <QString>

/// What the keys of a tool do in its view: one table, so that the keys, the tool tips and the page of keys say the
/// same.
class ActionTable {
  public:
    struct Row {
        int action;            ///< as the tool numbers them
        const char *keys;      ///< one, or several with a bar between
        const char *text = ""; ///< for the page of keys
    };
    ActionTable(std::initializer_list<Row> rows) : rows(rows) {}

    /// What a key does, null if it is not in the table.
    const Row *of(const QKeyEvent &event) const;
    /// A tool tip with the keys of an action after it.
    QString withKeys(const QString &tip, int action) const;
    /// The page of keys, HTML. \param more rows of it, keys and texts
    QString page(const std::vector<std::pair<QString, QString>> &more) const;

  private:
    std::vector<Row> rows;
};

#endif
