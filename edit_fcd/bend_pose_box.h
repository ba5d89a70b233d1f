// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_POSE_BOX_H
#define FCD_BEND_POSE_BOX_H

#include "bend_pose_list.h"

#include <QWidget>

/// What the panel has for poses that have names.
class BendPoseBox : public QWidget {
    Q_OBJECT

  public:
    enum Command { Keep, Load, Save };

    explicit BendPoseBox(QWidget *parent = nullptr);
    BendPoseList &list() { return *poses; }

  signals:
    void command(int which);

  private:
    BendPoseList *poses;
};

#endif
