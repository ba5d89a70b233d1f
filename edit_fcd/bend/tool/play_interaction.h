// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_PLAY_INTERACTION_H
#define FCD_BEND_PLAY_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// Plays the key frames until something else is done.
class PlayInteraction : public BendInteraction {
  public:
    using BendInteraction::BendInteraction;
    void begin();
    void cancel() override; ///< restores the shape before
    void move(QMouseEvent &) override {}
    bool takesAllKeys() const override { return frames.isActive(); }
    bool isEndedByAll() const override { return frames.isActive(); }
    QString text() const override { return "Playing the key frames: Esc, or a click, ends it."; }

  private:
    void show();

    QTimer frames; ///< until the next frame
    QElapsedTimer since;
    double length = 0; ///< seconds
};

#endif
