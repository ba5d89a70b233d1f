// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_drag.h"

#include <vcg_ext/base/words.h>

#include <algorithm>
#include <charconv>
#include <cmath>

using vcg::fcd::MotionStep;

namespace {

/// A number in few digits, as people would write it; what is kept is what is written.
double rounded(double x) {
    char text[32];
    const char *end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr;
    double y = x;
    vcg::fcd::detail::ToNumber(text, end, y);
    return y == 0 ? 0 : y; // no -0
}

/// The steps and one more, joined with the last where that makes the same motion.
std::vector<MotionStep> joined(std::vector<MotionStep> steps, const MotionStep &step) {
    if (!steps.empty() && steps.back().kind == step.kind && !steps.back().about && !step.about) {
        MotionStep &last = steps.back();
        switch (step.kind) {
        case MotionStep::Translation:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = rounded(last.vector[d] + step.vector[d]);
            return steps;
        case MotionStep::Rotation:
            if (last.vector == step.vector) {
                last.degrees = rounded(last.degrees + step.degrees);
                return steps;
            }
            break;
        case MotionStep::Scaling:
            for (int d = 0; d < 3; ++d)
                last.vector[d] = rounded(last.vector[d] * step.vector[d]);
            return steps;
        case MotionStep::Matrix: break;
        }
    }
    steps.push_back(step);
    return steps;
}

} // namespace

void BendDrag::moveTo(const BendView &view, const Eigen::Vector3d &window) {
    const Eigen::Vector2d middle = view.toWindow(pivot).head<2>();
    const Eigen::Vector2d a = last.head<2>() - middle, b = window.head<2>() - middle;
    if (a.norm() > 1 && b.norm() > 1)
        angle += std::remainder(std::atan2(b[1], b[0]) - std::atan2(a[1], a[0]), 360 * degree) / degree;
    last = window;
}

std::optional<MotionStep> BendDrag::step(const BendView &view) const {
    const Eigen::Vector3d center = view.toWindow(pivot);
    const Eigen::Vector2d begun = from.head<2>(), to = last.head<2>(), middle = center.head<2>();
    double number = 0;
    const bool isTyped = vcg::fcd::detail::ToNumber(typed.data(), typed.data() + typed.size(), number);
    switch (kind) {
    case Move: {
        Eigen::Vector3d way = view.toWorld({to[0], to[1], center[2]}) - view.toWorld({begun[0], begun[1], center[2]});
        if (isTyped) {
            way = number * Eigen::Vector3d::Unit(axis < 0 ? 0 : axis);
        } else if (axis >= 0) {
            const double unit = 100 * view.pixelAt(pivot);
            const Eigen::Vector2d along = view.toWindow(pivot + unit * Eigen::Vector3d::Unit(axis)).head<2>() - middle;
            const double square = std::max(along.squaredNorm(), 100.0); // seen from its end, an axis leads nowhere
            way = (to - begun).dot(along) / square * unit * Eigen::Vector3d::Unit(axis);
        }
        for (int d = 0; d < 3; ++d)
            way[d] = rounded(way[d]);
        if (way.isZero(0))
            return {};
        return MotionStep::Translate(way);
    }
    case Turn: {
        const Eigen::Vector3d eye = view.towardsEye(pivot);
        Eigen::Vector3d about = axis < 0 ? eye : Eigen::Vector3d::Unit(axis);
        for (int d = 0; d < 3; ++d)
            about[d] = rounded(about[d]);
        const double degrees = rounded(isTyped ? number : about.dot(eye) < 0 ? -angle : angle);
        if (degrees == 0)
            return {};
        return MotionStep::Rotate(about, degrees);
    }
    case Scale: {
        const double length = std::max(20.0, (begun - middle).norm());
        double factor =
            isTyped ? number : std::max(0.01, 1 + ((to - middle).norm() - (begun - middle).norm()) / length);
        factor = rounded(factor);
        if (factor == 1 || !(factor > 0))
            return {};
        Eigen::Vector3d factors = Eigen::Vector3d::Constant(axis < 0 ? factor : 1);
        if (axis >= 0)
            factors[axis] = factor;
        return MotionStep::Scale(factors);
    }
    }
    return {};
}

std::vector<MotionStep> BendDrag::motion(const BendView &view) const {
    const std::optional<MotionStep> added = step(view);
    return added ? joined(begin, *added) : begin;
}
