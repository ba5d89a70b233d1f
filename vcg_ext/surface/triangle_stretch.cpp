// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/triangle_stretch.h>

#include <cmath>

namespace vcg::fcd {

TriangleStretch StretchOf(const Eigen::Vector3d &a, const Eigen::Vector3d &b, const Eigen::Vector3d &nowA,
                          const Eigen::Vector3d &nowB) {
    TriangleStretch stretch;
    const double length = a.norm(), twice = a.cross(b).norm();
    if (!(twice > 0) || !std::isfinite(twice) || !nowA.allFinite() || !nowB.allFinite())
        return stretch;
    stretch.area = twice / 2;
    // The images of the unit vector along a, and of the one perpendicular to it.
    const Eigen::Vector3d along = nowA / length, across = (nowB - a.dot(b) / length * along) * (length / twice);
    const double mean = (along.squaredNorm() + across.squaredNorm()) / 2;
    const double difference = (along.squaredNorm() - across.squaredNorm()) / 2, both = along.dot(across);
    const double deviation = std::sqrt(difference * difference + both * both);
    stretch.largest = std::sqrt(mean + deviation);
    stretch.smallest = stretch.largest > 0 ? along.cross(across).norm() / stretch.largest : 0;
    return stretch;
}

} // namespace vcg::fcd
