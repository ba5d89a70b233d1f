// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TIMELINE_H
#define FCD_BEND_TIMELINE_H

#include <QWidget>

#include <optional>
#include <vector>

#include "edit_fcd/bend/panel/frame_scale.h"

/// The key frames as marks on a bar, with the numbers of their frames; a press, and a drag, lead to others. A mark is
/// drawn to another time with Shift.
class BendTimeline : public QWidget {
    Q_OBJECT

  public:
    explicit BendTimeline(QWidget *parent = nullptr);
    /// \param times of the key frames, seconds, ascending
    void show(const std::vector<double> &times);
    /// The time that is shown in the view, none if no time of the animation is.
    void showTime(const std::optional<double> &time);
    QString textOf(double time) const; ///< its frame, and the seconds

  signals:
    void begins(double time); ///< what the mouse was pressed at: a key frame, or else a frame
    void goes(double time);
    void ends();
    void keyMoved(int which, double time);

  protected:
    void paintEvent(QPaintEvent *event) override;
    void mousePressEvent(QMouseEvent *event) override;
    void mouseMoveEvent(QMouseEvent *event) override;
    void mouseReleaseEvent(QMouseEvent *event) override;

  private:
    FrameScale scale() const;

    std::vector<double> key;
    std::optional<double> shown;
    bool isDragged = false;
    std::optional<std::size_t> moved; ///< key frame that is drawn
    double movedTime = 0;             ///< to where
};

#endif
