// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_STEPS_H
#define FCD_BEND_STEPS_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include <string>
#include <vector>

/// The steps of a motion, up to rounding. \param center of the handle at rest, world
std::vector<vcg::fcd::MotionStep> stepsOf(const vcg::fcd::Motion &motion, const Eigen::Vector3d &center);

/// Sets the places of turns and scalings explicitly; by default, they are the middle of the handle. \param center of
/// the handle at rest, world \return whether any step has changed
bool setPlaces(std::vector<vcg::fcd::MotionStep> &steps, const Eigen::Vector3d &center);

/// The step on the other side of a mirror; exact if the layer's matrix keeps angles.
vcg::fcd::MotionStep mirroredStep(const vcg::fcd::MotionStep &step, const Eigen::Affine3d &mirror);

/// Steps of the rigid motion that takes points nearest to others, in few digits; none if they hardly move.
/// \param middle pivot of the turn \param least smallest move that counts
std::vector<vcg::fcd::MotionStep> rigidSteps(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to,
                                             const Eigen::Vector3d &middle, double least);

/// A number with so many digits.
std::string inDigits(double x, int digits);
/// Rounds a number to few digits, as people write it.
double inFewDigits(double x);
Eigen::Vector3d inFewDigits(const Eigen::Vector3d &v);

#endif
