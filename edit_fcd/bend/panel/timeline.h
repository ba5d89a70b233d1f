// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TIMELINE_H
#define FCD_BEND_TIMELINE_H

#include <QWidget>

#include <optional>
#include <vector>

#include "edit_fcd/bend/panel/frame_scale.h"

/// The key frames as marks on a bar, with frame numbers. A press or a drag shows a frame; with Shift, it moves a mark.
class BendTimeline : public QWidget {
    Q_OBJECT

  public:
    explicit BendTimeline(QWidget *parent = nullptr);
    /// \param times of the key frames, seconds, ascending
    void show(const std::vector<double> &times);
    /// Sets the time that the view shows; none if it shows something else.
    void showTime(const std::optional<double> &time);
    QString textOf(double time) const; ///< frame and seconds

  signals:
    void begins(double time); ///< pressed at a key frame, or else at a frame
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
    std::optional<std::size_t> moved; ///< key frame that is being dragged
    double movedTime = 0;             ///< its new time, seconds
};

#endif
