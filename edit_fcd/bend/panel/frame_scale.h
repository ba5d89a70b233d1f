// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FRAME_SCALE_H
#define FCD_FRAME_SCALE_H

#include <cstddef>
#include <optional>
#include <vector>

/// Where the frames of an animation are along a bar: the first key frame, frame 0, at its left end, the last one at its
/// right end.
struct FrameScale {
    std::vector<double> key; ///< times of the key frames, seconds, ascending
    double rate = 24;        ///< frames a second
    double left = 0, width = 0;

    /// The number of the last frame, which is not before the last key frame.
    int last() const;
    double timeOf(int frame) const; ///< seconds, from the first key frame to the last. \pre there is one
    int frameOf(double time) const; ///< the nearest one
    double xOf(double time) const;
    /// The key frame whose mark is nearest, none beyond \p reach.
    std::optional<std::size_t> keyAt(double x, double reach) const;
    /// That of the mark within \p reach, or else of the nearest frame. \pre there is a key frame
    double timeAt(double x, double reach) const;
    /// Where a key frame that is drawn to \p x goes: a whole number of frames from the first one, as far as at least a
    /// frame is left to the key frames before and after it. \pre there are two
    double movedTo(std::size_t which, double x) const;
};

#endif
