// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/handles/handles.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace vcg::fcd {

namespace {

void ExpectFinite(const Eigen::Matrix4d &m) {
    if (!m.allFinite())
        throw BadInput("A transform holds a number that is not finite.");
}

/// linear = rotation * Stretch(1)
struct Polar {
    Eigen::JacobiSVD<Eigen::Matrix3d> svd;
    Eigen::Matrix3d rotation;

    explicit Polar(const Eigen::Matrix3d &linear)
        : svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV), rotation(svd.matrixU() * svd.matrixV().transpose()) {
    } // det > 0, as linear's

    Eigen::Matrix3d Stretch(double power) const {
        return svd.matrixV() *
               svd.singularValues().unaryExpr([&](double s) { return detail::Power(s, power); }).asDiagonal() *
               svd.matrixV().transpose();
    }
};

/// exp(t log(rigid)) on SE(3).
Eigen::Matrix4d Screw(const Eigen::Matrix4d &rigid, double t) {
    const detail::Turn turn(rigid.topLeftCorner<3, 3>());
    const Eigen::Vector3d &axis = turn.axis;
    const Eigen::Vector3d d = rigid.topRightCorner<3, 1>();
    const double angle = turn.angle;
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    result.topLeftCorner<3, 3>() = detail::RotationBy(t * angle, axis);
    // d = along the axis + across it; the part across is a rotation about a parallel axis through q.
    const Eigen::Vector3d along = axis * axis.dot(d), across = d - along;
    if (angle < 1e-9) {
        result.topRightCorner<3, 1>() = t * d;
        return result;
    }
    const Eigen::Vector3d q =
        0.5 * (across + axis.cross(across) * (detail::Cosine(angle / 2) / detail::Sine(angle / 2)));
    result.topRightCorner<3, 1>() = t * along + q - result.topLeftCorner<3, 3>() * q;
    return result;
}

} // namespace

Motion::Motion(const Eigen::Matrix4d &m) : matrix(m) {
    ExpectFinite(m);
    if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw BadInput("A transform is not affine: the last row of its 4 x 4 matrix must be 0 0 0 1.");
    // Of a matrix of size one: the determinants of large and small ones leave the range of numbers.
    const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>(), unit = linear / linear.cwiseAbs().maxCoeff();
    if (!(unit.determinant() > 1e-12 * unit.norm() * unit.squaredNorm()))
        throw BadInput("A transform mirrors or flattens its handle (determinant <= 0); give a rotation, a translation, "
                       "a scaling, or a combination of them.");
}

Motion::Motion(const Eigen::Matrix4d &m, const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point) : Motion(m) {
    SetTurn(wholeTurn, point);
}

Eigen::Vector3d Motion::Rotation() const {
    if (!turn.isZero(0))
        return turn;
    const detail::Turn shortest(Polar(matrix.topLeftCorner<3, 3>()).rotation);
    return shortest.angle * shortest.axis;
}

Eigen::Matrix4d Motion::At(double percent, const Eigen::Vector3d &center) const {
    if (percent == 100)
        return matrix;
    if (percent == 0)
        return Eigen::Matrix4d::Identity();
    const double t = percent / 100;
    const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
    const Polar polar(linear);
    // Motion of the center with the rotation.
    Eigen::Matrix4d rigid = Eigen::Matrix4d::Identity();
    rigid.topLeftCorner<3, 3>() = polar.rotation;
    rigid.topRightCorner<3, 1>() = linear * center + matrix.topRightCorner<3, 1>() - polar.rotation * center;
    const Eigen::Matrix4d part = turn.isZero(0) ? Screw(rigid, t) : Turned(rigid, center, t);
    Eigen::Matrix4d result = part;
    result.topLeftCorner<3, 3>() = part.topLeftCorner<3, 3>() * polar.Stretch(t);
    const Eigen::Vector3d moved = (part * center.homogeneous()).head<3>();
    result.topRightCorner<3, 1>() = moved - result.topLeftCorner<3, 3>() * center;
    return result;
}

void Motion::SetTurn(const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point) {
    const double angle = wholeTurn.norm();
    if (!std::isfinite(angle) || !point.allFinite() || angle < 3.14159)
        return;
    // The tolerance is for layers placed in single precision.
    const Eigen::Matrix3d rotation = detail::RotationBy(wholeTurn);
    if ((Polar(matrix.topLeftCorner<3, 3>()).rotation - rotation).norm() > 1e-5)
        return;
    turn = wholeTurn;
    pivot = point;
}

/// The fraction t of \p rigid by way of the turn, for \p center.
Eigen::Matrix4d Motion::Turned(const Eigen::Matrix4d &rigid, const Eigen::Vector3d &center, double t) const {
    // Axis and angle are those of the matrix, so that the way ends there, but near the identity, which has no axis.
    const double fullTurn = 2 * detail::pi;
    const detail::Turn shortest(rigid.topLeftCorner<3, 3>());
    Eigen::Vector3d axis = turn.normalized();
    const double side = shortest.axis.dot(axis);
    double angle = shortest.angle * side;
    if (shortest.angle > 1e-6) {
        axis = side < 0 ? Eigen::Vector3d(-shortest.axis) : shortest.axis;
        angle = side < 0 ? -shortest.angle : shortest.angle;
    }
    angle += fullTurn * std::round((turn.norm() - angle) / fullTurn);

    const Eigen::Matrix3d rotation = detail::RotationBy(t * angle, axis);
    const Eigen::Vector3d arm = center - pivot;
    const Eigen::Vector3d rest = (rigid * center.homogeneous()).head<3>() - rigid.topLeftCorner<3, 3>() * arm - pivot;
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    result.topLeftCorner<3, 3>() = rotation;
    result.topRightCorner<3, 1>() = pivot + rotation * arm + t * rest - rotation * center;
    return result;
}

Motion Blend(const std::vector<std::pair<Motion, double>> &motions, const Eigen::Vector3d &center) {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero(), moved = Eigen::Vector3d::Zero();
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Zero(); // its logarithm
    int count = 0;
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (const auto &[motion, percent] : motions) {
        if (percent == 0)
            continue;
        ++count;
        const double t = percent / 100;
        matrix = motion.At(percent, center);
        turn += t * motion.Rotation();
        moved += (matrix * center.homogeneous()).head<3>() - center;
        const Polar polar(motion.matrix.topLeftCorner<3, 3>());
        const Eigen::Vector3d factors = polar.svd.singularValues();
        stretch += t * (polar.svd.matrixV() * factors.unaryExpr(&detail::Logarithm).asDiagonal() *
                        polar.svd.matrixV().transpose());
    }
    if (count > 1) {
        Eigen::Matrix3d linear = detail::RotationBy(turn);
        ExpectFinite(Eigen::Matrix4d::Constant(stretch.sum())); // the solver below would not come to an end
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(stretch);
        linear *= axes.eigenvectors() * axes.eigenvalues().unaryExpr(&detail::Exponential).asDiagonal() *
                  axes.eigenvectors().transpose();
        matrix.topLeftCorner<3, 3>() = linear;
        matrix.topRightCorner<3, 1>() = center + moved - linear * center;
    }
    return Motion(matrix, turn, center);
}

Eigen::Matrix4d Handles::ToMesh(const Eigen::Matrix4d &motion) const {
    if (world.matrix().isIdentity(0) || motion.isIdentity(0))
        return motion;
    Eigen::Matrix4d m = (world.inverse() * Eigen::Affine3d(motion) * world).matrix();
    m.row(3) << 0, 0, 0, 1;
    return m;
}

void ExpectTags(const std::vector<int> &tag, std::size_t slots) {
    if (tag.size() != slots)
        throw BadInput("There are " + std::to_string(tag.size()) + " tags for " + std::to_string(slots) +
                       " vertices; give one tag per vertex.");
}

TagCount CountTags(const std::vector<int> &tag, const char *deleted, unsigned threads) {
    const std::size_t grain = 1 << 16;
    std::vector<TagCount> counts((tag.size() + grain - 1) / grain);
    ParallelFor(threads, tag.size(), grain, [&](std::size_t first, std::size_t last) {
        TagCount here;
        for (std::size_t i = first; i < last; ++i)
            if (!deleted || !deleted[i])
                ++(tag[i] < 0 ? here.outside : tag[i] == 0 ? here.fixed : tag[i] == 1 ? here.free : here.handle);
        counts[first / grain] = here;
    });
    TagCount count;
    for (const TagCount &here : counts) {
        count.fixed += here.fixed;
        count.handle += here.handle;
        count.free += here.free;
        count.outside += here.outside;
    }
    return count;
}

} // namespace vcg::fcd
