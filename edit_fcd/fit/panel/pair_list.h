// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_PAIR_LIST_H
#define FCD_FIT_PAIR_LIST_H

#include <vector>

#include <QTableWidget>

/// A row of the list of pairs.
struct FitPairRow {
    QString name;
    bool hasSource = false, hasTarget = false, isSelected = false;

    bool operator==(const FitPairRow &other) const {
        return name == other.name && hasSource == other.hasSource && hasTarget == other.hasTarget &&
               isSelected == other.isSelected;
    }
};

/// The list of pairs of landmarks: shows rows, and tells what a person does with one.
class FitPairList : public QTableWidget {
    Q_OBJECT

  public:
    explicit FitPairList(QWidget *parent = nullptr);
    void showRows(const std::vector<FitPairRow> &rows);

  signals:
    void selected(int row);
    void removed(int row);
    void renamed(int row, QString name);

  private:
    enum Column { Name, Source, Target, Remove };
    std::vector<FitPairRow> shown;
};

#endif
