// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/lists.h"
#include "edit_fcd/kit/tool_window.h"

#include <algorithm>
#include <cmath>

#include <QGridLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QSignalBlocker>
#include <QSlider>

BendHandleList::BendHandleList(QWidget *parent)
    : CellList({{"Handle", "Click selects: the gizmo is on it, and G, R and S move it. Double click: its name", 104},
                {"seen", "Shows its marks and its gizmo", 38},
                {"lock", "The mouse does not move a locked handle, nor do other handles take it along", 38},
                {"Motion", "Its motion; double click to type it as the filters take it, empty for none", 0},
                {"", "Removes the handle: its region is free", 22}},
               78, parent) {
    setObjectName("handles");
    setWordWrap(true); // a motion may have several steps
    connect(this, &CellList::cellEdited, this, [this](int row, int column, const QString &text) {
        BendHandleRow to = shown[std::size_t(row)];
        (column == Name ? to.name : to.motion) = text;
        emit edited(to);
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        BendHandleRow to = shown[std::size_t(row)];
        if (column == Remove) {
            emit removed(to.tag);
            return;
        }
        if (column == Shown || column == Locked) {
            bool &is = column == Shown ? to.isShown : to.isLocked;
            is = !is;
            emit edited(to);
        }
        emit selected(to.tag);
    });
}

void BendHandleList::show(const std::vector<BendHandleRow> &handles) {
    std::vector<Row> rows;
    int chosen = -1;
    for (const BendHandleRow &each : handles) {
        if (each.isSelected)
            chosen = int(rows.size());
        ListCell name = ListCell::edited(each.name), isShown, isLocked;
        name.color = each.color;
        isShown.isChecked = each.isShown;
        isLocked.isChecked = each.isLocked;
        rows.push_back({name, isShown, isLocked, {each.shortMotion, each.motion, each.motion}, {QChar(0xd7)}});
    }
    if (!showRows(std::move(rows), chosen))
        return;
    shown = handles;
    for (int row = 0; row < int(handles.size()); ++row)
        setRowHeight(row, std::max(verticalHeader()->defaultSectionSize(), sizeHintForRow(row)));
}

BendPoseList::BendPoseList(QWidget *parent)
    : CellList({{"Pose", "Click shows this pose alone; double click: its name", 0},
                {"strength", "How much of it you see, mixed with the others", 110},
                {"%", "The same as a number, also below 0 or above 100; double click to type", 44},
                {"", "Removes the pose", 22}},
               72, parent) {
    connect(this, &CellList::cellEdited, this, [this](int row, int column, const QString &text) {
        if (column == Name) {
            emit renamed(row, text);
        } else if (const std::optional<double> percent = typedNumber(text)) {
            emit begins();
            emit weighted(row, *percent);
        }
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        if (column == Remove)
            emit removed(row);
        else if (column == Name)
            emit chosen(row);
    });
}

void BendPoseList::show(const std::vector<BendPoseRow> &poses) {
    std::vector<Row> rows;
    for (const BendPoseRow &each : poses) {
        ListCell name = ListCell::edited(each.name);
        name.tip = each.motions;
        rows.push_back({name, {}, ListCell::edited(QString::number(each.percent, 'g', 4)), {QChar(0xd7)}});
    }
    const int before = model()->rowCount();
    if (!showRows(std::move(rows)))
        return;
    for (int row = 0; row < int(poses.size()); ++row) {
        const QModelIndex place = model()->index(row, Weight);
        auto *slider = static_cast<QSlider *>(indexWidget(place)); // kept, since the user may be dragging it
        if (!slider) {
            slider = named(new QSlider(Qt::Horizontal), QString("weight%1").arg(row), "");
            slider->setRange(0, 100);
            connectSlider(
                *slider, [this] { emit begins(); }, [this, row](int percent) { emit weighted(row, percent); });
            setIndexWidget(place, slider);
        }
        const QSignalBlocker still(slider);
        slider->setValue(int(std::lround(std::min(std::max(poses[std::size_t(row)].percent, 0.0), 100.0))));
    }
    if (int(poses.size()) > before)
        tracePlaces(*this);
}

void BendPoseList::nameLast() {
    const QModelIndex last = model()->index(model()->rowCount() - 1, Name);
    scrollTo(last);
    setCurrentIndex(last);
    edit(last);
}

const char *const easings[] = {"linear", "smooth", "hold"}; // in the order of Easing
const int easingCount = 3;

BendKeyList::BendKeyList(QWidget *parent)
    : CellList({{"time, s", "When the layer is there; double click to type", 56},
                {"easing", "How it goes on to the next key frame: linear, smooth or hold. A click changes it", 62},
                {"key frame", "The poses that it has; a click shows it", 0},
                {"", "Removes the key frame", 22}},
               72, parent) {
    connect(this, &CellList::cellEdited, this, [this](int row, int, const QString &text) {
        const BendKeyRow &at = shown[std::size_t(row)];
        emit edited(row, typedNumber(text).value_or(at.time), at.easing);
    });
    connect(this, &CellList::cellClicked, this, [this](int row, int column) {
        const BendKeyRow &at = shown[std::size_t(row)];
        if (column == Remove)
            emit removed(row);
        else if (column == Easing)
            emit edited(row, at.time, (at.easing + 1) % easingCount);
        else if (column == Weights)
            emit chosen(row);
    });
}

void BendKeyList::show(const std::vector<BendKeyRow> &keys, int selected) {
    std::vector<Row> rows;
    for (const BendKeyRow &each : keys) {
        Row row;
        for (const QString &text :
             {QString::number(each.time, 'g', 6), QString(easings[each.easing]), each.weights, QString(QChar(0xd7))})
            row.push_back({text, text});
        row[Time].typed = row[Time].text;
        rows.push_back(std::move(row));
    }
    if (showRows(std::move(rows), selected))
        shown = keys;
}

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
    files->addWidget(made("keep", "Keep pose",
                          "Keeps the shape that you see as a named pose of the layer: type the name, then Enter",
                          Keep));
    files->addWidget(made("frame", "Key frame",
                          "Makes a key frame of the blend that you see, a second after the last one", KeyFrame));
    files->addWidget(made("loadposes", "Load ...",
                          "Replaces the poses by those of a table (.csv), as 'FCD: Pose Sequence' reads it", Load));
    files->addWidget(made("saveposes", "Save ...",
                          "Writes the poses as a table (.csv): MeshLab's own files cannot hold them", Save));
    frames = named(new BendKeyList, "frames", "");
    grid->addWidget(frames, 2, 0);
    auto *last = row(3);
    play = made("play", "Play", "Plays the key frames in the view, until you do something else", Play);
    play->setFixedWidth(play->fontMetrics().horizontalAdvance("Stop") + 24);
    last->addWidget(play);
    bar = new BendTimeline;
    last->addWidget(bar, 1);
    last->addWidget(made(
        "export", "Export ...",
        "Makes glTF (.glb) for Blender and web pages, a point cache (.pc2, .mdd), or a layer for each frame", Export));
}

#include "edit_fcd/bend/panel/moc_lists.cpp" // NOLINT(bugprone-suspicious-include)
