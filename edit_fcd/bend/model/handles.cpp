// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/steps.h"

#include <algorithm>
#include <utility>

using vcg::fcd::MotionStep;

const BendHandle &handleOf(const BendState &state, int tag) {
    static const BendHandle usual;
    const auto found = state.handles.find(tag);
    return found == state.handles.end() ? usual : found->second;
}

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

const std::vector<MotionStep> &motionOf(const BendState &state, int tag) {
    static const std::vector<MotionStep> none;
    const auto found = state.motion.find(tag);
    return found == state.motion.end() ? none : found->second;
}

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

int rankOf(const BendState &state, int tag) {
    const auto found = state.rank.find(tag);
    return found == state.rank.end() ? 0 : found->second;
}

int rankOfNew(const BendState &state) {
    int rank = 0;
    for (const auto &each : state.motion)
        rank = std::max(rank, rankOf(state, each.first) + 1);
    return rank;
}

bool isGrip(const BendState &state, int tag) {
    const auto point = state.points.find(tag);
    return point != state.points.end() && point->second.isGrip;
}

bool isFree(const BendState &state, std::size_t slot) { return !state.marks || (*state.marks)[slot] == 1; }

std::map<int, std::vector<MotionStep>> &motionByHand(BendState &state) {
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
