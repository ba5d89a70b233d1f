// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_KEY_LIST_H
#define FCD_BEND_KEY_LIST_H

#include <vector>

#include <QString>
#include <QTableWidget>

/// A key frame as the list shows it.
struct BendKeyRow {
    double time = 0; ///< seconds
    int easing = 0;  ///< as vcg::fcd::Easing
    QString weights;

    bool operator==(const BendKeyRow &other) const {
        return time == other.time && easing == other.easing && weights == other.weights;
    }
};

/// The list of key frames: shows rows, and tells what a person does with one.
class BendKeyList : public QTableWidget {
    Q_OBJECT

  public:
    explicit BendKeyList(QWidget *parent = nullptr);
    void showRows(const std::vector<BendKeyRow> &rows);

  signals:
    void chosen(int row);
    void removed(int row);
    void edited(int row, double time, int easing);

  private:
    enum Column { Time, Easing, Weights, Remove };
    std::vector<BendKeyRow> shown;
};

#endif
