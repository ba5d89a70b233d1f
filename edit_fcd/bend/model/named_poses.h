// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_NAMED_POSES_H
#define FCD_BEND_NAMED_POSES_H

#include <layer_fcd/bend_state.h>

#include <optional>

/// \file
/// Poses that have names, and their key frames: what a person does to the table.

/// A pose more, with a name of its own, and its key frame, a second after the others, as in a table without any.
vcg::fcd::PoseSequence withPose(vcg::fcd::PoseSequence poses, const std::string &motions);
/// Key frames that show nothing else go with it, and those after them come earlier.
vcg::fcd::PoseSequence withoutPose(vcg::fcd::PoseSequence poses, std::size_t number);
vcg::fcd::PoseSequence renamed(vcg::fcd::PoseSequence poses, std::size_t number, const std::string &name);
/// The pose of a name, other than \p number, none where there is none.
std::optional<std::size_t> poseOfName(const BendState &state, const std::string &name, std::size_t number);
std::vector<double> aloneOf(std::size_t poses, std::size_t number); ///< 100 % of that one
/// Percent of each pose, where the motions are a blend of them, else 0.
std::vector<double> weightsOfPoses(const BendState &state);
/// \throw vcg::fcd::Error there are none
const vcg::fcd::PoseSequence &expectPoses(const BendState &state);
/// \throw vcg::fcd::Error they have less than two key frames
const vcg::fcd::PoseSequence &expectAnimation(const BendState &state);

/// Ascending in time.
std::vector<vcg::fcd::KeyFrame> keyFrames(const BendState &state);
vcg::fcd::PoseSequence withKeyFrames(vcg::fcd::PoseSequence poses, std::vector<vcg::fcd::KeyFrame> frames);
/// What is shown of the poses becomes a key frame, a second after the others. \param moves whether anything does
/// \throw vcg::fcd::Error no pose is shown
vcg::fcd::PoseSequence withKeyFrame(const BendState &state, bool moves);
/// The frames from one time to another, \p rate a second, each as a key frame: no other table has the same ones where
/// an easing is cut. All of it as it is. \throw vcg::fcd::Error it ends before it begins, or as FrameTimes
vcg::fcd::PoseSequence partOfAnimation(vcg::fcd::PoseSequence poses, double from, double to, double rate);

#endif
