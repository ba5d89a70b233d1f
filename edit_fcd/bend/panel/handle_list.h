// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_HANDLE_LIST_H
#define FCD_BEND_HANDLE_LIST_H

#include <vector>

#include <QColor>
#include <QString>
#include <QTableWidget>

/// A handle as the list shows it.
struct BendHandleRow {
    int tag = 0;
    QString name;
    QString motion, shortMotion; ///< as it is typed, and as it is shown
    QColor color;
    bool isShown = true, isLocked = false, isSelected = false;

    bool operator==(const BendHandleRow &other) const {
        return tag == other.tag && name == other.name && motion == other.motion && shortMotion == other.shortMotion &&
               color == other.color && isShown == other.isShown && isLocked == other.isLocked &&
               isSelected == other.isSelected;
    }
};

/// The list of handles: shows rows, and tells what a person does with one.
class BendHandleList : public QTableWidget {
    Q_OBJECT

  public:
    explicit BendHandleList(QWidget *parent = nullptr);
    void showRows(const std::vector<BendHandleRow> &rows);

  signals:
    void selected(int tag);
    void removed(int tag);
    void edited(int tag, QString name, QString motion, bool isShown, bool isLocked);

  private:
    void onChanged(int row);

    enum Column { Name, Shown, Locked, Motion, Remove };
    std::vector<BendHandleRow> shown;
};

#endif
