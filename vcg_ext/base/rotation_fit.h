// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ROTATION_FIT_H
#define VCG_FCD_ROTATION_FIT_H

#include <Eigen/Core>

namespace vcg::fcd::detail {

/// The unit quaternion (w, x, y, z) of a rotation, and its rotation matrix.
Eigen::Vector4d ToQuaternion(const Eigen::Matrix3d &rotation);
Eigen::Matrix3d ToMatrix(const Eigen::Vector4d &q);

/// The rotation R that maximises tr(R S), as a unit quaternion (w, x, y, z).
///
/// It is the eigenvector of the largest eigenvalue of a symmetric, traceless 4 x 4 matrix (Davenport; Horn 1987). The
/// eigenvalue is the largest root of a quartic, found by Newton's method from above (Theobald 2005); the eigenvector is
/// a column of the adjugate. If the eigenvalue is nearly double, the rotation is not unique, and an SVD chooses one.
/// \param unscaled S; 0 or not finite: the result is the identity
/// \param near a unit quaternion near the result, for fewer steps; it changes the result by rounding only
Eigen::Vector4d FitQuaternion(const Eigen::Matrix3d &unscaled, const Eigen::Vector4d &near = Eigen::Vector4d::UnitX());

/// The rotation R that maximises tr(R S).
Eigen::Matrix3d FitRotation(const Eigen::Matrix3d &s);

/// The rotation nearest to a linear map with a positive determinant.
Eigen::Matrix3d RotationOf(const Eigen::Matrix3d &linear);

} // namespace vcg::fcd::detail

#endif
