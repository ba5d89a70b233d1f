// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ROTATION_FIT_H
#define VCG_FCD_ROTATION_FIT_H

#include <Eigen/Core>

namespace vcg::fcd::detail {

/// The unit quaternion (w, x, y, z) of a rotation, and the way back.
Eigen::Vector4d ToQuaternion(const Eigen::Matrix3d &rotation);
Eigen::Matrix3d ToMatrix(const Eigen::Vector4d &q);

/// The rotation R that maximises tr(R S), as a unit quaternion (w, x, y, z).
///
/// The quaternion is the eigenvector of the largest eigenvalue of a symmetric, traceless 4 x 4 matrix (Davenport; Horn
/// 1987). The eigenvalue is the largest root of a quartic, found by Newton's method from above (Theobald 2005), the
/// eigenvector a column of the adjugate. Where the eigenvalue is close to double, the rotation is not unique and an SVD
/// chooses one.
/// \param near a unit quaternion; the closer, the fewer steps, but the result is the same to rounding
Eigen::Vector4d FitQuaternion(const Eigen::Matrix3d &unscaled, const Eigen::Vector4d &near = Eigen::Vector4d::UnitX());

/// The rotation R that maximises tr(R S).
Eigen::Matrix3d FitRotation(const Eigen::Matrix3d &s);

/// The rotation part of a linear map with a positive determinant.
Eigen::Matrix3d RotationOf(const Eigen::Matrix3d &linear);

} // namespace vcg::fcd::detail

#endif
