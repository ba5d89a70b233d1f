// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ACTIONS_H
#define FCD_BEND_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// What a key does in the view.
struct BendAction {
    // clang-format off
    enum Id {
        Drag, Pull, Brush, Rectangle, Polyline, Line, RemovePoint, Fixed, Free, Handle, NextHandle, Outside, Through,
        Move, Turn, Scale, Limb, Pivot, Undo, Redo, Reset, Cancel, End, ApplyInPlace, ApplyToNewLayer, Page
    };
    // clang-format on
};

const ActionTable &bendActions();
QString bendKeyPage(); ///< HTML

#endif
