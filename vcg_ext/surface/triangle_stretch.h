// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_STRETCH_H
#define VCG_FCD_TRIANGLE_STRETCH_H

#include <vcg_ext/base/elementary.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace vcg::fcd {

/// The stretch of a triangle: the factors of length in the two principal directions of its plane.
struct TriangleStretch {
    double largest = 1, smallest = 1; ///< >= 0; 1: as long as at rest, 2: twice as long
    double area = 0;                  ///< at rest, the edges' unit^2; if 0, the factors have no meaning

    /// The stretch that is farther from 1, as a power of two: 1 is twice as long, -1 half as long, 0 as it was.
    /// [-16, 16]
    float Exponent() const {
        const double farther = largest * smallest >= 1 ? largest : smallest;
        return float(detail::BinaryLogarithm(std::min(65536.0, std::max(1 / 65536.0, farther))));
    }
};

/// \param a, b two edges from one corner at rest \param nowA, nowB the same edges deformed, same unit
TriangleStretch StretchOf(const Eigen::Vector3d &a, const Eigen::Vector3d &b, const Eigen::Vector3d &nowA,
                          const Eigen::Vector3d &nowB);

} // namespace vcg::fcd

#endif
