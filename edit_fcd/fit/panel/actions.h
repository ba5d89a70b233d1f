// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_ACTIONS_H
#define FCD_FIT_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// The actions of keys in the view and of the panel's buttons.
struct FitAction {
    enum Id {
        Undo,
        Redo,
        Remove,
        Reset,
        Pull,
        Cancel,
        InTurn, // these in the order of FitPanel::Seen
        Both,
        Source,
        Target,
        Brush,
        OtherBrush,
        ApplyInPlace,
        ApplyToNew,
        Load, // this and later ones have no key
        Save,
        Clear,
        LoadCurves,
        ClearCurves,
        SaveSession,
        LoadSession
    };
};

const ActionTable &fitActions();

#endif
