// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POSE_SEQUENCE_H
#define VCG_FCD_POSE_SEQUENCE_H

#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

/// \file
/// Poses that have names, and how they follow each other in time; as a table that people read and write.

namespace vcg::fcd {

/// A pose: how handles move.
struct NamedPose {
    std::string name;    ///< UTF-8, not empty
    std::string motions; ///< as ReadMotionText reads them; empty: rest
};

/// How the weights go from one key frame to the next.
enum class Easing {
    Linear, ///< at an even rate
    Smooth, ///< t * t * (3 - 2 t), as smoothstep of GLSL (The OpenGL Shading Language 4.60, 8.3)
    Hold    ///< not at all, and at once at the next
};

/// Where, at \p t of the way in time, 0 to 1, the weights are on theirs.
double Eased(Easing easing, double t);

/// The weights of all poses at one time.
struct KeyFrame {
    double time = 0;                ///< seconds, >= 0
    Easing easing = Easing::Linear; ///< to the next key frame
    std::vector<double> weight;     ///< of each pose, percent, any number
};

/// What tells a surface from another: it is written to files, so that poses are not taken for another surface.
struct SurfaceMark {
    std::size_t vertices = 0;
    Eigen::AlignedBox3d box; ///< at rest, in the world

    /// \param world from mesh units to the world
    static SurfaceMark Of(const SurfaceView &surface, const Eigen::Affine3d &world);

    /// Whether it is the same surface, at the same place within 1e-4 of its diagonal.
    bool IsSame(const SurfaceMark &other) const;
};

/// Poses, and key frames of them.
struct PoseSequence {
    std::vector<NamedPose> pose;
    std::vector<KeyFrame> key;          ///< ascending in time
    std::optional<SurfaceMark> surface; ///< that they are of, where it is known

    /// The weights at \p time, in seconds; before the first key frame those of that, after the last one those of that.
    std::vector<double> WeightsAt(double time) const;

    /// \throw BadInput no pose, a name that is empty or there twice, times that do not ascend or are negative, weights
    /// that are not finite or not one for each pose
    void Validate() const;

    /// \param other the surface at hand \throw BadInput when the poses are known to be of another one
    void ExpectSurface(const SurfaceMark &other) const;
};

/// Reads a table of poses, a line for each row, its cells with commas, semicolons or tabs between (that which follows
/// the first word); cells may be quoted ("..."; "" is a quotation mark), and lines that begin with # are comments:
///
///     time, easing, NAME, NAME, ...                  a column for each pose
///     surface, , "N vertices from x y z to x y z"    may be left out: where the poses are from
///     motions, , "2: rotate 0 0 1 90", "2: translate 0 0 5; 3: scale 2", ...
///     0, smooth, 0, 0                                a row for each key frame: seconds, linear, smooth or hold, and
///     1.5, linear, 100, 50                           the percent of each pose; empty is linear, and 0
///
/// Without key frames, the poses follow each other, from rest, a second each, smoothly.
/// \param name what messages call the text \throw BadInput what is wrong, with the line
PoseSequence ReadPoseSequence(const std::string &text, const std::string &name);

/// What ReadPoseSequence reads, each number to the bit.
std::string PoseSequenceText(const PoseSequence &sequence);

/// The times of the frames from the first key frame to the last, \p rate a second; the last is not before the last key
/// frame. \throw BadInput a rate that is not positive, or more than a million frames
std::vector<double> FrameTimes(const PoseSequence &sequence, double rate);

} // namespace vcg::fcd

#endif
