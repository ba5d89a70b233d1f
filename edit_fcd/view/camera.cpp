// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/camera.h"

#include <algorithm>

Eigen::Vector3d Camera::toWindow(const Eigen::Vector3d &world) const {
    const Eigen::Vector4d clip = toClip * world.homogeneous();
    if (!(clip[3] > 0))
        return {-1e6, -1e6, 2};
    const Eigen::Vector3d ndc = clip.hnormalized();
    return {(ndc[0] + 1) / 2 * width, (ndc[1] + 1) / 2 * height, (ndc[2] + 1) / 2};
}

Eigen::Vector3d Camera::toWorld(const Eigen::Vector3d &window) const {
    const Eigen::Vector4d ndc(2 * window[0] / width - 1, 2 * window[1] / height - 1, 2 * window[2] - 1, 1);
    return (fromClip * ndc).hnormalized();
}

Eigen::Vector3d Camera::towardsEye(const Eigen::Vector3d &at) const {
    const Eigen::Vector3d window = toWindow(at);
    return (toWorld({window[0], window[1], window[2] - 1e-3}) - at).normalized();
}

double Camera::pixelAt(const Eigen::Vector3d &at) const {
    const Eigen::Vector3d window = toWindow(at);
    return (toWorld({window[0] + 1, window[1], window[2]}) - at).norm();
}

double distanceToSegment(const Eigen::Vector2d &p, const Eigen::Vector2d &a, const Eigen::Vector2d &b) {
    const Eigen::Vector2d offset = b - a;
    const double square = offset.squaredNorm();
    const double t = square > 0 ? std::min(1.0, std::max(0.0, (p - a).dot(offset) / square)) : 0;
    return (a + t * offset - p).norm();
}
