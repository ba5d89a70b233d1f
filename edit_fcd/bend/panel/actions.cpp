// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/panel/panel.h"

const ActionTable &bendActions() {
    static const ActionTable all = {
        {BendAction::Drag, "D|Shift+J",
         "drag: a limb turns so that the place under the mouse follows; a handle, or a place elsewhere, is pulled"},
        {BendAction::Pull, "M", "pull: drag a handle, or a point of the surface, also of a limb"},
        {BendAction::Brush, "B", "mark with the brush; its size is on the wheel"},
        {BendAction::Rectangle, "V", "mark what is in a rectangle"},
        {BendAction::Polyline, "L", "mark what is in a polygon: click its corners, Enter or a double click ends it"},
        {BendAction::Line, "N",
         "straighten the layer along a line: click points along it, drag them; a layer, or a file, may be the line, "
         "too"},
        {BendAction::RemovePoint, "Del", "remove the point of the line under the mouse, or else the last one"},
        {BendAction::Fixed, "F", "what is marked becomes fixed"},
        {BendAction::Free, "U", "free"},
        {BendAction::Handle, "H", "part of the selected handle, or a new one after that was moved"},
        {BendAction::NextHandle, "Shift+H", "the next handle"},
        {BendAction::Outside, "O", "ignored: outside of the region of influence"},
        {BendAction::Through, "T", "mark only what is seen, or through the mesh"},
        {BendAction::Move, "G", "move what is under the mouse, a handle or a place, or else the selected handle"},
        {BendAction::Turn, "R", "turn it; then drag from there along a limb: what lies beyond turns about that place"},
        {BendAction::Scale, "S", "scale it"},
        {BendAction::Limb, "J",
         "turn the limb under the mouse so that this place follows: at the last joint that was turned, or where it "
         "begins"},
        {BendAction::Pivot, "P",
         "put the pivot of the selected handle under the mouse, on a place or another handle's middle; beside the "
         "mesh: on its own middle again"},
        {BendAction::Undo, "Ctrl+Z", "undo, also over applies"},
        {BendAction::Redo, "Ctrl+Shift+Z", "redo"},
        {BendAction::Reset, "Backspace", "take all motions back"},
        {BendAction::Cancel, "Esc",
         "cancel what is being moved or marked; else camera mode, until Esc is pressed again"},
        {BendAction::End, "Return|Enter", "keep what is being moved; end a polygon"},
        {BendAction::ApplyInPlace, "Ctrl+Return|Ctrl+Enter", "apply in place"},
        {BendAction::ApplyToNewLayer, "Ctrl+Shift+Return|Ctrl+Shift+Enter", "apply to a new layer"},
        {BendAction::Page, "?|Shift+?", "this page"},
    };
    return all;
}

QString bendKeyPage() {
    return bendActions().page(
        {{"while moving",
          "X, Y, Z: along or about an axis; a number; G, R, S; Ctrl: in steps; Shift: onto another layer "
          "under the mouse; "
          "wheel: how far it bends what is around; click or Enter keeps, right click or Esc cancels"},
         {"Ctrl, wheel", "width of the free rim of the mark under the mouse; nothing else is held in it"},
         {"camera",
          "drag beside the mesh, or with the right or middle button; wheel; a double click centers a place"}});
}
