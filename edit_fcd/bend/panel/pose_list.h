// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_POSE_LIST_H
#define FCD_BEND_POSE_LIST_H

#include "edit_fcd/kit/cell_list.h"

/// A pose as the list shows it.
struct BendPoseRow {
    QString name, motions;
    double percent = 0;
};

/// The list of poses, each with how much of it is shown.
class BendPoseList : public CellList {
    Q_OBJECT

  public:
    explicit BendPoseList(QWidget *parent = nullptr);
    void show(const std::vector<BendPoseRow> &poses);
    /// Lets a person type the name of the last one.
    void nameLast();

  signals:
    void chosen(int row);
    void removed(int row);
    void renamed(int row, QString name);
    void begins(); ///< before a percentage changes, once for each way of a slider
    void weighted(int row, double percent);

  private:
    enum Column { Name, Weight, Percent, Remove };
};

#endif
