// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_ACTIONS_H
#define FCD_FIT_ACTIONS_H

#include "edit_fcd/kit/action_table.h"

/// What a key does in the view.
struct FitAction {
    enum Id {
        Undo,
        Redo,
        Remove,
        Reset,
        Pull,
        Cancel,
        InTurn,
        Both,
        Source,
        Target,
        Brush,
        OtherBrush,
        ApplyInPlace,
        ApplyToNew
    };
};

const ActionTable &fitActions();

#endif
