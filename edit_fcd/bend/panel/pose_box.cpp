// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/pose_box.h"

#include <QGridLayout>
#include <QPushButton>

BendPoseBox::BendPoseBox(QWidget *parent) : QWidget(parent) {
    auto *grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(3);
    poses = new BendPoseList;
    poses->setObjectName("poses");
    grid->addWidget(poses, 0, 0, 1, 3);
    const auto add = [&](const char *name, const QString &text, const QString &tip, Command which, int row,
                         int column) {
        auto *button = new QPushButton(text);
        button->setObjectName(name);
        button->setToolTip(tip);
        button->setFocusPolicy(Qt::NoFocus);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        grid->addWidget(button, row, column);
        return button;
    };
    add("keep", "Keep pose", "The layer keeps what is shown as a pose that has a name: type it, then Enter", Keep, 1,
        0);
    add("loadposes", "Load ...",
        "Poses of a table (.csv), as 'FCD: Pose Sequence' has it, take the place of those that there are", Load, 1, 1);
    add("saveposes", "Save ...", "Writes the poses as a table (.csv): no file of MeshLab has room for them", Save, 1,
        2);
    frames = new BendKeyList;
    frames->setObjectName("frames");
    grid->addWidget(frames, 2, 0, 1, 3);
    add("frame", "Key frame", "What is shown of the poses becomes a key frame, a second after the last one", KeyFrame,
        3, 0);
    play = add("play", "Play", "Plays the key frames in the view, until something else is done", Play, 3, 1);
}

#include "edit_fcd/bend/panel/moc_pose_box.cpp" // NOLINT(bugprone-suspicious-include)
