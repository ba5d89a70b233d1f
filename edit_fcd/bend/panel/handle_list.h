// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_HANDLE_LIST_H
#define FCD_BEND_HANDLE_LIST_H

#include "edit_fcd/kit/cell_list.h"

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

#endif
