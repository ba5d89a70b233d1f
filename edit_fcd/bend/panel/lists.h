// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_LISTS_H
#define FCD_BEND_LISTS_H

#include "edit_fcd/bend/panel/timeline.h"
#include "edit_fcd/kit/cell_list.h"

#include <QPushButton>
#include <QWidget>

/// A handle as the list shows it.
struct BendHandleRow {
    int tag = 0;
    QString name;
    QString motion, shortMotion; ///< for the editor, and for display
    QColor color;
    bool isShown = true, isLocked = false, isSelected = false;
};

/// The list of handles.
class BendHandleList : public CellList {
    Q_OBJECT

  public:
    explicit BendHandleList(QWidget *parent = nullptr);
    void show(const std::vector<BendHandleRow> &handles);

  signals:
    void selected(int tag);
    void removed(int tag);
    void edited(BendHandleRow to); ///< the edited row

  private:
    enum Column { Name, Shown, Locked, Motion, Remove };
    std::vector<BendHandleRow> shown;
};

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
