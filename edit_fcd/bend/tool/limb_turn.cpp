// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/limb_turn.h"

#include <algorithm>
#include <cmath>

namespace {

// Distance from the joint, over the limb's length, below which a limb of one piece leaves the view plane. In the plane,
// a move of the mouse there turns it twice as much as at its end, and nearer the joint ever more.
const double nearestOfPiece = 0.5;

const double mostBent = 150 * oneDegree; // of an elbow or a knee; beyond, the bones would overlap

// Sine of the least bend that tells a chain's plane; others bend in the view plane.
const double leastBent = 0.02;

// Over the length: a limb that points away from the eye by more than that stays so; all others turn towards the eye.
const double clearlyAway = 0.1;

const double pixels = 10; // of a step: the result depends on the path of the mouse, and not on the times of its events

double angleOf(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); }

} // namespace

LimbTurn::LimbTurn(const Eigen::Vector3d &root, const std::optional<Eigen::Vector3d> &middle,
                   const Eigen::Vector3d &held)
    : root(root), held(held), middle(middle), length((held - root).norm()), nearest(nearestOfPiece * length) {
    if (!middle)
        return;
    const Eigen::Vector3d one = *middle - root, other = held - *middle;
    first = one.norm();
    second = other.norm();
    const Eigen::Vector3d across = one.cross(other);
    begun = std::atan2(across.norm(), one.dot(other));
    most = std::max(begun, mostBent);
    if (across.norm() > leastBent * first * second)
        axis = across.normalized();
    length = first + second;
    nearest = lengthAt(most);
}

/// The distance from root to held, if the chain is bent by an angle.
double LimbTurn::lengthAt(double angle) const {
    return std::sqrt(
        std::max(0.0, first * first + second * second + 2 * first * second * std::cos(angle))); // law of cosines
}

/// The angle at the root between the first bone and the held point.
double LimbTurn::aside(double angle) const {
    return std::atan2(second * std::sin(angle), first + second * std::cos(angle));
}

/// The vector from the root to where the mouse leads the held point.
Eigen::Vector3d LimbTurn::aimAt(const Camera &view, const Eigen::Vector3d &from, const Eigen::Vector3d &to) const {
    const Eigen::Vector3d eye = view.towardsEye(held), start = held - root;
    const double depth = view.toWindow(held)[2];
    const Eigen::Vector3d wanted =
        start + view.toWorld({to[0], to[1], depth}) - view.toWorld({from[0], from[1], depth});
    double deep = wanted.dot(eye);
    const Eigen::Vector3d flat = wanted - deep * eye;
    const double far = flat.norm();
    if (wanted.norm() > length) // first, it turns into the view plane
        deep = std::copysign(std::sqrt(std::max(0.0, length * length - far * far)), deep);
    if (far >= nearest)
        return flat + deep * eye;
    const double pole = start.dot(eye) < -clearlyAway * length ? -EIGEN_PI / 2 : EIGEN_PI / 2,
                 rise = pole + far / nearest * (std::atan2(deep, nearest) - pole);
    return std::hypot(nearest, deep) * (std::cos(rise) / std::max(far, 1e-9 * length) * flat + std::sin(rise) * eye);
}

void LimbTurn::moveTo(const Camera &view, const Eigen::Vector3d &from, const Eigen::Vector3d &to) {
    if (aim.isZero(0)) {
        window = from;
        aim = aimAt(view, from, from);
        aimed = aim.norm();
        if (middle && axis.isZero(0)) {
            const Eigen::Vector3d along = (held - root).normalized(), eye = view.towardsEye(held);
            const Eigen::Vector3d flat = eye - eye.dot(along) * along;
            axis = flat.norm() > leastBent ? Eigen::Vector3d(flat.normalized()) : along.unitOrthogonal();
        }
    }
    const Eigen::Vector3d begin = window, way = to - begin;
    const int steps = std::max(1, int(std::ceil(way.head<2>().norm() / pixels)));
    for (int i = 1; i <= steps; ++i) {
        const Eigen::Vector3d next = aimAt(view, from, begin + double(i) / steps * way);
        turned = (Eigen::Quaterniond::FromTwoVectors(aim, next) * turned).normalized();
        aim = next;
    }
    window = to;
}

/// The present bend of the chain.
double LimbTurn::bent() const {
    const double distance = std::clamp(lengthAt(begun) + aim.norm() - aimed, nearest, length);
    return angleOf((distance * distance - first * first - second * second) / (2 * first * second));
}

Eigen::AngleAxisd LimbTurn::bend() const {
    return middle && !aim.isZero(0) ? Eigen::AngleAxisd(bent() - begun, axis)
                                    : Eigen::AngleAxisd(0, Eigen::Vector3d::UnitZ());
}

Eigen::AngleAxisd LimbTurn::turn() const {
    const double back = middle && !aim.isZero(0) ? aside(begun) - aside(bent()) : 0;
    return Eigen::AngleAxisd(turned *
                             Eigen::AngleAxisd(back, middle ? axis : Eigen::Vector3d(Eigen::Vector3d::UnitZ())));
}
