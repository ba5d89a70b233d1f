// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_ACTIONS_H
#define FCD_FIT_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// What a key does in the view, or a button of the panel.
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
        Load, // from here on without a key
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
