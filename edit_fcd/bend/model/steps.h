// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_STEPS_H
#define FCD_BEND_STEPS_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include <vector>

/// Steps that make a motion, up to rounding. \param center of the handle at rest, in the world
std::vector<vcg::fcd::MotionStep> stepsOf(const vcg::fcd::Motion &motion, const Eigen::Vector3d &center);

/// Says in the steps where they turn and scale, which is the middle of their handle until then. \param center of the
/// handle at rest, in the world \return whether any of them did not say it
bool setPlaces(std::vector<vcg::fcd::MotionStep> &steps, const Eigen::Vector3d &center);

/// The step on the other side of a mirror. (Exact where the layer's matrix keeps angles.)
vcg::fcd::MotionStep mirroredStep(const vcg::fcd::MotionStep &step, const Eigen::Affine3d &mirror);

/// Steps that take places to others as nearly as a rigid motion can, in few digits; none where they hardly move.
/// \param middle about which they turn \param least way that counts
std::vector<vcg::fcd::MotionStep> rigidSteps(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to,
                                             const Eigen::Vector3d &middle, double least);

/// A number in few digits, as people would write it; what is kept is what is written.
double inFewDigits(double x);
Eigen::Vector3d inFewDigits(const Eigen::Vector3d &v);

#endif
