// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ACTIONS_H
#define FCD_BEND_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// The actions of keys in the view and of the panel's buttons.
struct BendAction {
    // clang-format off
    enum Id {
        Drag, Pull, Brush, Rectangle, Polyline, Line, // in the order of BendPanel::Mode
        RemovePoint, Fixed, Free, Handle, NextHandle, Outside, Through,
        Move, Turn, Scale, Limb, // in the order of BendDrag::Kind
        Pivot, Undo, Redo, Reset, Cancel, End, ApplyInPlace, ApplyToNewLayer, Page,
        MarkSelection, ClearMarks, TakeMotions, SaveSession, LoadSession // without a key
    };
    // clang-format on
};

const ActionTable &bendActions();
QString bendKeyPage(); ///< HTML

#endif
