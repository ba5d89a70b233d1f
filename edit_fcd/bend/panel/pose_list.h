// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_POSE_LIST_H
#define FCD_BEND_POSE_LIST_H

#include "edit_fcd/kit/cell_list.h"

/// A pose as the list shows it.
struct BendPoseRow {
    QString name, motions;
    double percent = 0;
};

/// The list of poses, each with its weight.
class BendPoseList : public CellList {
    Q_OBJECT

  public:
    explicit BendPoseList(QWidget *parent = nullptr);
    void show(const std::vector<BendPoseRow> &poses);
    /// Opens the editor for the name of the last pose.
    void nameLast();

  signals:
    void chosen(int row);
    void removed(int row);
    void renamed(int row, QString name);
    void begins(); ///< once before a weight's slider is moved
    void weighted(int row, double percent);

  private:
    enum Column { Name, Weight, Percent, Remove };
};

#endif
