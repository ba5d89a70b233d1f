// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd.h"

#include "bend_tool.h"

#include <cmath>

#include <QPainter>
#include <QPixmap>

namespace {

/// A bent bar, with its handle red and what is fixed blue.
QIcon icon() {
    QPixmap pixmap(64, 64);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    painter.setRenderHint(QPainter::Antialiasing);
    const auto draw = [&](const QColor &color, double from, double to) {
        painter.setPen(QPen(color, 15, Qt::SolidLine, Qt::FlatCap));
        painter.drawArc(QRectF(14, 14, 76, 76), int(16 * from), int(16 * (to - from)));
    };
    draw(QColor(59, 111, 201), 160, 200);
    draw(QColor(240, 197, 60), 112, 161);
    draw(QColor(210, 60, 50), 80, 113);
    return QIcon(pixmap);
}

} // namespace

EditFcd::EditFcd() { announce(icon(), "FCD: Bend"); }

HostEditTool *EditFcd::makeTool(QAction *action) const { return new BendTool(action); }

QString EditFcd::help() const {
    return "Bends the current layer by hand, however many vertices it has.<br>"
           "<b>At once:</b> press on the surface and drag. The point follows the mouse, what is around it bends, and "
           "all beyond the <i>point radius</i> (wheel while dragging) stays fixed.<br>"
           "<b>With marks:</b> choose <i>Brush</i> (B), <i>Rectangle</i> (V) or <i>Polyline</i> (L) and what is "
           "marked: "
           "fixed (F, blue), free (U), a handle (H, red; Shift+H the next one) or outside (O, grey). Then <i>Bend</i> "
           "(M), and drag a handle, an arrow (moves along an axis) or a ring (turns). Marks are tags for the FCD "
           "filters, too; colours and quality of the layer stay as they are.<br>"
           "<b>Keys:</b> the button <i>?</i> in the panel shows them all.<br>"
           "<b>Camera:</b> drag beside the mesh, or with the right or middle button; wheel.<br>"
           "A layer is what it shows: whatever comes next, another layer, a filter, a file, finds the pose. Back in "
           "the "
           "tool, it goes on as it was left, with its undo. The log gets the filter call that makes the same shape in "
           "a "
           "script.";
}

#include "layer_fcd/moc_edit_host.cpp" // NOLINT(bugprone-suspicious-include)
#include "moc_edit_fcd.cpp"            // NOLINT(bugprone-suspicious-include)
