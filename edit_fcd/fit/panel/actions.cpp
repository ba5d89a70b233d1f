// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/panel/actions.h"

const ActionTable &fitActions() {
    static const ActionTable all = {
        {FitAction::Undo, "Ctrl+Z"},
        {FitAction::Redo, "Ctrl+Shift+Z"},
        {FitAction::Remove, "Del"},
        {FitAction::Reset, "Backspace"},
        {FitAction::Pull, "P"},
        {FitAction::Cancel, "Esc"},
        {FitAction::InTurn, "1"},
        {FitAction::Both, "2"},
        {FitAction::Source, "3"},
        {FitAction::Target, "4"},
        {FitAction::Brush, "B"},
        {FitAction::OtherBrush, "X"},
        {FitAction::ApplyInPlace, "Ctrl+Return|Ctrl+Enter"},
        {FitAction::ApplyToNew, "Ctrl+Shift+Return|Ctrl+Shift+Enter"},
    };
    return all;
}
