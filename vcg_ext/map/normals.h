// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NORMALS_H
#define VCG_FCD_NORMALS_H

#include <Eigen/Geometry>
#include <cmath>

namespace vcg::fcd {

/// The matrix that turns normals if \p map moves points, up to their length. The map may be singular.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> Cofactors(const Eigen::Matrix<Scalar, 3, 3> &map) {
    Eigen::Matrix<Scalar, 3, 3> c;
    for (int i = 0; i < 3; ++i)
        c.col(i) = map.col((i + 1) % 3).cross(map.col((i + 2) % 3));
    return c;
}

/// A normal turned by a map of points, with its length kept. It keeps its bits if the map is the identity or leaves it
/// without a direction.
inline Eigen::Vector3d Turned(const Eigen::Matrix3f &map, const Eigen::Vector3d &normal) {
    const Eigen::Vector3d after = (Cofactors(map) * normal.cast<float>()).cast<double>();
    const double square = after.squaredNorm();
    return square > 0 && !map.isIdentity(0) ? Eigen::Vector3d(after * std::sqrt(normal.squaredNorm() / square))
                                            : normal;
}

} // namespace vcg::fcd

#endif
