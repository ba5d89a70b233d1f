// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_KEY_LIST_H
#define FCD_BEND_KEY_LIST_H

#include "edit_fcd/kit/cell_list.h"

/// A key frame as the list shows it.
struct BendKeyRow {
    double time = 0; ///< seconds
    int easing = 0;  ///< as vcg::fcd::Easing
    QString weights;
};

/// The list of key frames.
class BendKeyList : public CellList {
    Q_OBJECT

  public:
    explicit BendKeyList(QWidget *parent = nullptr);
    /// \param selected row that is shown in the view, -1: none
    void show(const std::vector<BendKeyRow> &keys, int selected);

  signals:
    void chosen(int row);
    void removed(int row);
    void edited(int row, double time, int easing);

  private:
    enum Column { Time, Easing, Weights, Remove };
    std::vector<BendKeyRow> shown;
};

#endif
