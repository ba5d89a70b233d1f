// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ROTATION_VECTOR_H
#define VCG_FCD_ROTATION_VECTOR_H

#include <Eigen/Geometry>

namespace vcg {
namespace fcd {
namespace detail {

/// The rotation about the axis of \p w by its length, in radians; none by a vector of no length.
inline Eigen::Matrix3d RotationBy(const Eigen::Vector3d &w) {
    const double angle = w.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

/// The matrix that multiplies a vector as the cross product with \p w from the left does.
inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d &w) {
    Eigen::Matrix3d m;
    m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return m;
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
