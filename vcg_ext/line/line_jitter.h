// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_JITTER_H
#define VCG_FCD_LINE_JITTER_H

#include <Eigen/Core>

namespace vcg::fcd {

/// Points of a line without the jitter of picking or measuring.
struct SteadyPoints {
    Eigen::Matrix3Xd point; ///< 3 x n; as given, to the bit, if their jitter does not matter
    double jitter = 0;      ///< rms jitter across the line, in one direction; 0 if the points are as given
};

/// Removes jitter from the points of a line along a body if it matters: if straightening would stretch the body's
/// surface by more than a hundredth because of it.
///
/// The points become those of a smoothing spline (C. Reinsch, Smoothing by spline functions, 1967). Its stiffness is
/// the one that predicts each point best from the others (generalised cross-validation; P. Craven, G. Wahba 1979), so
/// the points themselves tell how much they jitter. Bends that are wide against the body always stay.
/// \param points 3 x n, in their order, finite, no two in a row at one place \param thickness how far the surface of
/// the body is from the line, units of the points, > 0
SteadyPoints WithoutJitter(const Eigen::Matrix3Xd &points, double thickness);

} // namespace vcg::fcd

#endif
