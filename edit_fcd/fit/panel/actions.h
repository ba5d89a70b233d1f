// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_ACTIONS_H
#define FCD_FIT_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// The actions of keys in the view and of the panel's buttons.
struct FitAction {
    // clang-format off
    enum Id {
        Undo, Redo, Remove, Reset, Pull, Cancel,
        InTurn, Both, Source, Target, // in the order of FitPanel::Seen
        Brush, OtherBrush, ApplyInPlace, ApplyToNew,
        Load, Save, Clear, LoadCurves, ClearCurves, SaveSession, LoadSession // without a key
    };
    // clang-format on
};

const ActionTable &fitActions();

#endif
