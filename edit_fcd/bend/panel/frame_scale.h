// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FRAME_SCALE_H
#define FCD_FRAME_SCALE_H

#include <cstddef>
#include <optional>
#include <vector>

/// Maps times and frames of an animation to a bar from the first key frame, frame 0, to the last one; x in pixels.
struct FrameScale {
    std::vector<double> key;    ///< times of the key frames, seconds, ascending
    double rate = 24;           ///< frames a second
    double left = 0, width = 0; ///< of the bar, pixels

    /// The number of the last frame: at the last key frame, or the next one.
    int last() const;
    double timeOf(int frame) const; ///< seconds, at most that of the last key frame \pre there is a key frame
    int frameOf(double time) const; ///< the nearest one
    double xOf(double time) const;
    /// The key frame with the nearest mark; none if that is farther than \p reach.
    std::optional<std::size_t> keyAt(double x, double reach) const;
    /// The time of the mark within \p reach, or else of the nearest frame. \pre there is a key frame
    double timeAt(double x, double reach) const;
    /// The new time of a key frame that is dragged to \p x: that of a frame, at least one frame from the key frames
    /// before and after it. \pre there are two key frames
    double movedTo(std::size_t which, double x) const;
};

#endif
