// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>

namespace vcg::fcd::detail {

Eigen::Vector4d ToQuaternion(const Eigen::Matrix3d &rotation) {
    const Eigen::Quaterniond q(rotation);
    return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

Eigen::Matrix3d ToMatrix(const Eigen::Vector4d &q) {
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

Eigen::Vector4d FitQuaternion(const Eigen::Matrix3d &unscaled, const Eigen::Vector4d &near) {
    const double size = unscaled.cwiseAbs().maxCoeff();
    if (!(size > 0) || !std::isfinite(size))
        return Eigen::Vector4d::UnitX();
    const Eigen::Matrix3d s = unscaled * (1 / size);
    Eigen::Matrix4d k;
    k(0, 0) = s(0, 0) + s(1, 1) + s(2, 2);
    k(1, 1) = s(0, 0) - s(1, 1) - s(2, 2);
    k(2, 2) = s(1, 1) - s(0, 0) - s(2, 2);
    k(3, 3) = s(2, 2) - s(0, 0) - s(1, 1);
    k(0, 1) = k(1, 0) = s(1, 2) - s(2, 1);
    k(0, 2) = k(2, 0) = s(2, 0) - s(0, 2);
    k(0, 3) = k(3, 0) = s(0, 1) - s(1, 0);
    k(1, 2) = k(2, 1) = s(0, 1) + s(1, 0);
    k(1, 3) = k(3, 1) = s(2, 0) + s(0, 2);
    k(2, 3) = k(3, 2) = s(1, 2) + s(2, 1);
    const double norm2 = s.squaredNorm(), c2 = -2 * norm2, c1 = -8 * s.determinant(), c0 = k.determinant();
    const auto slope = [&](double x) { return (4 * x * x + 2 * c2) * x + c1; };
    const auto value = [&](double x) { return (x * x + c2) * x * x + c1 * x + c0; };
    // The Rayleigh quotient lies below the root. If the quartic is convex and rises there, Newton's step leads above
    // the root.
    double lambda = near.dot(k * near);
    if (lambda > 0 && 3 * lambda * lambda > norm2 && slope(lambda) > 0.1 * norm2 * lambda)
        lambda -= value(lambda) / slope(lambda);
    else
        lambda = std::sqrt(3 * norm2);
    for (int i = 0; i < 50 && value(lambda) > 1e-14 * norm2 * norm2; ++i) // up to rounding
        lambda -= value(lambda) / slope(lambda);

    k.diagonal().array() -= lambda;
    const auto adjugate = [&](int column) {
        const int i = (column + 1) & 3, j = (column + 2) & 3, l = (column + 3) & 3;
        const double m01 = k(i, 0) * k(j, 1) - k(i, 1) * k(j, 0), m02 = k(i, 0) * k(j, 2) - k(i, 2) * k(j, 0),
                     m03 = k(i, 0) * k(j, 3) - k(i, 3) * k(j, 0), m12 = k(i, 1) * k(j, 2) - k(i, 2) * k(j, 1),
                     m13 = k(i, 1) * k(j, 3) - k(i, 3) * k(j, 1), m23 = k(i, 2) * k(j, 3) - k(i, 3) * k(j, 2);
        return Eigen::Vector4d(
            k(l, 1) * m23 - k(l, 2) * m13 + k(l, 3) * m12, k(l, 2) * m03 - k(l, 0) * m23 - k(l, 3) * m02,
            k(l, 0) * m13 - k(l, 1) * m03 + k(l, 3) * m01, k(l, 1) * m02 - k(l, 0) * m12 - k(l, 2) * m01);
    };
    // Each column is a multiple of the quaternion; the longest is the column of its largest component.
    int column;
    near.cwiseAbs().maxCoeff(&column);
    Eigen::Vector4d q = adjugate(column);
    for (int other = 0; other < 4 && 2 * std::abs(q[column]) < q.norm(); ++other) {
        const Eigen::Vector4d candidate = adjugate(other);
        if (candidate.squaredNorm() > q.squaredNorm()) {
            q = candidate;
            column = other;
        }
    }
    const double length2 = q.squaredNorm();
    if (!(length2 >= 1e-9 * norm2 * norm2 * norm2)) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d u = svd.matrixU();
        if ((svd.matrixV() * u.transpose()).determinant() < 0)
            u.col(2) *= -1; // singular values are sorted: the smallest is the last
        return ToQuaternion(svd.matrixV() * u.transpose());
    }
    return q / std::sqrt(length2);
}

Eigen::Matrix3d FitRotation(const Eigen::Matrix3d &s) { return ToMatrix(FitQuaternion(s)); }

Eigen::Matrix3d RotationOf(const Eigen::Matrix3d &linear) { return FitRotation(linear.transpose()); }

} // namespace vcg::fcd::detail
