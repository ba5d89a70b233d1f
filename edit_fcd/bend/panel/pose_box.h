// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_POSE_BOX_H
#define FCD_BEND_POSE_BOX_H

#include "edit_fcd/bend/panel/lists.h"
#include "edit_fcd/bend/panel/timeline.h"

#include <QPushButton>
#include <QWidget>

/// The part of the panel for named poses.
class BendPoseBox : public QWidget {
    Q_OBJECT

  public:
    enum Command { Keep, Load, Save, KeyFrame, Play, Export };

    explicit BendPoseBox(QWidget *parent = nullptr);
    BendPoseList &list() { return *poses; }
    BendKeyList &keys() { return *frames; }
    BendTimeline &timeline() { return *bar; }
    void showPlaying(bool isPlaying) { play->setText(isPlaying ? "Stop" : "Play"); }

  signals:
    void command(int which);

  private:
    BendPoseList *poses;
    BendKeyList *frames;
    BendTimeline *bar;
    QPushButton *play;
};

#endif
