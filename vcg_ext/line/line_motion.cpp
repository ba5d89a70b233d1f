// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/error.h>
#include <vcg_ext/line/line_motion.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace vcg::fcd {

LineMotion::LineMotion(FramedLine from, FramedLine to, double length)
    : from(std::move(from)), to(std::move(to)), length(length) {
    const double middle = this->from.Length() / 2, there = length / 2;
    const Eigen::Matrix3d before = this->from.At(middle).axes, after = this->to.At(there).axes;
    this->to.TurnTo(there, Eigen::Quaterniond::FromTwoVectors(before.col(0), after.col(0)) * before.col(1));
}

LineMotion::Moved LineMotion::At(double s, const Eigen::Vector3d &p) const {
    const double whole = from.Length(), ratio = length / whole;
    const double within = std::clamp(s, 0.0, whole);
    const bool isWithin = s == within;
    const FramedLine::Frame before = from.At(within), after = to.At(within * ratio);
    const Eigen::Vector3d off = p - before.point; // may reach beyond the end
    Moved moved;
    const Twist twisted = twist ? twist(within) : Twist();
    const Eigen::Vector3d along = after.axes.col(0);
    moved.turn = detail::RotationBy(twisted.angle, along) * after.axes * before.axes.transpose();
    const Eigen::Vector3d across = moved.turn * off;
    moved.position = after.point + across;
    moved.linear = moved.turn;
    moved.stretch = 1;
    moved.isFolded = false;
    if (isWithin) {
        const double open = 1 - before.bend.dot(off), openThere = 1 - after.bend.dot(across);
        moved.isFolded = open <= 0 || openThere <= 0;
        moved.stretch = openThere / open;
        const Eigen::Vector3d t = before.axes.col(0);
        moved.linear +=
            ((ratio * moved.stretch - 1) * along + twisted.slope / open * along.cross(across)) * t.transpose();
    }
    return moved;
}

Eigen::Matrix3Xd ArcPoints(const Eigen::Vector3d &middle, const Eigen::Vector3d &direction,
                           const Eigen::Vector3d &towards, double length, double degrees) {
    const double angle = degrees * detail::pi / 180;
    const Eigen::Index half = 32; // steps of less than 6 degrees
    Eigen::Matrix3Xd points(3, 2 * half + 1);
    for (Eigen::Index i = -half; i <= half; ++i) {
        const double part = 0.5 * double(i) / double(half), turned = part * angle, s = part * length;
        // sin(x) / x and (1 - cos(x)) / x, exact for small x, too
        const double sine = std::abs(turned) > 1e-8 ? detail::Sine(turned) / turned : 1,
                     rise =
                         std::abs(turned) > 1e-8 ? detail::Squared(detail::Sine(turned / 2)) * 2 / turned : turned / 2;
        points.col(half + i) = middle + s * (sine * direction + rise * towards);
    }
    return points;
}

/// Scales a vector if its square would overflow or underflow.
static Eigen::Vector3d Usable(const Eigen::Vector3d &direction) {
    const double size = direction.cwiseAbs().maxCoeff();
    return size > 0 && !(size > 1e-100 && size < 1e100) ? Eigen::Vector3d(direction / size) : direction;
}

FramedLine ArcInPlaceOf(const FramedLine &line, double length, const ArcParam &param) {
    if (!(std::abs(param.degrees) < 360))
        throw BadInput("An arc bends by less than 360 degrees to either side.");
    if (!param.direction.allFinite() || !param.towards.allFinite())
        throw BadInput("The direction of the arc, and where it bends to, must be finite.");
    const FramedLine::Frame begin = line.At(0), middle = line.At(line.Length() / 2), end = line.At(line.Length());
    Eigen::Vector3d direction = Usable(param.direction);
    const Eigen::Vector3d aim = Usable(param.towards);
    if (direction.isZero(0)) {
        direction = end.point - begin.point;
        if (direction.norm() < 1e-3 * line.Length()) // nearly closed
            direction = middle.axes.col(0);
    }
    direction.normalize();
    const auto across = [&](const Eigen::Vector3d &v) { return Eigen::Vector3d(v - v.dot(direction) * direction); };
    Eigen::Vector3d towards = across(aim);
    if (!aim.isZero(0) && towards.norm() < 1e-6 * aim.norm())
        throw BadInput("The arc cannot bend in its own direction. Let it bend to a side.");
    if (aim.isZero(0)) {
        towards = across(end.axes.col(0) - begin.axes.col(0)); // as its ends turn
        if (towards.norm() < 1e-3)
            towards = across(middle.axes.col(1));
        if (towards.norm() < 1e-3)
            towards = across(middle.axes.col(2));
    }
    return FramedLine(
        ArcPoints(Eigen::Vector3d::Zero(), direction, towards.normalized(), length, param.degrees).colwise() +
        line.Middle());
}

LineMotion MotionTo(const LineGoal &goal) {
    if (!(goal.length >= 0) || std::isinf(goal.length))
        throw BadInput("The length of the line must be a positive number, or 0 to keep it.");
    FramedLine line(goal.line, goal.smoothing);
    const double length = goal.length > 0 ? goal.length : line.Length();
    if (goal.target.cols() == 0) {
        FramedLine arc = ArcInPlaceOf(line, length, goal.arc);
        return LineMotion(std::move(line), std::move(arc), length);
    }
    try {
        return LineMotion(std::move(line), FramedLine(goal.target, goal.smoothing), length);
    } catch (const BadInput &error) {
        throw BadInput("The target line is wrong. " + std::string(error.what()));
    }
}

} // namespace vcg::fcd
