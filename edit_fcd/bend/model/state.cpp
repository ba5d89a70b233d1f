// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/state.h"

#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/words.h>

#include <algorithm>
#include <charconv>

using vcg::fcd::MotionStep;

namespace {

const std::size_t mostSteps = 32; // of undo: each may hold tags of its own

bool isSame(const MotionStep &a, const MotionStep &b) {
    return a.kind == b.kind && a.vector == b.vector && a.degrees == b.degrees && a.about == b.about &&
           a.matrix == b.matrix;
}

/// The last of \p states becomes the present one.
bool take(std::vector<BendState> &states, BendState &now) {
    if (states.empty())
        return false;
    now = states.back();
    states.pop_back();
    return true;
}

} // namespace

bool BendState::operator==(const BendState &other) const {
    return applies == other.applies && rims == other.rims && marks == other.marks && points == other.points &&
           handles == other.handles && rank == other.rank && pose == other.pose && poses == other.poses &&
           weights == other.weights && line == other.line && motion.size() == other.motion.size() &&
           std::equal(motion.begin(), motion.end(), other.motion.begin(), [](const auto &a, const auto &b) {
               return a.first == b.first &&
                      std::equal(a.second.begin(), a.second.end(), b.second.begin(), b.second.end(), isSame);
           });
}

std::vector<MotionStep> stepsOf(const vcg::fcd::Motion &motion, const Eigen::Vector3d &center) {
    const Eigen::Affine3d whole(motion.matrix);
    const Eigen::Vector3d turn = motion.Rotation(), moved = whole * center - center;
    const Eigen::Matrix3d stretch = vcg::fcd::detail::RotationBy(turn).transpose() * whole.linear();
    std::vector<MotionStep> steps;
    if (stretch.isDiagonal(1e-12) && !stretch.isIdentity(1e-12))
        steps.push_back(MotionStep::Scale(stretch.diagonal()));
    else if (!stretch.isIdentity(1e-12))
        steps.push_back(MotionStep::Affine(
            (Eigen::Translation3d(center) * Eigen::Affine3d(stretch) * Eigen::Translation3d(-center)).matrix()));
    if (turn.norm() > 1e-12)
        steps.push_back(MotionStep::Rotate(turn.normalized(), turn.norm() * 180 / vcg::fcd::detail::pi));
    if (moved.norm() > 1e-12 * (center.norm() + moved.norm()))
        steps.push_back(MotionStep::Translate(moved));
    return steps;
}

bool setPlaces(std::vector<MotionStep> &steps, const Eigen::Vector3d &center) {
    bool isSet = false;
    std::vector<MotionStep> before;
    for (MotionStep &step : steps) {
        if ((step.kind == MotionStep::Rotation || step.kind == MotionStep::Scaling) && !step.about) {
            const Eigen::Affine3d now(vcg::fcd::ToMotion(before, center).matrix);
            step.about = inFewDigits(Eigen::Vector3d(now * center));
            isSet = true;
        }
        before.push_back(step);
    }
    return isSet;
}

double inFewDigits(double x) {
    char text[32];
    const char *end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 6).ptr;
    double y = x;
    vcg::fcd::detail::ToNumber(text, end, y);
    return y == 0 ? 0 : y; // no -0
}

Eigen::Vector3d inFewDigits(const Eigen::Vector3d &v) {
    return {inFewDigits(v[0]), inFewDigits(v[1]), inFewDigits(v[2])};
}

void BendHistory::begin(const BendState &now) {
    if (!before.empty() && before.back() == now)
        return; // nothing came of the last
    before.push_back(now);
    if (before.size() > mostSteps)
        before.erase(before.begin());
    after.clear();
}

bool BendHistory::undo(BendState &now) {
    while (!before.empty() && before.back() == now)
        before.pop_back();
    if (before.empty())
        return false;
    after.push_back(now);
    return take(before, now);
}

bool BendHistory::redo(BendState &now) {
    if (after.empty())
        return false;
    before.push_back(now);
    return take(after, now);
}

bool BendHistory::cancel(BendState &now) { return take(before, now); }

void BendHistory::forget(std::size_t applies) {
    before.erase(
        std::remove_if(before.begin(), before.end(), [&](const BendState &state) { return state.applies < applies; }),
        before.end());
}
