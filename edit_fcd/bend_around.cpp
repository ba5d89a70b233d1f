// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_session.h"

#include <algorithm>
#include <utility>

// What handles hold, and what bends around them where nothing is marked as fixed.

namespace {

const double pointSize = 0.08; // of a point's radius: so far it is held, that a single vertex makes no spike
const double gripSize = 0.5;   // the same where it is turned: the other half is left to bend

std::vector<std::size_t> chosenOf(const std::vector<char> &isIn) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < isIn.size(); ++i)
        if (isIn[i])
            chosen.push_back(i);
    return chosen;
}

} // namespace

int BendSession::rankOf(int tag) const {
    const auto found = now.rank.find(tag);
    return found == now.rank.end() ? 0 : found->second;
}

/// What a new handle frees must not let go what is posed.
int BendSession::rankOfNew() const {
    int rank = 0;
    for (const auto &each : now.motion)
        rank = std::max(rank, rankOf(each.first) + 1);
    return rank;
}

/// Where nothing is marked as fixed, what is not around a handle is.
void BendSession::bendAround(BendTags &made) {
    std::map<int, std::vector<Around>> around; // by rank
    std::map<std::pair<int, double>, std::vector<std::size_t>> ofRim;
    for (std::size_t i = 0; i < made.size(); ++i)
        if (made[i] >= 2)
            ofRim[{made[i], rimAt(i)}].push_back(i);
    for (auto &[own, vertices] : ofRim)
        around[rankOf(own.first)].push_back({std::move(vertices), own.second});
    for (const auto &[tag, point] : now.points)
        around[rankOf(tag)].push_back({{point.slot}, point.radius});
    std::vector<char> isNear(made.size(), 0);
    for (const auto &[rank, handles] : around)
        if (bendAround(handles, rank, isNear))
            apart.insert(rank);
    for (const std::size_t i : reachOfRest.looseAmong(isNear, usualGap()))
        isNear[i] = 1;
    for (std::size_t i = 0; i < made.size(); ++i)
        if (made[i] == 1 && !isNear[i])
            made[i] = 0;
}

/// What handles of one rank bend is added to what those below do, from which a gap that stays keeps it apart. But
/// where a handle is at the edge of that, all bend together. \return whether they bend less for it
bool BendSession::bendAround(const std::vector<Around> &handles, int rank, std::vector<char> &isNear) {
    const double gap = usualGap();
    const auto isLower = [&](std::size_t i) { return isNear[i] != 0; };
    std::vector<std::size_t> middle;
    for (const Around &each : handles)
        middle.insert(middle.end(), each.vertices.begin(), each.vertices.end());
    const std::vector<std::size_t> &beside = reach(middle, gap);
    const auto inside = std::size_t(std::count_if(beside.begin(), beside.end(), isLower));
    const bool isApart = rank > 0 && (inside == 0 || inside == beside.size());
    const std::vector<std::size_t> lower = chosenOf(isNear);
    std::vector<char> own = isApart ? std::vector<char>(isNear.size(), 0) : isNear;
    const auto add = [&](const std::vector<std::size_t> &vertices) {
        for (const std::size_t i : vertices)
            own[i] = 1;
    };
    for (const Around &each : handles) {
        std::vector<char> isIn(isNear.size(), 0);
        for (const std::size_t i : reach(each.vertices, each.radius))
            own[i] = isIn[i] = 1;
        add(reachOfRest.tips(isIn));
    }
    if (handles.size() > 1 || (!isApart && rank > 0)) // else that has been done
        add(reachOfRest.tips(own));
    bool isLess = false;
    if (isApart) {
        for (const std::size_t i : reach(lower, gap)) {
            isLess = isLess || own[i];
            own[i] = 0;
        }
        const std::vector<char> left = std::exchange(own, std::vector<char>(isNear.size(), 0));
        for (const std::size_t i : middle) // what is cut off from it by that stays, too
            if (left[i] && !own[i])
                add(reachOfRest.piece(i, left));
    }
    for (std::size_t i = 0; i < isNear.size(); ++i)
        isNear[i] = isNear[i] || own[i];
    return isLess;
}

/// Holds what a point holds: that which it is turned with only where nothing else is held within the gap.
void BendSession::hold(BendTags &made, int tag, const BendPoint &point) {
    std::vector<std::size_t> all = reach({point.slot}, point.radius * pointSize);
    if (point.isGrip) {
        std::vector<char> isIn(made.size(), 0);
        const auto add = [&](const std::vector<std::size_t> &vertices) {
            for (const std::size_t i : vertices)
                isIn[i] = 1;
        };
        add(reach({point.slot}, point.radius));
        const std::vector<std::size_t> tips = reachOfRest.tips(isIn);
        isIn.assign(made.size(), 0);
        add(reach({point.slot}, point.radius * gripSize));
        add(reachOfRest.tips(isIn));
        add(tips);
        const double gap = gapOfRadius * point.radius;
        std::vector<std::size_t> others;
        for (const std::size_t i : reach(chosenOf(isIn), gap))
            if (made[i] != 1)
                others.push_back(i);
        for (const std::size_t i : reach(others, gap))
            isIn[i] = 0;
        const std::vector<std::size_t> more = chosenOf(isIn);
        all.insert(all.end(), more.begin(), more.end());
    }
    for (const std::size_t i : all)
        if (made[i] == 1)
            made[i] = tag;
    made[point.slot] = tag;
}
