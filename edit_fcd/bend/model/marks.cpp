// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/marks.h>
#include <layer_fcd/tag_sources.h>
#include <layer_fcd/tagging.h>

#include <algorithm>
#include <set>

// What is marked on a layer, and the tags that this amounts to.

using vcg::fcd::Error;
using vcg::fcd::MotionStep;
using vcg::fcd::ParallelFor;
using vcg::fcd::PoseSequence;

namespace {

const unsigned char opacity = 150;     // of marks, and of stretch, of 255: the surface is still seen
const unsigned char alongOpacity = 60; // of what only goes along, and can be pulled by itself

} // namespace

/// The tags of a layer, null where nothing is tagged. A quality that is no tags counts as nothing.
std::shared_ptr<const BendTags> BendSession::marksNow(const MeshModel &layer) {
    HandleParam param;
    param.source = HandleParam::Known;
    auto present = std::make_shared<const BendTags>(readTags(layer, param));
    return std::all_of(present->begin(), present->end(), [](int tag) { return tag == 1; }) ? nullptr : present;
}

bool BendSession::isAsLeft() const {
    if (!isUpToDate())
        return false;
    const auto marks = marksNow(layer);
    return marks && now.marks ? *marks == *now.marks : !marks && !now.marks;
}

/// Makes the tags that marks and points amount to.
void BendSession::updateTags() {
    auto made =
        now.marks ? std::make_shared<BendTags>(*now.marks) : std::make_shared<BendTags>(rest.positions().size(), 1);
    freeGaps(*made);
    const bool isHeld =
        !now.points.empty() || std::any_of(made->begin(), made->end(), [](int tag) { return tag >= 2; });
    local = isHeld && std::find(made->begin(), made->end(), 0) == made->end();
    apart.clear();
    findExtents(*made);
    if (local) {
        bendAround(*made);
        holdBeyond(*made);
    }
    hold(*made);
    if (!effective || *made != *effective)
        effective = made;
    center = vcg::fcd::HandleCenters(*effective, [&](std::size_t i) { return rest.at(i); });
    const auto forget = [&](auto &of) {
        for (auto each = of.begin(); each != of.end();)
            each = center.count(each->first) ? std::next(each) : of.erase(each);
    };
    if (std::any_of(now.motion.begin(), now.motion.end(), [&](const auto &each) { return !center.count(each.first); }))
        forget(motionByHand());
    forget(now.handles);
    forget(now.rank);
}

/// The same, where the state has changed, and has not become another one: motions are what they were, though their
/// handles hold other vertices.
void BendSession::changeTags() {
    const auto before = center;
    updateTags();
    const auto place = [&](std::map<int, std::vector<MotionStep>> &motion) {
        bool isPlaced = false;
        for (auto &[tag, steps] : motion)
            if (const auto was = before.find(tag);
                was != before.end() && center.count(tag) && was->second != center.at(tag))
                isPlaced = setPlaces(steps, rest.world() * was->second) || isPlaced;
        return isPlaced;
    };
    place(now.motion);
    if (!now.poses)
        return;
    PoseSequence poses = *now.poses;
    bool isPlaced = false;
    for (vcg::fcd::NamedPose &each : poses.pose) {
        auto motion = vcg::fcd::ReadMotionText(inNumbers(each.motions));
        if (place(motion)) {
            each.motions = vcg::fcd::WriteMotionText(motion);
            isPlaced = true;
        }
    }
    if (isPlaced)
        setPoses(std::move(poses));
}

double BendSession::rimAt(std::size_t slot) const {
    const double own = now.rims ? double((*now.rims)[slot]) : 0;
    return own > 0 ? own : usualRadius * rest.diagonal();
}

void BendSession::setRims(const std::vector<std::size_t> &vertices, double radius) {
    auto rims = now.rims ? std::make_shared<BendRims>(*now.rims) : std::make_shared<BendRims>(effective->size(), 0.f);
    for (const std::size_t i : vertices)
        (*rims)[i] = float(radius);
    now.rims = std::move(rims);
}

double BendSession::radiusOf(int tag) const {
    const auto point = now.points.find(tag);
    if (point != now.points.end())
        return point->second.radius;
    for (std::size_t i = 0; now.marks && i < now.marks->size(); ++i)
        if ((*now.marks)[i] == tag)
            return rimAt(i);
    return usualRadius * rest.diagonal();
}

void BendSession::setRadius(int tag, double radius) {
    const auto set = [&](int which) {
        now.rank.erase(which); // it was asked how far it bends
        const auto point = now.points.find(which);
        if (point != now.points.end()) {
            point->second.radius = radius;
            return;
        }
        std::vector<std::size_t> vertices;
        for (std::size_t i = 0; now.marks && i < now.marks->size(); ++i)
            if ((*now.marks)[i] == which)
                vertices.push_back(i);
        if (!vertices.empty())
            setRims(vertices, radius);
    };
    set(tag);
    if (const int other = mirrored(tag))
        set(other);
    changeTags();
}

void BendSession::setRimAt(std::size_t slot, double radius) {
    expectReach();
    std::vector<char> isFixed(now.marks->size());
    for (std::size_t i = 0; i < isFixed.size(); ++i)
        isFixed[i] = (*now.marks)[i] == 0;
    setRims(reachOfRest.piece(slot, isFixed), radius);
    changeTags();
}

/// Marks never touch: within the gap of a mark nothing else is held. What is fixed yields to handles, and an older
/// handle to a newer one, as far as the larger gap of the two.
void BendSession::freeGaps(BendTags &made) {
    if (!now.marks || !now.rims)
        return;
    using Mark = std::pair<int, double>; // tag and gap
    std::map<Mark, std::vector<std::size_t>> held;
    std::map<int, std::size_t> left;
    const auto isHeld = [&](std::size_t i) { return made[i] == 0 || made[i] >= 2; };
    const auto gapOf = [&](std::size_t i) { return gapOfRadius * double((*now.rims)[i]); };
    for (std::size_t i = 0; i < made.size(); ++i)
        if (isHeld(i)) {
            held[{made[i], gapOf(i)}].push_back(i);
            ++left[made[i]];
        }
    for (const auto &[own, vertices] : held) {
        const auto &[tag, gap] = own;
        std::set<double> gaps; // to those that yield
        for (const auto &each : held)
            if (each.first.first < tag)
                gaps.insert(std::max(gap, each.first.second));
        gaps.erase(0);
        for (const double larger : gaps) {
            std::map<int, std::vector<std::size_t>> beside; // by their tag
            for (const std::size_t i : reach(vertices, larger))
                if (isHeld(i) && made[i] < tag && std::max(gap, gapOf(i)) == larger)
                    beside[made[i]].push_back(i);
            for (const auto &[other, near] : beside) {
                if (near.size() == left[other])
                    continue; // it would be gone
                left[other] -= near.size();
                for (const std::size_t i : near)
                    made[i] = 1;
            }
        }
    }
}

/// Gives the layer the marks.
void BendSession::writeMarks() {
    dropMarks(layer);
    if (now.marks)
        setMarks(document, layer, *now.marks);
    else if (marksNow(layer)) // it has tags elsewhere, which are not to be seen
        setMarks(document, layer, BendTags(layer.cm.vert.size(), 1));
    isMarkedHere = hasMarks(layer);
}

std::vector<vcg::Color4b> BendSession::overlay() {
    if (isStretchShown()) {
        if (!stretch)
            stretch = std::make_unique<StretchColors>(layer);
        return stretch->of(rest.positions(), rest.world().linear(), opacity);
    }
    std::vector<vcg::Color4b> color;
    std::set<int> grips;
    for (const auto &[tag, point] : now.points)
        if (point.isGrip)
            grips.insert(tag);
    if (!marking && !now.marks && grips.empty())
        return color;
    const BendTags &held = marking ? *marking : *effective;
    const BendTags *marks = marking ? marking.get() : now.marks.get();
    const auto isShown = [&](std::size_t i) {
        return held[i] != 1 && ((marks && (*marks)[i] != 1) || grips.count(held[i]) > 0);
    };
    std::vector<int> hidden;
    for (const auto &[tag, each] : now.handles)
        if (each.isHidden)
            hidden.push_back(tag);
    const auto isHidden = [&](int tag) { return std::find(hidden.begin(), hidden.end(), tag) != hidden.end(); };
    color.assign(held.size(), vcg::Color4b(0, 0, 0, 0));
    ParallelFor(0, held.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (isShown(i) && !isHidden(held[i])) {
                color[i] = colorOfTag(held[i]);
                color[i][3] = !marking && isAlong(i) ? alongOpacity : opacity;
            }
    });
    return color;
}

bool BendSession::isStretchShown() const { return options.stretch && !marking && layer.cm.fn > 0; }

void BendSession::mark(const std::vector<std::size_t> &vertices, int tag) {
    if (!marking) {
        marking = std::make_shared<BendTags>(layer.cm.vert.size(), 1);
        if (now.marks)
            *marking = *now.marks;
    }
    for (std::size_t i : vertices)
        (*marking)[i] = tag;
    marked.insert(marked.end(), vertices.begin(), vertices.end());
}

void BendSession::endMarks(double rim) {
    if (!marking)
        return;
    const bool isAny = std::any_of(marking->begin(), marking->end(), [](int tag) { return tag != 1; });
    now.marks = isAny ? std::move(marking) : nullptr;
    marking.reset();
    setRims(marked, rim);
    marked.clear();
    std::set<int> added;
    const int rank = rankOfNew();
    for (std::size_t i = 0; now.marks && i < now.marks->size(); ++i)
        if ((*now.marks)[i] >= 2 && !center.count((*now.marks)[i]) && added.insert((*now.marks)[i]).second && rank > 0)
            now.rank[(*now.marks)[i]] = rank;
    for (auto point = now.points.begin(); point != now.points.end();) // marks take their places
        point = isFree(point->second.slot) ? std::next(point) : now.points.erase(point);
    changeTags();
    for (const int tag : added)
        keepPlace(tag);
    writeMarks();
}

void BendSession::clearMarks() {
    now.marks.reset();
    now.rims.reset();
    now.points.clear();
    motionByHand().clear();
    updateTags();
    writeMarks();
}
