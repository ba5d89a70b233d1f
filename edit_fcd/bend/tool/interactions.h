// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_INTERACTIONS_H
#define FCD_BEND_INTERACTIONS_H

#include "edit_fcd/bend/tool/stage.h"
#include "edit_fcd/view/pointing.h"

/// Marks vertices as the panel says, by brush, rectangle or polygon.
class MarkInteraction : public BendInteraction {
  public:
    enum Kind { Brush, Rectangle, Polygon };

    MarkInteraction(BendStage &stage, Kind kind);
    /// Begins at the mouse.
    void begin();
    void cancel() override;
    void move(QMouseEvent &event) override;
    void release() override;
    bool press(QMouseEvent &event) override;
    bool doubleClick() override;
    bool isCancelledByEsc() const override { return true; }
    void draw() const override;

  private:
    std::vector<Eigen::Vector2d> outline() const;
    void mark(const SeenPart::IsIn &isIn);
    void brush();
    void end();

    // In window coordinates:
    Kind kind;
    std::vector<Eigen::Vector2d> corners; ///< of a polygon; a rectangle's two opposite ones; a brush's last place
    std::vector<float> depth;             ///< from depthOf, to mark visible vertices only; empty: all
};

/// The point of the line at a place of the window.
std::optional<std::size_t> linePointAt(const BendStage &stage);

/// Moves a point of the line, which may be new.
class LineInteraction : public BendInteraction {
  public:
    using BendInteraction::BendInteraction;
    /// Takes the point of the line under the mouse, or adds one there. \return whether there is a place for it
    bool begin();
    void cancel() override { stage.ended(); }
    void move(QMouseEvent &event) override;
    void release() override { stage.ended(); }

  private:
    std::size_t which = 0;
};

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
