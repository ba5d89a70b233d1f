// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_vector.h> // these before Qt
#include <vcg_ext/base/words.h>

#include "edit_fcd/bend/model/handles.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <charconv>
#include <utility>

using vcg::fcd::MotionStep;

const BendHandle &handleOf(const BendState &state, int tag) { return valueOr(state.handles, tag); }

void setHandle(BendState &state, int tag, BendHandle handle) {
    if (handle == BendHandle())
        state.handles.erase(tag);
    else
        state.handles[tag] = std::move(handle);
}

std::string nameOf(const BendState &state, int tag) {
    const std::string &name = handleOf(state, tag).name;
    return name.empty() ? "Handle " + std::to_string(tag) : name;
}

const std::vector<MotionStep> &motionOf(const BendState &state, int tag) { return valueOr(state.motion, tag); }

std::string motionTextOf(const BendState &state, int tag) {
    if (motionOf(state, tag).empty())
        return {};
    const std::string text = vcg::fcd::WriteMotionText({{tag, motionOf(state, tag)}});
    return text.substr(text.find(':') + 2);
}

std::string shortMotionOf(const BendState &state, int tag) {
    std::string words;
    const std::vector<MotionStep> &steps = motionOf(state, tag);
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        const auto digits = [](double x) { return inDigits(x, 3); };
        if (!words.empty())
            words += ", ";
        switch (step->kind) {
        case MotionStep::Translation: words += "move " + digits(step->vector.norm()); break;
        case MotionStep::Rotation: {
            Eigen::Index largest = 0;
            step->vector.cwiseAbs().maxCoeff(&largest);
            words += "turn " + digits(step->vector[largest] < 0 ? -step->degrees : step->degrees) + "\xc2\xb0"; // UTF-8
            break;
        }
        case MotionStep::Scaling: words += "scale " + digits(step->vector.maxCoeff()); break;
        case MotionStep::Matrix: words += "matrix"; break;
        }
    }
    return words;
}

int rankOf(const BendState &state, int tag) { return valueOr(state.rank, tag); }

int rankOfNew(const BendState &state) {
    int rank = 0;
    for (const auto &each : state.motion)
        rank = std::max(rank, rankOf(state, each.first) + 1);
    return rank;
}

bool isGrip(const BendState &state, int tag) { return valueOr(state.points, tag).isGrip; }

bool isFree(const BendState &state, std::size_t slot) { return !state.marks || (*state.marks)[slot] == 1; }

BendMotions &motionByHand(BendState &state) {
    state.weights.clear();
    return state.motion;
}

double rimAt(const BendState &state, std::size_t slot, double diagonal) {
    const double own = state.rims ? double((*state.rims)[slot]) : 0;
    return own > 0 ? own : usualRadius * diagonal;
}

double radiusOf(const BendState &state, int tag, double diagonal) {
    const auto point = state.points.find(tag);
    if (point != state.points.end())
        return point->second.radius;
    for (std::size_t i = 0; state.marks && i < state.marks->size(); ++i)
        if ((*state.marks)[i] == tag)
            return rimAt(state, i, diagonal);
    return usualRadius * diagonal;
}

void setRims(BendState &state, const std::vector<std::size_t> &vertices, double radius, std::size_t vertexSlots) {
    auto rims = state.rims ? std::make_shared<BendRims>(*state.rims) : std::make_shared<BendRims>(vertexSlots, 0.f);
    for (const std::size_t i : vertices)
        (*rims)[i] = float(radius);
    state.rims = std::move(rims);
}

void setRadiusOf(BendState &state, int tag, double radius) {
    state.rank.erase(tag);
    if (const auto point = state.points.find(tag); point != state.points.end()) {
        point->second.radius = radius;
        return;
    }
    std::vector<std::size_t> vertices;
    for (std::size_t i = 0; state.marks && i < state.marks->size(); ++i)
        if ((*state.marks)[i] == tag)
            vertices.push_back(i);
    if (!vertices.empty())
        setRims(state, vertices, radius, state.marks->size());
}

void freeGaps(const BendState &state, BendReach &reach, BendTags &made) {
    if (!state.marks || !state.rims)
        return;
    using Mark = std::pair<int, double>; // tag and gap
    std::map<Mark, std::vector<std::size_t>> held;
    std::map<int, std::size_t> left;
    const auto isHeld = [&](std::size_t i) { return made[i] == 0 || made[i] >= 2; };
    const auto gapOf = [&](std::size_t i) { return gapOfRadius * double((*state.rims)[i]); };
    for (std::size_t i = 0; i < made.size(); ++i)
        if (isHeld(i)) {
            held[{made[i], gapOf(i)}].push_back(i);
            ++left[made[i]];
        }
    for (const auto &[own, vertices] : held) {
        const auto &[tag, gap] = own;
        std::set<double> gaps; // to marks that yield
        for (const auto &each : held)
            if (each.first.first < tag)
                gaps.insert(std::max(gap, each.first.second));
        gaps.erase(0);
        for (const double larger : gaps) {
            std::map<int, std::vector<std::size_t>> beside; // vertices that yield, by tag
            for (const std::size_t i : reach.of(vertices, larger))
                if (isHeld(i) && made[i] < tag && std::max(gap, gapOf(i)) == larger)
                    beside[made[i]].push_back(i);
            for (const auto &[other, near] : beside) {
                if (near.size() == left[other])
                    continue; // nothing of it would be left
                left[other] -= near.size();
                for (const std::size_t i : near)
                    made[i] = 1;
            }
        }
    }
}

/// Null if nothing is marked.
static std::shared_ptr<const BendTags> marksOf(BendTags marks) {
    const bool isAny = std::any_of(marks.begin(), marks.end(), [](int tag) { return tag != 1; });
    return isAny ? std::make_shared<const BendTags>(std::move(marks)) : nullptr;
}

std::set<int> takeMarks(BendState &state, const BendTags &marks, const std::vector<std::size_t> &marked, double rim,
                        const std::map<vcg::fcd::Index, Eigen::Vector3d> &known) {
    setRims(state, marked, rim, marks.size());
    state.marks = marksOf(marks);
    std::set<int> added;
    const int rank = rankOfNew(state);
    for (std::size_t i = 0; state.marks && i < marks.size(); ++i)
        if (marks[i] >= 2 && !known.count(marks[i]) && added.insert(marks[i]).second && rank > 0)
            state.rank[marks[i]] = rank;
    for (auto point = state.points.begin(); point != state.points.end();)
        point = isFree(state, point->second.slot) ? std::next(point) : state.points.erase(point);
    return added;
}

void freeHandle(BendState &state, int tag) {
    state.points.erase(tag);
    if (!state.marks || std::count(state.marks->begin(), state.marks->end(), tag) == 0)
        return;
    BendTags marks = *state.marks;
    std::replace(marks.begin(), marks.end(), tag, 1);
    state.marks = marksOf(std::move(marks));
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
