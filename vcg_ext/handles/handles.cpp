// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/handles/handles.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
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

/// How far a body moves in unit time that begins at \p speed and turns by \p turn at an even rate.
Eigen::Vector3d Arc(const Eigen::Vector3d &turn, const Eigen::Vector3d &speed) {
    const double angle = detail::Length(turn);
    if (angle == 0)
        return speed;
    const Eigen::Vector3d axis = turn / angle, along = axis * axis.dot(speed), across = speed - along;
    const double half = detail::Sine(angle / 2);
    return along + detail::Sine(angle) / angle * across + 2 * half * half / angle * axis.cross(across);
}

/// The path of a handle's center in a motion, without scaling: an arc, and a straight line added to it.
struct CenterPath {
    Eigen::Vector3d turn;     ///< rotation vector of the arc
    Eigen::Vector3d speed;    ///< derivative of the center at the start of the arc; the whole path takes a time of 1
    Eigen::Vector3d straight; ///< the straight part

    CenterPath(const Motion &motion, const Eigen::Matrix3d &rotation, const Eigen::Vector3d &center);

    /// How far the share \p t of the path moves the center, if it turns by \p arc meanwhile.
    Eigen::Vector3d Moved(double t, const Eigen::Vector3d &arc) const { return Arc(arc, t * speed) + t * straight; }
};

/// How much two paths turn the center about the same axis: 2 a b / (a^2 + b^2), where a and b are the vectors from the
/// center to the nearest places on both axes. 0 if these lie on different sides, or if one is at the center, or far.
double SameAxis(const CenterPath &one, const CenterPath &other) {
    const double a = one.turn.squaredNorm(), b = other.turn.squaredNorm();
    const double unit = detail::UnitOf(std::max(one.speed.cwiseAbs().maxCoeff(), other.speed.cwiseAbs().maxCoeff()));
    const Eigen::Vector3d toOne = one.turn.cross(one.speed / unit) * b,
                          toOther = other.turn.cross(other.speed / unit) * a; // times a b
    const double sum = toOne.squaredNorm() + toOther.squaredNorm();
    return sum > 0 ? std::max(0.0, 2 * toOne.dot(toOther) / sum) : 0;
}

/// \param rotation of the motion's matrix
CenterPath::CenterPath(const Motion &motion, const Eigen::Matrix3d &rotation, const Eigen::Vector3d &center) {
    const detail::Turn shortest(rotation);
    const Eigen::Vector3d moved = (motion.matrix * center.homogeneous()).head<3>() - center;
    if (motion.turn.isZero(0)) { // log(rigid) on SE(3)
        turn = shortest.angle * shortest.axis;
        straight = shortest.axis * shortest.axis.dot(moved);
        const Eigen::Vector3d across = moved - straight;
        const double half = shortest.angle / 2;
        speed = (half > 0 ? half * detail::Cosine(half) / detail::Sine(half) : 1) * across - 0.5 * turn.cross(across);
        return;
    }
    // Axis and angle are those of the matrix, so that the path ends at it; near the identity they are those of the
    // turn.
    const double fullTurn = 2 * detail::pi;
    const double whole = detail::Length(motion.turn);
    Eigen::Vector3d axis = motion.turn / whole;
    const double side = shortest.axis.dot(axis);
    double angle = shortest.angle * side;
    if (shortest.angle > 1e-6) {
        axis = side < 0 ? Eigen::Vector3d(-shortest.axis) : shortest.axis;
        angle = side < 0 ? -shortest.angle : shortest.angle;
    }
    angle += fullTurn * std::round((whole - angle) / fullTurn);
    turn = angle * axis;
    const Eigen::Vector3d arm = center - motion.pivot;
    speed = turn.cross(arm);
    straight = moved - (rotation * arm - arm);
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
    const Polar polar(matrix.topLeftCorner<3, 3>());
    const CenterPath path(*this, polar.rotation, center);
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    result.topLeftCorner<3, 3>() = detail::RotationBy(t * path.turn) * polar.Stretch(t);
    result.topRightCorner<3, 1>() = center + path.Moved(t, t * path.turn) - result.topLeftCorner<3, 3>() * center;
    return result;
}

void Motion::SetTurn(const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point) {
    const double angle = detail::Length(wholeTurn);
    if (!std::isfinite(angle) || !point.allFinite() || angle < 3.14159)
        return;
    // The tolerance is for layers placed in single precision.
    const Eigen::Matrix3d rotation = detail::RotationBy(wholeTurn);
    if ((Polar(matrix.topLeftCorner<3, 3>()).rotation - rotation).norm() > 1e-5)
        return;
    turn = wholeTurn;
    pivot = point;
}

Motion Blend(const std::vector<std::pair<Motion, double>> &motions, const Eigen::Vector3d &center) {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero(), moved = Eigen::Vector3d::Zero();
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Zero(); // its logarithm
    std::vector<std::pair<CenterPath, double>> paths;
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (const auto &[motion, percent] : motions) {
        if (percent == 0)
            continue;
        const double t = percent / 100;
        const Polar polar(motion.matrix.topLeftCorner<3, 3>());
        if (paths.empty())
            matrix = motion.At(percent, center);
        const CenterPath &path = paths.emplace_back(CenterPath(motion, polar.rotation, center), t).first;
        turn += t * path.turn;
        const Eigen::Vector3d factors = polar.svd.singularValues();
        stretch += t * (polar.svd.matrixV() * factors.unaryExpr(&detail::Logarithm).asDiagonal() *
                        polar.svd.matrixV().transpose());
    }
    if (paths.size() > 1) {
        for (const auto &[path, t] : paths) {
            Eigen::Vector3d arc = t * path.turn;
            for (const auto &[other, share] : paths)
                if (&other != &path)
                    arc += SameAxis(path, other) * share * other.turn;
            moved += path.Moved(t, arc);
        }
        ExpectFinite(Eigen::Matrix4d::Constant(stretch.sum())); // the solver below would not come to an end
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(stretch);
        matrix.topLeftCorner<3, 3>() = detail::RotationBy(turn) * axes.eigenvectors() *
                                       axes.eigenvalues().unaryExpr(&detail::Exponential).asDiagonal() *
                                       axes.eigenvectors().transpose();
        matrix.topRightCorner<3, 1>() = center + moved - matrix.topLeftCorner<3, 3>() * center;
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

TagCount CountTags(const std::vector<int> &tag, const char *deleted) {
    Index count[4] = {}; // outside, fixed, free, handles
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (!deleted || !deleted[i])
            ++count[std::clamp(tag[i], -1, 2) + 1];
    return {count[1], count[3], count[2], count[0]};
}

} // namespace vcg::fcd
