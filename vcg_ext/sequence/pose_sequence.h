// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POSE_SEQUENCE_H
#define VCG_FCD_POSE_SEQUENCE_H

#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

/// \file
/// Named poses, their key frames, and the table for both that people read and write.

namespace vcg::fcd {

/// A pose: the motions of handles.
struct NamedPose {
    std::string name;    ///< UTF-8, not empty
    std::string motions; ///< for ReadMotionText; empty: rest
};

/// How weights change from one key frame to the next.
enum class Easing {
    Linear, ///< evenly
    Smooth, ///< t * t * (3 - 2 t), as smoothstep of GLSL (The OpenGL Shading Language 4.60, 8.3)
    Hold    ///< not before the next, then at once
};

/// The share of the change at \p t, the share of the time, both in [0, 1].
double Eased(Easing easing, double t);

/// The weights of all poses at one time.
struct KeyFrame {
    double time = 0;                ///< seconds, >= 0
    Easing easing = Easing::Linear; ///< to the next key frame
    std::vector<double> weight;     ///< of each pose, percent, any number
};

/// Identifies a surface in files of poses, so that they are not used for another one.
struct SurfaceMark {
    std::size_t vertices = 0;
    Eigen::AlignedBox3d box; ///< at rest, world units

    /// \param world from mesh units to the world
    static SurfaceMark Of(const SurfaceView &surface, const Eigen::Affine3d &world);

    /// Whether the vertex counts are equal, and the boxes within 1e-4 of the diagonal.
    bool IsSame(const SurfaceMark &other) const;
};

/// Poses, and key frames of them.
struct PoseSequence {
    std::vector<NamedPose> pose;
    std::vector<KeyFrame> key;          ///< ascending in time
    std::optional<SurfaceMark> surface; ///< their surface, if it is known

    /// The weights at \p time, seconds, percent. Before the first key frame and after the last, they are constant.
    std::vector<double> WeightsAt(double time) const;

    /// \throw BadInput no pose; a name that is empty or repeated; times that do not ascend or are negative; weights
    /// that are not finite, or not one for each pose
    void Validate() const;

    /// \param other the surface that is to be posed \throw BadInput the poses are known to be of another one
    void ExpectSurface(const SurfaceMark &other,
                       const std::string &remedy = "To use them anyway, delete the row 'surface'.") const;
};

/// Reads a table of poses, a row on each line. Cells are separated by commas, semicolons or tabs, as after the first
/// word. They may be quoted ("..."; "" is a quotation mark). Lines that begin with # are comments.
///
///     time, easing, NAME, NAME, ...                  a column for each pose
///     surface, , "N vertices from x y z to x y z"    optional: the surface of the poses
///     motions, , "2: rotate 0 0 1 90", "2: translate 0 0 5; 3: scale 2", ...
///     0, smooth, 0, 0                                a row for each key frame: seconds, linear, smooth or hold, and
///     1.5, linear, 100, 50                           the percent of each pose; empty is linear, and 0
///
/// Without key frames, the poses follow each other smoothly from rest, a second each. \param name of the text, for
/// messages \throw BadInput what is wrong, with the line
PoseSequence ReadPoseSequence(const std::string &text, const std::string &name);

/// The text for ReadPoseSequence, with each number to the bit.
std::string PoseSequenceText(const PoseSequence &sequence);

/// The times of the frames, seconds, \p rate a second, from the first key frame to the last or just after it.
/// \throw BadInput a rate that is not positive, or more than a million frames
std::vector<double> FrameTimes(const PoseSequence &sequence, double rate);

} // namespace vcg::fcd

#endif
