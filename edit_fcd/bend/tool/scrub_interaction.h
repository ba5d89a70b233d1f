// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SCRUB_INTERACTION_H
#define FCD_BEND_SCRUB_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// Shows the animation at the time that is dragged to in the panel.
class ScrubInteraction : public BendInteraction {
  public:
    /// \param kept gets the time at the end
    ScrubInteraction(BendStage &stage, std::function<void(double)> kept)
        : BendInteraction(stage), kept(std::move(kept)) {}
    void begin(double time); ///< seconds, of the key frames
    void to(double time);
    double time() const { return asked; } ///< seconds, of the key frames
    void end();
    void cancel() override; ///< restores the shape before
    void move(QMouseEvent &) override {}
    bool takesAllKeys() const override { return isReady; }
    bool isEndedByAll() const override { return isReady; }
    void step() override;
    QString text() const override;

  private:
    void stop();

    std::function<void(double)> kept;
    double asked = 0, first = 0; ///< seconds
    bool isReady = false;        ///< the layer is prepared
    bool isReleased = false;     ///< the mouse was released before that
};

#endif
