// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_JITTER_H
#define VCG_FCD_LINE_JITTER_H

#include <Eigen/Core>

namespace vcg::fcd {

/// Points of a line without the jitter that picked or measured ones have.
struct SteadyPoints {
    Eigen::Matrix3Xd point; ///< 3 x n; those that were given, to the bit, where their jitter does not matter
    double jitter = 0; ///< by how much they were off across, root mean square a direction; 0 where they are as given
};

/// Takes the jitter out of the points of a line along a body, where it matters: where it would stretch the surface of
/// the body by more than a hundredth when that is straightened.
///
/// The points become those of a smoothing spline (C. Reinsch, Smoothing by spline functions, 1967), as stiff as
/// predicts each of them best from the others (generalised cross-validation; P. Craven, G. Wahba 1979), so that the
/// points themselves tell how much they jitter. It never takes bends out that are wide against the body.
/// \param points 3 x n, in their order, finite, no two in a row at one place \param thickness how far the surface of
/// the body is from the line, units of the points, > 0
SteadyPoints WithoutJitter(const Eigen::Matrix3Xd &points, double thickness);

} // namespace vcg::fcd

#endif
