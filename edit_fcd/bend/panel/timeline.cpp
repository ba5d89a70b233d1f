// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/animation_export.h" // before Qt

#include "edit_fcd/bend/panel/timeline.h"

#include <algorithm>
#include <utility>

#include <QMouseEvent>
#include <QPainter>

const int barEdge = 8, markAt = 8, markSize = 4; // pixels
const double grasp = 4;                          // pixels: a press so near is on a mark

BendTimeline::BendTimeline(QWidget *parent) : QWidget(parent) {
    setObjectName("timeline");
    setToolTip("The key frames, with the numbers of their frames, 24 a second from the first one on. Click a mark to "
               "see that key frame; drag to see what is between them; Shift and a drag move a mark");
    setFocusPolicy(Qt::NoFocus); // keys stay with the view
    setFixedHeight(30);
}

FrameScale BendTimeline::scale() const {
    return {key, AnimationExport().rate, double(barEdge), double(width() - 2 * barEdge)};
}

void BendTimeline::show(const std::vector<double> &times) {
    if (times == key)
        return;
    key = times;
    moved.reset();
    update();
}

void BendTimeline::showTime(const std::optional<double> &time) {
    if (time == shown)
        return;
    shown = time;
    update();
}

QString BendTimeline::textOf(double time) const {
    return QString("frame %1, %2 s").arg(scale().frameOf(time)).arg(time, 0, 'f', 2);
}

void BendTimeline::paintEvent(QPaintEvent *) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const FrameScale at = scale();
    painter.setPen(QPen(palette().color(QPalette::Mid), 2));
    painter.drawLine(QPointF(barEdge, markAt), QPointF(width() - barEdge, markAt));
    QFont small = font();
    small.setPixelSize(10);
    painter.setFont(small);
    std::vector<QRectF> taken;
    const auto number = [&](double time) { // if there is room
        const QString text = QString::number(at.frameOf(time));
        const double wide = painter.fontMetrics().horizontalAdvance(text);
        const double x = std::clamp(at.xOf(time) - wide / 2, 0.0, width() - wide);
        const QRectF box(x, height() - 13, wide, 12);
        for (const QRectF &other : taken)
            if (other.intersects(box.adjusted(-3, 0, 3, 0)))
                return;
        painter.drawText(box, Qt::AlignCenter, text);
        taken.push_back(box);
    };
    const bool isShown = shown && !key.empty();
    if (isShown) {
        const double x = at.xOf(*shown);
        painter.setPen(QPen(palette().color(QPalette::Highlight), 2));
        painter.drawLine(QPointF(x, 0), QPointF(x, height() - 14));
        number(*shown);
    }
    for (std::size_t i = 0; i < key.size(); ++i) {
        const double time = moved == i ? movedTime : key[i];
        const QPointF middle(at.xOf(time), markAt);
        const QPointF corners[] = {middle + QPointF(0, -markSize), middle + QPointF(markSize, 0),
                                   middle + QPointF(0, markSize), middle + QPointF(-markSize, 0)};
        painter.setPen(palette().color(QPalette::WindowText));
        painter.setBrush(palette().color(isShown && time == *shown ? QPalette::Highlight : QPalette::Base));
        painter.drawPolygon(corners, 4);
        number(time);
    }
}

void BendTimeline::mousePressEvent(QMouseEvent *event) {
    if (event->button() != Qt::LeftButton || key.empty())
        return;
    if (event->modifiers() & Qt::ShiftModifier) {
        moved = key.size() > 1 ? scale().keyAt(event->localPos().x(), grasp) : std::nullopt;
        movedTime = moved ? key[*moved] : 0;
        return;
    }
    isDragged = true;
    emit begins(scale().timeAt(event->localPos().x(), grasp));
}

void BendTimeline::mouseMoveEvent(QMouseEvent *event) {
    if (moved) {
        movedTime = scale().movedTo(*moved, event->localPos().x());
        update();
    } else if (isDragged && !key.empty())
        emit goes(scale().timeAt(event->localPos().x(), grasp));
}

void BendTimeline::mouseReleaseEvent(QMouseEvent *event) {
    if (event->button() != Qt::LeftButton)
        return;
    if (const auto which = std::exchange(moved, std::nullopt)) {
        update();
        if (movedTime != key[*which])
            emit keyMoved(int(*which), movedTime);
        return;
    }
    if (!isDragged)
        return;
    isDragged = false;
    emit ends();
}

#include "edit_fcd/bend/panel/moc_timeline.cpp" // NOLINT(bugprone-suspicious-include)
