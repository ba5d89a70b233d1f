// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_PAIR_LIST_H
#define FCD_FIT_PAIR_LIST_H

#include "edit_fcd/kit/cell_list.h"

/// A row of the list of pairs.
struct FitPairRow {
    QString name;
    bool hasSource = false, hasTarget = false;
};

/// The list of pairs of landmarks.
class FitPairList : public CellList {
    Q_OBJECT

  public:
    explicit FitPairList(QWidget *parent = nullptr);
    void show(const std::vector<FitPairRow> &pairs, int selected);

  signals:
    void selected(int row);
    void removed(int row);
    void renamed(int row, QString name);

  private:
    enum Column { Name, Source, Target, Remove };
};

#endif
