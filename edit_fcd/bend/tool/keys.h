// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_KEYS_H
#define FCD_BEND_KEYS_H

#include <vector>

#include <QKeyEvent>
#include <QString>

/// What a key does in the view.
enum class BendAction {
    Bend,
    Brush,
    Rectangle,
    Polyline,
    Line,
    RemovePoint,
    Fixed,
    Free,
    Handle,
    NextHandle,
    Outside,
    Through,
    Move,
    Turn,
    Scale,
    Pivot,
    Undo,
    Redo,
    Reset,
    Cancel,
    End,
    ApplyInPlace,
    ApplyToNewLayer,
    Page
};

struct BendKey {
    BendAction action;
    const char *keys; ///< one, or several with a bar between
    const char *text; ///< for the page of keys
};

/// All of them: the keys, the tool tips and the page of keys say the same.
const std::vector<BendKey> &bendKeys();

/// What a key does, null where it is none of ours.
const BendKey *bendKeyOf(const QKeyEvent &event);

/// A tool tip with the keys of an action after it.
QString withKeys(const QString &tip, BendAction action);

/// The page of keys, HTML.
QString bendKeyPage();

#endif
