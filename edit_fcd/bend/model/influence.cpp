// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/model.h"

#include "edit_fcd/bend/model/handles.h"

#include <vcg_ext/handles/handles.h>

#include <algorithm>
#include <utility>

// The regions that handles hold, and the surface that bends around them if nothing is marked as fixed.

namespace {

const double pointSize = 0.08; // share of a point's radius that it holds: a single vertex would make a spike

std::vector<std::size_t> chosenOf(const std::vector<char> &isIn) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < isIn.size(); ++i)
        if (isIn[i])
            chosen.push_back(i);
    return chosen;
}

/// Makes the tags step by step.
class Maker {
  public:
    Maker(const BendState &now, const BendGround &ground, BendInfluence &all)
        : now(now), ground(ground), reachOfRest(*ground.reach), all(all) {}
    void make(BendTags &made);

  private:
    struct Around {
        std::vector<std::size_t> vertices; ///< that a handle holds
        double radius;                     ///< within which it bends the surface
        bool isGrip;
    };
    void findExtents(const BendTags &made);
    void bendAround(BendTags &made);
    bool bendAround(const std::vector<Around> &handles, int rank, std::vector<char> &isNear);
    std::vector<int> nextFirst() const;
    void holdBeyond(BendTags &made);
    void hold(BendTags &made);
    void holdGrip(BendTags &made, int tag, double radius);
    double usual() const { return usualGap(ground.diagonal); }

    const BendState &now;
    const BendGround &ground;
    BendReach &reachOfRest;
    BendInfluence &all;
};

/// Fixes all that is not around a handle, if nothing is marked as fixed.
void Maker::bendAround(BendTags &made) {
    std::map<int, std::vector<Around>> around; // by rank
    std::map<std::pair<int, double>, std::vector<std::size_t>> ofRim;
    for (std::size_t i = 0; i < made.size(); ++i)
        if (made[i] >= 2)
            ofRim[{made[i], rimAt(now, i, ground.diagonal)}].push_back(i);
    for (auto &[own, vertices] : ofRim)
        around[rankOf(now, own.first)].push_back({std::move(vertices), own.second, false});
    for (const auto &[tag, point] : now.points)
        around[rankOf(now, tag)].push_back({{point.slot}, point.radius, point.isGrip});
    std::vector<char> isNear(made.size(), 0);
    for (const auto &[rank, handles] : around)
        if (bendAround(handles, rank, isNear))
            all.apart.insert(rank);
    for (const std::size_t i : reachOfRest.looseAmong(isNear, usual()))
        isNear[i] = 1;
    for (std::size_t i = 0; i < made.size(); ++i)
        if (made[i] == 1 && !isNear[i])
            made[i] = 0;
}

/// If there are several handles or a grip: finds the extents of handles, and which handle lies beyond which.
void Maker::findExtents(const BendTags &made) {
    std::map<int, std::vector<std::size_t>> handles;
    for (std::size_t i = 0; i < made.size(); ++i)
        if (made[i] >= 2)
            handles[made[i]].push_back(i);
    bool isAnyGrip = false;
    for (const auto &[tag, point] : now.points) {
        handles[tag] = {point.slot};
        isAnyGrip = isAnyGrip || point.isGrip;
    }
    if (handles.size() < 2 && !isAnyGrip)
        return;
    for (const auto &[tag, vertices] : handles) {
        if (!all.isLocal && now.points.count(tag) == 0)
            continue; // if something is fixed, marked handles have no extents
        all.extents[tag] = reachOfRest.whole(vertices, radiusOf(now, tag, ground.diagonal), usual());
    }
    for (const auto &[tag, own] : all.extents) {
        const auto lies = [&whole = own->beyond](const std::vector<std::size_t> &part) {
            return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
        };
        for (const auto &[other, vertices] : handles) {
            if (other == tag)
                continue;
            const auto &extent = valueOr(all.extents, other);
            const bool isNearTip =
                extent && !extent->beyond.empty() && extent->beyond.size() < own->beyond.size() && lies(extent->beyond);
            if (isNearTip || lies(vertices))
                all.beyond[tag].push_back(other);
        }
    }
}

/// Adds the surface that handles of one rank bend. A fixed gap keeps it apart from the surface that lower ranks bend.
/// If a handle is at the edge of the latter, or turns a limb, there is no gap: all bend together. (A gap would cut the
/// strip at the root of a finger, beside its neighbour's.) \return whether they bend less because of the gap
bool Maker::bendAround(const std::vector<Around> &handles, int rank, std::vector<char> &isNear) {
    const double gap = usual();
    const auto isLower = [&](std::size_t i) { return isNear[i] != 0; };
    std::vector<std::size_t> middle;
    for (const Around &each : handles)
        middle.insert(middle.end(), each.vertices.begin(), each.vertices.end());
    const std::vector<std::size_t> &beside = reachOfRest.of(middle, gap);
    const auto inside = std::size_t(std::count_if(beside.begin(), beside.end(), isLower));
    const bool isAnyGrip = std::any_of(handles.begin(), handles.end(), [](const Around &each) { return each.isGrip; });
    const bool isApart = rank > 0 && !isAnyGrip && (inside == 0 || inside == beside.size());
    const std::vector<std::size_t> lower = chosenOf(isNear);
    std::vector<char> own = isApart ? std::vector<char>(isNear.size(), 0) : isNear;
    const auto add = [&](const std::vector<std::size_t> &vertices) {
        for (const std::size_t i : vertices)
            own[i] = 1;
    };
    std::vector<char> isAside(isNear.size(), 0);
    for (const Around &each : handles) {
        const auto extent = reachOfRest.extent(each.vertices, each.radius);
        add(extent->around);
        add(extent->tips);
        for (const std::size_t i : extent->aside)
            isAside[i] = 1;
    }
    if (handles.size() > 1 || (!isApart && rank > 0)) // else extent() has found all tips
        for (const std::size_t i : reachOfRest.tips(own))
            own[i] = own[i] || !isAside[i];
    bool isLess = false;
    if (isApart) {
        for (const std::size_t i : reachOfRest.of(lower, gap)) {
            isLess = isLess || (own[i] && !isNear[i]);
            own[i] = 0;
        }
        const std::vector<char> left = std::exchange(own, std::vector<char>(isNear.size(), 0));
        for (const std::size_t i : middle) // keeps only what the gap leaves connected with a handle
            if (left[i] && !own[i])
                add(reachOfRest.piece(i, left));
    }
    for (std::size_t i = 0; i < isNear.size(); ++i)
        isNear[i] = isNear[i] || own[i];
    return isLess;
}

/// The handles in order: on a limb, the one next to the tip first, since it holds the tip.
std::vector<int> Maker::nextFirst() const {
    std::vector<int> order;
    order.reserve(all.extents.size());
    for (const auto &each : all.extents)
        order.push_back(each.first);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return all.extents.at(a)->beyond.size() < all.extents.at(b)->beyond.size(); });
    return order;
}

/// Parts beyond a handle that do not bend move along: makes a handle hold these if there are other handles beyond it.
void Maker::holdBeyond(BendTags &made) {
    const auto isFixed = [&](std::size_t i) { return made[i] == 0; };
    for (const int tag : nextFirst()) {
        if (all.beyond.count(tag) == 0)
            continue;
        const BendExtent &own = *all.extents.at(tag);
        const auto isAnyFixed = [&](const auto &part) { return std::any_of(part.begin(), part.end(), isFixed); };
        if (!isAnyFixed(own.beyond) && !isAnyFixed(own.around))
            continue;
        std::vector<char> isIn(made.size());
        for (std::size_t i = 0; i < isIn.size(); ++i)
            isIn[i] = made[i] != 0;
        const std::vector<std::size_t> bent = reachOfRest.piece(own.vertices.front(), isIn);
        isIn.assign(isIn.size(), 0);
        for (const auto *part : {&own.around, &own.beyond})
            for (const std::size_t i : *part)
                isIn[i] = 1;
        for (const std::size_t i : bent)
            isIn[i] = 0;
        for (const std::size_t begin : own.beyond)
            if (isIn[begin])
                for (const std::size_t i : reachOfRest.piece(begin, isIn)) {
                    isIn[i] = 0;
                    if (isFixed(i))
                        made[i] = tag;
                }
    }
}

/// Sets the tags of the vertices that points hold.
void Maker::hold(BendTags &made) {
    const auto add = [&](int tag, const std::vector<std::size_t> &vertices) {
        for (const std::size_t i : vertices)
            if (made[i] == 1)
                made[i] = tag;
    };
    for (const auto &[tag, point] : now.points) {
        add(tag, reachOfRest.of({point.slot}, point.radius * pointSize));
        made[point.slot] = tag;
    }
    for (const int tag : nextFirst())
        if (const BendPoint &point = valueOr(now.points, tag); point.isGrip)
            holdGrip(made, tag, point.radius);
}

/// Makes a grip hold all that turns with it: its core, and the part beyond the bending strip. From this part it leaves
/// out what other handles bend, and a gap around other held vertices.
void Maker::holdGrip(BendTags &made, int tag, double radius) {
    const BendExtent &own = *all.extents.at(tag);
    std::vector<char> isIn(made.size(), 0);
    const auto set = [&](const std::vector<std::size_t> &vertices, bool to) {
        for (const std::size_t i : vertices)
            isIn[i] = to;
    };
    set(own.beyond, true);
    for (std::size_t k = 0; k < own.around.size(); ++k) // so the strip that bends is as wide on all sides of a limb
        isIn[own.around[k]] = isIn[own.around[k]] || own.share[k] == 1;
    for (const int other : all.beyond[tag])
        if (const auto &extent = valueOr(all.extents, other)) {
            set(extent->around, false);
            set(extent->beyond, false);
        }
    set(own.core, true);
    const double gap = gapOfRadius * radius;
    std::vector<std::size_t> others;
    for (const std::size_t i : reachOfRest.of(chosenOf(isIn), gap))
        if (made[i] != 1 && made[i] != tag)
            others.push_back(i);
    set(reachOfRest.of(others, gap), false);
    for (std::size_t i = 0; i < made.size(); ++i)
        if (isIn[i] && made[i] == 1)
            made[i] = tag;
}

void Maker::make(BendTags &made) {
    freeGaps(now, reachOfRest, made);
    const bool isHeld = !now.points.empty() || std::any_of(made.begin(), made.end(), [](int tag) { return tag >= 2; });
    all.isLocal = isHeld && std::find(made.begin(), made.end(), 0) == made.end();
    findExtents(made);
    if (all.isLocal) {
        bendAround(made);
        holdBeyond(made);
    }
    hold(made);
}

} // namespace

BendInfluence influenceOf(const BendState &state, const BendGround &ground,
                          const std::shared_ptr<const BendTags> &before) {
    BendInfluence all;
    auto made =
        state.marks ? std::make_shared<BendTags>(*state.marks) : std::make_shared<BendTags>(ground.vertexSlots, 1);
    Maker(state, ground, all).make(*made);
    all.tags = before && *made == *before ? before : made;
    all.center = vcg::fcd::HandleCenters(*all.tags, ground.at);
    return all;
}

std::vector<int> BendInfluence::handles() const {
    std::vector<int> found;
    found.reserve(center.size());
    for (const auto &each : center)
        found.push_back(int(each.first));
    return found;
}

int BendInfluence::unusedTag() const {
    int tag = 2;
    while (isHandle(tag))
        ++tag;
    return tag;
}
