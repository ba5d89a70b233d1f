// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_NAMED_POSES_H
#define FCD_BEND_NAMED_POSES_H

#include <vcg_ext/deformer.h> // these before Qt
#include <vcg_ext/sequence/pose_sequence.h>

#include <layer_fcd/bend_state.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

/// \file
/// Edits the table of named poses and key frames.

/// Adds a pose with a new name, and its key frame, a second after the others, as in a table without key frames.
vcg::fcd::PoseSequence withPose(vcg::fcd::PoseSequence poses, const std::string &motions);
/// Removes a pose, and key frames that show nothing else; later ones move forward.
vcg::fcd::PoseSequence withoutPose(vcg::fcd::PoseSequence poses, std::size_t number);
vcg::fcd::PoseSequence renamed(vcg::fcd::PoseSequence poses, std::size_t number, const std::string &name);
/// The number of a pose of this name, other than \p number.
std::optional<std::size_t> poseOfName(const BendState &state, const std::string &name, std::size_t number);
std::vector<double> aloneOf(std::size_t poses, std::size_t number); ///< 100 % of that one
/// The weights of the poses, percent; 0 if the motions are no blend of them.
std::vector<double> weightsOfPoses(const BendState &state);
/// \throw vcg::fcd::Error there are none
const vcg::fcd::PoseSequence &expectPoses(const BendState &state);
/// \throw vcg::fcd::Error they have less than two key frames
const vcg::fcd::PoseSequence &expectAnimation(const BendState &state);

/// Ascending in time.
std::vector<vcg::fcd::KeyFrame> keyFrames(const BendState &state);
vcg::fcd::PoseSequence withKeyFrames(vcg::fcd::PoseSequence poses, std::vector<vcg::fcd::KeyFrame> frames);
/// Adds the shown blend as a key frame, a second after the others.
/// \param moves whether anything is moved \throw vcg::fcd::Error no pose is shown
vcg::fcd::PoseSequence withKeyFrame(const BendState &state, bool moves);
/// The frames from one time to another, \p rate a second, each as a key frame: where an easing is cut, no other table
/// is exact. The whole range stays as it is. \throw vcg::fcd::Error it ends before it begins; as FrameTimes
vcg::fcd::PoseSequence partOfAnimation(vcg::fcd::PoseSequence poses, double from, double to, double rate);

// --- onion skin: the shapes of the key frames before and after the shown one ---

/// The weights of the poses in those key frames, percent; empty: none.
struct GhostFrames {
    std::vector<double> before, after;
};
/// The key frames next to a time; none if there are less than two. \param keys ascending \param time seconds
/// \param isShown the shown shape is the animation's at that time; false: something else is posed, and a key frame at
/// just that time counts as before
GhostFrames ghostFrames(const std::vector<vcg::fcd::KeyFrame> &keys, double time, bool isShown);

/// Computes the shapes of blends of poses. It reads neither session nor layer, so it may run in the background.
struct BlendShapes {
    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest
    std::shared_ptr<const std::vector<int>> tags;           ///< one per vertex slot
    Eigen::Affine3d world;                                  ///< the layer's matrix
    vcg::fcd::DeformationParam param;
    std::vector<std::map<int, vcg::fcd::Motion>> poses;
    std::shared_ptr<const vcg::fcd::Deformer> deformer; ///< for these tags and parameters; null: of() prepares it

    /// \param weight percent of each pose
    /// \param slot vertices \return three coordinates for each of these, layer units \throw vcg::fcd::Error
    /// \throw vcg::fcd::Cancelled
    std::vector<float> of(const std::vector<double> &weight, const std::vector<std::uint32_t> &slot,
                          const vcg::fcd::Progress &progress);
};

#endif
