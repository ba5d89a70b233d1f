// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/steps.h"

#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/words.h>

#include <Eigen/Eigenvalues>

#include <charconv>

using vcg::fcd::MotionStep;

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

std::string inDigits(double x, int digits) {
    char text[32];
    return std::string(text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, digits).ptr);
}

double inFewDigits(double x) {
    const std::string text = inDigits(x, 6);
    double y = x;
    vcg::fcd::detail::ToNumber(text.data(), text.data() + text.size(), y);
    return y == 0 ? 0 : y; // no -0
}

Eigen::Vector3d inFewDigits(const Eigen::Vector3d &v) {
    return {inFewDigits(v[0]), inFewDigits(v[1]), inFewDigits(v[2])};
}

MotionStep mirroredStep(const MotionStep &step, const Eigen::Affine3d &mirror) {
    MotionStep other = step;
    switch (step.kind) {
    case MotionStep::Translation: other.vector = mirror.linear() * step.vector; break;
    case MotionStep::Rotation: other.vector = -(mirror.linear() * step.vector); break;
    case MotionStep::Scaling: break;
    case MotionStep::Matrix:
        other.matrix = (mirror * Eigen::Affine3d(step.matrix) * mirror.inverse()).matrix();
        other.matrix.row(3) << 0, 0, 0, 1;
        break;
    }
    if (step.about)
        other.about = mirror * *step.about;
    return other;
}

std::vector<MotionStep> rigidSteps(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to,
                                   const Eigen::Vector3d &middle, double least) {
    if ((to - from).colwise().norm().maxCoeff() < least)
        return {};
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.translation() = to.rowwise().mean();
    const Eigen::Vector3d extent = // along the principal axes, squared, ascending
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(from * from.transpose()).eigenvalues();
    if (extent[1] > 1e-12 * extent[2]) // else points on a line leave the turn open
        motion = Eigen::Affine3d(Eigen::umeyama(from, to, false));
    std::vector<MotionStep> steps = stepsOf(
        vcg::fcd::Motion((Eigen::Translation3d(middle) * motion * Eigen::Translation3d(-middle)).matrix()), middle);
    for (MotionStep &step : steps) {
        step.vector = inFewDigits(step.vector);
        step.degrees = inFewDigits(step.degrees);
    }
    return steps;
}
