// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"

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
