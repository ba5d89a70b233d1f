// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/pose_box.h"

#include "edit_fcd/kit/tool_list.h"

#include <QGridLayout>
#include <QHBoxLayout>

BendPoseBox::BendPoseBox(QWidget *parent) : QWidget(parent) {
    auto *grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setSpacing(3);
    poses = named(new BendPoseList, "poses", "");
    grid->addWidget(poses, 0, 0);
    const auto made = [&](const char *name, const QString &text, const QString &tip, Command which) {
        auto *button = named(new QPushButton(text), name, tip);
        connect(button, &QPushButton::clicked, this, [this, which] { emit command(which); });
        return button;
    };
    const auto row = [&](int at) {
        auto *made = new QHBoxLayout;
        made->setSpacing(3);
        grid->addLayout(made, at, 0);
        return made;
    };
    auto *files = row(1);
    files->addWidget(
        made("keep", "Keep pose", "Keeps what is shown as a named pose of the layer: type the name, then Enter", Keep));
    files->addWidget(made("frame", "Key frame",
                          "Makes a key frame of what is shown of the poses, a second after the last one", KeyFrame));
    files->addWidget(made("loadposes", "Load ...",
                          "Replaces the poses by those of a table (.csv), as 'FCD: Pose Sequence' reads it", Load));
    files->addWidget(made("saveposes", "Save ...",
                          "Writes the poses as a table (.csv): no file of MeshLab has room for them", Save));
    frames = named(new BendKeyList, "frames", "");
    grid->addWidget(frames, 2, 0);
    auto *last = row(3);
    play = made("play", "Play", "Plays the key frames in the view, until something else is done", Play);
    play->setFixedWidth(play->fontMetrics().horizontalAdvance("Stop") + 24);
    last->addWidget(play);
    bar = new BendTimeline;
    last->addWidget(bar, 1);
    last->addWidget(made(
        "export", "Export ...",
        "Makes glTF (.glb) for Blender and web pages, a point cache (.pc2, .mdd), or a layer for each frame", Export));
}

#include "edit_fcd/bend/panel/moc_pose_box.cpp" // NOLINT(bugprone-suspicious-include)
