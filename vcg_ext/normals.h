// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NORMALS_H
#define VCG_FCD_NORMALS_H

#include <Eigen/Geometry>

namespace vcg {
namespace fcd {

/// What a map of points does to normals, but for their length; the map may flatten.
template <class Scalar>
Eigen::Matrix<Scalar, 3, 3> Cofactors(const Eigen::Matrix<Scalar, 3, 3> &map) {
    Eigen::Matrix<Scalar, 3, 3> c;
    for (int i = 0; i < 3; ++i)
        c.col(i) = map.col((i + 1) % 3).cross(map.col((i + 2) % 3));
    return c;
}

} // namespace fcd
} // namespace vcg

#endif
