// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/frame.h>

#include <Eigen/LU>
#include <string>

namespace vcg::fcd {

void Frame::SetMetric(const Eigen::Matrix3d &linear) {
    metric = linear;
    inverseMetric = linear.inverse();
    isSame = metric.isIdentity(0);
    if (!linear.allFinite() || !inverseMetric.allFinite())
        throw BadInput("The matrix of the layer flattens it or is not finite; apply or reset the matrix first.");
}

namespace detail {

BadInput NotFinite(std::size_t vertex) {
    return BadInput("Vertex " + std::to_string(vertex) +
                    " has a coordinate that is not a finite number; remove such vertices first.");
}

} // namespace detail
} // namespace vcg::fcd
