// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_POSE_LIST_H
#define FCD_BEND_POSE_LIST_H

#include <vector>

#include <QString>
#include <QTableWidget>

class QSlider;

/// A pose as the list shows it.
struct BendPoseRow {
    QString name, motions;
    double percent = 0;

    bool operator==(const BendPoseRow &other) const {
        return name == other.name && motions == other.motions && percent == other.percent;
    }
};

/// The list of poses, each with how much of it is shown: shows rows, and tells what a person does with one.
class BendPoseList : public QTableWidget {
    Q_OBJECT

  public:
    explicit BendPoseList(QWidget *parent = nullptr);
    void showRows(const std::vector<BendPoseRow> &rows);
    /// Lets a person type the name of the last one.
    void nameLast();

  signals:
    void chosen(int row);
    void removed(int row);
    void renamed(int row, QString name);
    void begins(); ///< before a percentage changes, once for each way of a slider
    void weighted(int row, double percent);

  private:
    QSlider *sliderOf(int row) const;
    void onChanged(int row, int column);
    void makeRow(int row);
    void showPercent(int row, double percent);

    enum Column { Name, Weight, Percent, Remove };
    std::vector<BendPoseRow> shown;
};

#endif
