// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/pose_box.h"

#include <QGridLayout>
#include <QHBoxLayout>
#include <QPushButton>

BendPoseBox::BendPoseBox(QWidget *parent) : QWidget(parent) {
    auto *grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(3);
    poses = new BendPoseList;
    poses->setObjectName("poses");
    grid->addWidget(poses, 0, 0, 1, 3);
    const auto made = [&](const char *name, const QString &text, const QString &tip, Command which) {
        auto *button = new QPushButton(text);
        button->setObjectName(name);
        button->setToolTip(tip);
        button->setFocusPolicy(Qt::NoFocus);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        return button;
    };
    grid->addWidget(
        made("keep", "Keep pose", "The layer keeps what is shown as a pose that has a name: type it, then Enter", Keep),
        1, 0);
    grid->addWidget(
        made("loadposes", "Load ...",
             "Poses of a table (.csv), as 'FCD: Pose Sequence' has it, take the place of those that there are", Load),
        1, 1);
    grid->addWidget(
        made("saveposes", "Save ...", "Writes the poses as a table (.csv): no file of MeshLab has room for them", Save),
        1, 2);
    frames = new BendKeyList;
    frames->setObjectName("frames");
    grid->addWidget(frames, 2, 0, 1, 3);
    auto *last = new QHBoxLayout;
    last->addWidget(made("frame", "Key frame",
                         "What is shown of the poses becomes a key frame, a second after the last one", KeyFrame));
    play = made("play", "Play", "Plays the key frames in the view, until something else is done", Play);
    last->addWidget(play);
    last->addWidget(made("export", "Export animation ...",
                         "Writes the key frames as glTF (.glb) for Blender and web pages, or as a point cache (.pc2)",
                         Export));
    grid->addLayout(last, 3, 0, 1, 3);
}

#include "edit_fcd/bend/panel/moc_pose_box.cpp" // NOLINT(bugprone-suspicious-include)
