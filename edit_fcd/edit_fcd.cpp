// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd.h"

#include "edit_fcd/bend/tool/bend_tool.h"
#include "edit_fcd/fit/tool/fit_tool.h"

#include <QPainter>
#include <QPixmap>

static QIcon iconOf(const std::function<void(QPainter &)> &draw) {
    QPixmap pixmap(64, 64);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    painter.setRenderHint(QPainter::Antialiasing);
    draw(painter);
    return QIcon(pixmap);
}

/// A bent bar with a red handle and a blue fixed end.
static void drawBend(QPainter &painter) {
    const auto draw = [&](const QColor &color, double from, double to) {
        painter.setPen(QPen(color, 15, Qt::SolidLine, Qt::FlatCap));
        painter.drawArc(QRectF(14, 14, 76, 76), int(16 * from), int(16 * (to - from)));
    };
    draw(QColor(59, 111, 201), 160, 200);
    draw(QColor(240, 197, 60), 112, 161);
    draw(QColor(210, 60, 50), 80, 113);
}

/// Two curves, and pairs of points between them.
static void drawFit(QPainter &painter) {
    const QColor blue(59, 111, 201), orange(245, 140, 25);
    const auto draw = [&](const QColor &color, const QRectF &box, const std::vector<QPointF> &ends) {
        painter.setPen(QPen(color, 7));
        painter.setBrush(Qt::NoBrush);
        painter.drawArc(box, 16 * 20, 16 * 140);
        painter.setBrush(color);
        for (const QPointF &p : ends)
            painter.drawEllipse(p, 4, 4);
    };
    painter.setPen(QPen(QColor(150, 150, 150), 3));
    painter.drawLine(QPointF(14, 24), QPointF(18, 44));
    painter.drawLine(QPointF(50, 24), QPointF(46, 44));
    draw(orange, QRectF(4, 10, 56, 60), {{14, 24}, {50, 24}});
    draw(blue, QRectF(8, 32, 48, 44), {{18, 44}, {46, 44}});
}

EditFcd::EditFcd() : bend(announce(iconOf(drawBend), "FCD: Bend")), fit(announce(iconOf(drawFit), "FCD: Fit")) {}

HostEditTool *EditFcd::makeTool(QAction *action) const {
    if (action == fit)
        return new FitTool(action);
    return new BendTool(action);
}

QString EditFcd::help(const QAction *action) const {
    if (action == fit)
        return "Lays the current layer, a template, onto another one, a scan.<br><b>Pairs:</b> click a point on this "
               "layer, then the same one on the target; the layer follows, as rigidly as possible. Drag a point to "
               "move it, <i>Del</i> removes the pair that is selected.<br><b>Pull onto the target</b> (P) lays the "
               "surface onto it and keeps the pairs; <i>Stiffness</i> tells how rigidly. <i>Show distance</i> colours "
               "it by its distance from the target.<br><b>Camera:</b> drag, with any button; wheel.<br>The layer keeps "
               "the shape that you see when the tool ends; come back, and you go on where you were. <i>Apply in "
               "place</i> begins again from the shape, <i>Apply to new layer</i> leaves this layer as it was. The log "
               "gets the filter call for a script.";
    return "Bends the current layer by hand, however many vertices it has.<br><b>At once:</b> press on the surface and "
           "drag. A limb turns at its joint so that the point follows the mouse. Elsewhere, and in the mode "
           "<i>Pull</i> (M), you pull the point: its surroundings bend, and all beyond the <i>reach</i> (wheel while "
           "dragging) stays fixed. Before you press, a tint shows what would move.<br><b>With marks:</b> choose "
           "<i>Brush</i> (B), <i>Box</i> (V) or <i>Lasso</i> (L) and what you mark: fixed (F, blue), free (U), a "
           "handle (H, red; Shift+H the next one) or ignored (O, grey). Then <i>Pull</i> (M), and drag a handle, an "
           "arrow (moves along an axis) or a ring (turns). Marks are tags for the FCD filters, too; colours and "
           "quality of the layer stay as they are.<br><b>Straighten</b> (N): click points along the layer, from one "
           "end to the other; the line of another layer, or of a file, will do as well.<br><b>Keys:</b> the button "
           "<i>?</i> in the panel shows them all.<br><b>Camera:</b> drag beside the mesh, or with the right or middle "
           "button; wheel.<br>The layer keeps the shape that you see, for other filters and in files. Come back to the "
           "tool, and you go on where you were, with undo. The log gets the filter call for a script.";
}

#include "layer_fcd/moc_edit_host.cpp" // NOLINT(bugprone-suspicious-include)
#include "moc_edit_fcd.cpp"            // NOLINT(bugprone-suspicious-include)
