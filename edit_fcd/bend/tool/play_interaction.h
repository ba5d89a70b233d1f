// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_PLAY_INTERACTION_H
#define FCD_BEND_PLAY_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// The key frames are played, until something else is done.
class PlayInteraction : public BendInteraction {
  public:
    using BendInteraction::BendInteraction;
    void begin();
    void cancel() override; ///< the layer has the shape before
    void move(QMouseEvent &) override {}
    bool takesAllKeys() const override { return frames.isActive(); }
    bool isEndedByAll() const override { return frames.isActive(); }
    QString text() const override { return "Playing the key frames: Esc, or a click, ends it."; }

  private:
    void show();

    QTimer frames; ///< to the next one
    QElapsedTimer since;
    double length = 0; ///< seconds
};

#endif
