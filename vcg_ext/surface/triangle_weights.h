// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_WEIGHTS_H
#define VCG_FCD_TRIANGLE_WEIGHTS_H

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace vcg::fcd::detail {

/// Barycentric coordinates of the point of a triangle that is nearest to p (C. Ericson, Real-Time Collision
/// Detection, 5.1.5).
inline Eigen::Vector3d WeightsOfNearest(const Eigen::Vector3d &a, const Eigen::Vector3d &b, const Eigen::Vector3d &c,
                                        const Eigen::Vector3d &p) {
    const Eigen::Vector3d ab = b - a, ac = c - a;
    const double d1 = ab.dot(p - a), d2 = ac.dot(p - a), d3 = ab.dot(p - b), d4 = ac.dot(p - b), d5 = ab.dot(p - c),
                 d6 = ac.dot(p - c);
    if (d1 <= 0 && d2 <= 0)
        return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3)
        return {0, 1, 0};
    if (d6 >= 0 && d5 <= d6)
        return {0, 0, 1};
    // Products of four lengths, up to these squares. Where they would be no numbers, those of a scaled triangle are.
    const double side = std::max(d1 - d3, d2 - d6), reach = side + (p - a).squaredNorm();
    if (side > 0 && !(side * reach > 1e-200 && side * reach < 1e200)) {
        const double unit = std::ldexp(1.0, -(std::ilogb(side) + std::ilogb(reach)) / 4);
        return WeightsOfNearest(a * unit, b * unit, c * unit, p * unit);
    }
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return {0, 1 - w, w};
    }
    const double sum = va + vb + vc;
    return {va / sum, vb / sum, vc / sum};
}

} // namespace vcg::fcd::detail

#endif
