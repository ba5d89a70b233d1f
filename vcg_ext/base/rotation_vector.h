// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ROTATION_VECTOR_H
#define VCG_FCD_ROTATION_VECTOR_H

#include <vcg_ext/base/elementary.h>

#include <Eigen/Geometry>
#include <cmath>

namespace vcg::fcd::detail {

/// The rotation by an angle, in radians, about an axis of length 1.
inline Eigen::Matrix3d RotationBy(double angle, const Eigen::Vector3d &axis) {
    const double cosine = Cosine(angle);
    const Eigen::Vector3d sines = Sine(angle) * axis, versine = (1 - cosine) * axis;
    Eigen::Matrix3d m = versine * axis.transpose();
    m.diagonal().array() += cosine;
    for (int k = 0; k < 3; ++k) {
        m((k + 2) % 3, (k + 1) % 3) += sines[k];
        m((k + 1) % 3, (k + 2) % 3) -= sines[k];
    }
    return m;
}

/// The length of \p w, also if its square overflows.
inline double Length(const Eigen::Vector3d &w) {
    const double length = w.norm();
    return std::isinf(length) ? w.stableNorm() : length;
}

/// The rotation of the rotation vector \p w: about the direction of \p w, by its length in radians.
inline Eigen::Matrix3d RotationBy(const Eigen::Vector3d &w) {
    const double angle = Length(w);
    return angle > 0 ? RotationBy(angle, w / angle) : Eigen::Matrix3d::Identity();
}

/// The angle of a rotation, in [0, pi] radians, and its axis, of length 1 (any axis if the angle is 0).
struct Turn {
    double angle;
    Eigen::Vector3d axis;

    explicit Turn(const Eigen::Matrix3d &rotation) {
        const Eigen::Quaterniond q(rotation);
        const double sine = q.vec().norm();
        angle = 2 * ArcTangent(sine, std::abs(q.w()));
        axis = sine > 0 ? Eigen::Vector3d(q.vec() / (q.w() < 0 ? -sine : sine)) : Eigen::Vector3d::UnitX();
    }
};

/// The matrix M with M v = w x v.
inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d &w) {
    Eigen::Matrix3d m;
    m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return m;
}

} // namespace vcg::fcd::detail

#endif
