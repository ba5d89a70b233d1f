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
