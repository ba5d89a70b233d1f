// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_ANIMATION_INTERACTION_H
#define FCD_BEND_ANIMATION_INTERACTION_H

#include "edit_fcd/bend/tool/stage.h"

/// Shows frames of the animation until something else is done. Times are seconds, of the key frames.
class AnimationInteraction : public BendInteraction {
  public:
    using BendInteraction::BendInteraction;
    void cancel() override; ///< restores the shape before
    void move(QMouseEvent &) override {}
    bool takesAllKeys() const override { return isReady; }
    bool isEndedByAll() const override { return isReady; }

  protected:
    /// \param begun called once the layer is prepared
    void prepare(const std::function<void()> &begun);
    void show(double time);
    void leave();

    double first = 0, length = 0; ///< time of the first key frame, and from there to the last one
    bool isReady = false;         ///< the layer is prepared
};

/// Plays the key frames.
class PlayInteraction : public AnimationInteraction {
  public:
    using AnimationInteraction::AnimationInteraction;
    void begin();
    void cancel() override;
    QString text() const override { return "Playing the key frames: Esc, or a click, ends it."; }

  private:
    QTimer frames; ///< until the next frame
    QElapsedTimer since;
};

/// Shows the animation at the time that is dragged to in the panel.
class ScrubInteraction : public AnimationInteraction {
  public:
    /// \param kept gets the time at the end
    ScrubInteraction(BendStage &stage, std::function<void(double)> kept)
        : AnimationInteraction(stage), kept(std::move(kept)) {}
    void begin(double time);
    void to(double time);
    double time() const { return asked; }
    void end();
    void step() override;
    QString text() const override;

  private:
    std::function<void(double)> kept;
    double asked = 0;
    bool isReleased = false; ///< the mouse was released before the layer was prepared
};

#endif
