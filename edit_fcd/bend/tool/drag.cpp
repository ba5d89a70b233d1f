// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/tool/drag.h"

#include <algorithm>
#include <cmath>

using vcg::fcd::MotionStep;

/// Appends a step, or joins it with the last one if that makes the same motion.
static std::vector<MotionStep> withStep(std::vector<MotionStep> steps, const MotionStep &step) {
    if (!steps.empty() && steps.back().kind == step.kind && steps.back().about == step.about) {
        MotionStep &last = steps.back();
        switch (step.kind) {
        case MotionStep::Translation:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = inFewDigits(last.vector[d] + step.vector[d]);
            return steps;
        case MotionStep::Rotation:
            if (last.vector == step.vector) {
                last.degrees = inFewDigits(last.degrees + step.degrees);
                return steps;
            }
            break;
        case MotionStep::Scaling:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = inFewDigits(last.vector[d] * step.vector[d]);
            return steps;
        case MotionStep::Matrix: break;
        }
    }
    steps.push_back(step);
    return steps;
}

void BendDrag::moveTo(const Camera &view, const Eigen::Vector3d &window) {
    const Eigen::Vector2d middle = view.toWindow(pivot).head<2>();
    const Eigen::Vector2d a = last.head<2>() - middle, b = window.head<2>() - middle;
    if (a.norm() > 1 && b.norm() > 1)
        angle += std::remainder(std::atan2(b[1], b[0]) - std::atan2(a[1], a[0]), 360 * oneDegree) / oneDegree;
    last = window;
    if (kind != Limb)
        return;
    const Eigen::Vector3d root = before ? before->pivot : pivot;
    const std::optional<Eigen::Vector3d> bendsAt = before ? std::optional(pivot) : std::nullopt;
    if (!limb || !limb->isOf(root, bendsAt))
        limb.emplace(root, bendsAt, held);
    limb->moveTo(view, from, window);
}

/// The largest round number (1, 2 or 5 times a power of ten) up to x.
static double roundBelow(double x) {
    const double power = std::pow(10, std::floor(std::log10(x)));
    return (x >= 5 * power ? 5 : x >= 2 * power ? 2 : 1) * power;
}

static double inSteps(double x, double step) { return std::round(x / step) * step; }

const double snapPixels = 20, snapDegrees = 5, snapFactor = 0.1; // steps that the user can hit

const double leastDegrees = 1e-4; // less is rounding

/// \return whether the typed text is a number
bool BendDrag::readTyped(double &number) const {
    return vcg::fcd::detail::ToNumber(typed.data(), typed.data() + typed.size(), number) && std::isfinite(number);
}

bool BendDrag::isRefused() const {
    double number = 0;
    return !typed.empty() && !readTyped(number);
}

bool BendDrag::isBeginning(const Camera &view) const {
    return modal && axis < 0 && typed.empty() && steps(view).empty();
}

/// The step of a limb's turn; none if it is hardly a turn.
std::optional<MotionStep> BendDrag::turnOf(const Eigen::AngleAxisd &turn, const Eigen::Vector3d &about) const {
    const double turned = turn.angle() / oneDegree, degrees = inFewDigits(snap ? inSteps(turned, snapDegrees) : turned);
    if (std::abs(degrees) < leastDegrees || !turn.axis().allFinite())
        return {};
    MotionStep made = MotionStep::Rotate(inFewDigits(turn.axis()), degrees);
    made.about = inFewDigits(about);
    return made;
}

BendDrag::Steps BendDrag::steps(const Camera &view) const {
    Steps all;
    if (does() == Limb && limb && before)
        if (const auto bent = turnOf(limb->bend(), pivot))
            all.push_back(*bent);
    if (const auto turned = step(view))
        all.push_back(*turned);
    return all;
}

std::optional<MotionStep> BendDrag::step(const Camera &view) const {
    const Eigen::Vector3d center = view.toWindow(pivot);
    const Eigen::Vector2d begun = from.head<2>(), to = last.head<2>(), middle = center.head<2>();
    double number = 0;
    const bool isTyped = !typed.empty();
    if (isTyped && !readTyped(number))
        return {};
    const auto about = [&](MotionStep step) {
        if (isAbout)
            step.about = inFewDigits(pivot);
        return step;
    };
    switch (does()) {
    case Limb: return limb ? turnOf(limb->turn(), before ? before->pivot : pivot) : std::nullopt;
    case Move: {
        const double pixel = view.pixelAt(pivot), length = roundBelow(snapPixels * pixel);
        Eigen::Vector3d offset =
            view.toWorld({to[0], to[1], center[2]}) - view.toWorld({begun[0], begun[1], center[2]});
        if (onto && !isTyped) {
            offset = *onto - pivot;
            if (axis >= 0)
                offset = offset.dot(axes.col(axis)) * axes.col(axis);
        } else if (isTyped) {
            offset = number * axes.col(axis < 0 ? 0 : axis);
        } else if (axis >= 0) {
            const double unit = 100 * pixel;
            const Eigen::Vector2d along = view.toWindow(pivot + unit * axes.col(axis)).head<2>() - middle;
            const double square = std::max(along.squaredNorm(), 100.0); // for an axis along the view direction
            const double far = (to - begun).dot(along) / square * unit;
            offset = (snap ? inSteps(far, length) : far) * axes.col(axis);
        } else if (snap) {
            for (int d = 0; d < 3; ++d)
                offset[d] = inSteps(offset[d], length);
        }
        offset = inFewDigits(offset);
        if (offset.isZero(0))
            return {};
        return MotionStep::Translate(offset);
    }
    case Turn: {
        const Eigen::Vector3d eye = view.towardsEye(pivot);
        const Eigen::Vector3d line = inFewDigits(axis < 0 ? eye : Eigen::Vector3d(axes.col(axis)));
        const double turned = snap ? inSteps(angle, snapDegrees) : angle;
        const double degrees = inFewDigits(isTyped ? number : line.dot(eye) < 0 ? -turned : turned);
        if (degrees == 0)
            return {};
        return about(MotionStep::Rotate(line, degrees));
    }
    case Scale: {
        const double length = std::max(20.0, (begun - middle).norm());
        double factor = isTyped ? number : 1 + ((to - middle).norm() - (begun - middle).norm()) / length;
        if (!isTyped)
            factor = std::max(snap ? snapFactor : 0.01, snap ? inSteps(factor, snapFactor) : factor);
        factor = inFewDigits(factor);
        if (factor == 1 || !(factor > 0))
            return {};
        Eigen::Vector3d factors = Eigen::Vector3d::Constant(axis < 0 ? factor : 1);
        if (axis >= 0)
            factors[axis] = factor;
        if (axis < 0 || axes.isIdentity(0))
            return about(MotionStep::Scale(factors));
        const Eigen::Affine3d scaled = Eigen::Translation3d(pivot) * Eigen::Affine3d(axes * factors.asDiagonal()) *
                                       Eigen::Affine3d(Eigen::Matrix3d(axes.inverse())) * Eigen::Translation3d(-pivot);
        return MotionStep::Affine(scaled.matrix());
    }
    }
    return {};
}

std::string BendDrag::text(const Camera &view) const {
    const Kind what = does();
    std::string text = what == Move ? "move" : what == Turn ? "turn" : what == Limb ? "turn the limb" : "scale";
    if (axis >= 0)
        text += std::string(what == Turn ? " about " : " along ") + "xyz"[axis];
    else if (!typed.empty() && what == Move)
        text += " along x";
    if (!typed.empty())
        return text + " " + typed + "_" +
               (isRefused() ? ", which is no number: Backspace takes back what was typed" : "");
    const std::string wheel = std::string("; wheel: ") + (what == Limb ? "another joint" : "how far");
    if (isBeginning(view))
        return text + ": move the mouse, X Y Z, " +
               (what == Move    ? "a length"
                : what == Scale ? "a factor"
                                : "degrees") +
               wheel + "; Enter, Esc" + (what == Turn ? "; or drag along a limb" : "");
    const auto added = step(view);
    const auto digits = [](double x) { return inDigits(x, 4); };
    if (what == Move)
        return text + " by " + digits(added ? added->vector.norm() : 0) + (onto ? ", to the other surface" : "");
    if (what == Turn || what == Limb)
        text += " by " + digits(added ? added->degrees : 0) + " degrees";
    if (what == Limb && before && limb)
        text += ", its middle joint by " + digits(limb->bend().angle() / oneDegree);
    if (what == Limb)
        text += wheel;
    return text;
}

std::map<int, BendDrag::Steps> BendDrag::motions(const Camera &view) const {
    std::map<int, Steps> all = carried;
    all[tag] = begin;
    const Steps added = steps(view);
    Steps placed = added;
    setPlaces(placed, pivot); // all about this pivot, not each about its own middle
    for (std::size_t i = 0; i < added.size(); ++i) {
        all[tag] = withStep(all[tag], added[i]);
        for (const auto &each : carried)
            all[each.first] = withStep(all[each.first], placed[i]);
    }
    if (!before)
        return all;
    const auto turned = does() == Limb ? step(view) : std::nullopt;
    for (const auto &[other, begun] : before->carried)
        all[other] = turned ? withStep(begun, *turned) : begun;
    return all;
}

// Distance from the joint, over the limb's length, below which a limb of one piece leaves the view plane. In the plane,
// a move of the mouse there turns it twice as much as at its end, and nearer the joint ever more.
const double nearestOfPiece = 0.5;

const double mostBent = 150 * oneDegree; // of an elbow or a knee; beyond, the bones would overlap

// Sine of the least bend that tells a chain's plane; others bend in the view plane.
const double leastBent = 0.02;

// Over the length: a limb that points away from the eye by more than that stays so; all others turn towards the eye.
const double clearlyAway = 0.1;

const double pixels = 10; // of a step: the result depends on the path of the mouse, and not on the times of its events

static double angleOf(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); }

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
    // The law of cosines.
    return std::sqrt(std::max(0.0, first * first + second * second + 2 * first * second * std::cos(angle)));
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
    const Eigen::Vector3d begin = window, offset = to - begin;
    const int steps = std::max(1, int(std::ceil(offset.head<2>().norm() / pixels)));
    for (int i = 1; i <= steps; ++i) {
        const Eigen::Vector3d next = aimAt(view, from, begin + double(i) / steps * offset);
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
