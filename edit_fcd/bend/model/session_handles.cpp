// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/kept_tool.h>

#include <algorithm>
#include <cassert>

using vcg::fcd::MotionStep;
using vcg::fcd::PoseSequence;

// Marks and handles.

// A limb turns by itself if its radius is at most so much of that of the turned limb it is on, as a finger on an arm.
const double thinLimb = 0.5;

int BendSession::addPoint(std::size_t slot, double usual) {
    if (const std::size_t carrier = reach.carrierOf(slot, hair()); canBecomePoint(data, carrier))
        slot = carrier;
    return addAt(slot, reach.radiusAt(slot, usual));
}

/// Adds a handle around a vertex, and its twin.
int BendSession::addAt(std::size_t slot, double radius) {
    const auto add = [&, rank = rankOfNew(state())](std::size_t at) {
        assert(canBecomePoint(data, at));
        const int tag = data.influence.unusedTag();
        data.state.points[tag] = {at, radius};
        if (rank > 0)
            data.state.rank[tag] = rank;
        changeTagsOf(tag);
        return tag;
    };
    const int tag = add(slot);
    if (const auto other = twinSlot(slot))
        add(*other);
    return tag;
}

std::shared_ptr<const BendExtent> BendSession::glimpse(std::size_t slot, double usual) {
    if (!reach.begin())
        return nullptr;
    reach.lookAt(slot);
    return glimpseAt(slot, usual);
}

/// The same by what was looked at last.
std::shared_ptr<const BendExtent> BendSession::glimpseAt(std::size_t slot, double usual) {
    BendReach &glance = reach.glance();
    if (const std::size_t carrier = glance.carrierOf(slot, hair()); canBecomePoint(data, carrier))
        slot = carrier;
    return glance.whole({slot}, glance.radiusAt(slot, usual), hair());
}

std::shared_ptr<const BendExtent> BendSession::glimpseOf(int tag) {
    const auto point = state().points.find(tag);
    return !reach.begin() || point == state().points.end()
               ? nullptr
               : reach.glance().whole({point->second.slot}, point->second.radius, hair());
}

std::shared_ptr<const BendExtent> BendSession::glimpseTwin(int tag, const BendExtent &own) {
    if (tag)
        return glimpseOf(mirrored(data, tag));
    const auto slot = twinSlot(own.vertices.front());
    return slot ? reach.glance().whole({*slot}, own.radius, hair()) : nullptr;
}

void BendSession::makeGrip(int tag) {
    const auto point = data.state.points.find(tag);
    if (point == state().points.end() || point->second.isGrip)
        return;
    const int other = mirrored(data, tag);
    point->second.isGrip = true;
    changeTagsOf(tag);
    if (other)
        makeGrip(other);
}

/// The nearest turned handle from a vertex towards the body; 0: none.
int BendSession::turnedLimb(std::size_t slot) const {
    int found = 0;
    std::size_t least = 0;
    for (const auto &[tag, extent] : data.influence.extents) {
        // Around the limb, also what is farther from the handle than its core turns with it.
        const bool isOn = data.state.points.count(tag) > 0 &&
                          (data.state.points.at(tag).slot == slot || tags()[slot] == tag || extent->shareOf(slot) == 1);
        const std::size_t size = extent->beyond.size();
        if (isOn && jointOf(data, tag) && !handleOf(state(), tag).isLocked && (!found || size < least)) {
            found = tag;
            least = size;
        }
    }
    return found;
}

/// The vertex for a new handle of a vertex's limb; none if it is on no limb.
std::optional<std::size_t> BendSession::newLimb(std::size_t slot, double usual, int nearer) {
    BendReach &glance = reach.glance();
    const std::size_t carrier = glance.carrierOf(slot, hair());
    const std::optional<std::size_t> root = glance.rootOfLimb(carrier, usual, hair(), nearer);
    if (root && !canBecomePoint(data, *root))
        return canBecomePoint(data, carrier) ? std::optional(carrier) : std::nullopt;
    return root;
}

/// A vertex is on a limb: the limb's handle, or else the place of a new one. Neither if it is on no limb.
/// \param nearer as in limbAt()
std::pair<int, std::optional<std::size_t>> BendSession::limbOf(std::size_t slot, double usual, int nearer) {
    reach.lookAt(slot);
    const int found = turnedLimb(slot);
    const std::optional<std::size_t> root = newLimb(slot, usual, nearer);
    const auto isBent = [&] { // there, and not at the joint of the handle
        if (root == newLimb(slot, usual, BendReach::wholeLimb))
            return false;
        const auto joint = glimpseAt(*root, usual)->joint, known = jointOf(data, found);
        // Two thicknesses: seen from different places of a limb, one joint seems to lie up to one apart.
        return joint && (rest.world() * *joint - *known).norm() > radiusOf(data, found);
    };
    const auto isOther = [&] { // a limb of its own, or another joint
        const float share = data.influence.extents.at(found)->shareOf(*root);
        if (nearer == BendReach::wholeLimb)
            return share == 0;
        return nearer > 0 || isBent() ? share == 1
                                      : reach.glance().radiusAt(*root, usual) < thinLimb * radiusOf(data, found);
    };
    if (found && !(root && isOther()))
        return {found, {}};
    return {0, root};
}

std::pair<int, std::shared_ptr<const BendExtent>> BendSession::glimpseLimb(int tag, std::optional<std::size_t> slot,
                                                                           double usual) {
    if (const auto point = state().points.find(tag); point != state().points.end())
        slot = point->second.slot;
    if (!reach.begin() || !slot)
        return {0, nullptr};
    const auto [found, root] = limbOf(*slot, usual, 0);
    return {found, found ? glimpseOf(found) : root ? glimpseAt(*root, usual) : nullptr};
}

int BendSession::limbAt(std::size_t slot, double usual, int nearer) {
    const auto [found, root] = limbOf(slot, usual, nearer);
    if (found || !root)
        return found;
    const int tag = addAt(*root, reach.glance().radiusAt(*root, usual)); // as it was seen before
    makeGrip(tag);
    return tag;
}

void BendSession::setRadius(int tag, double radius) {
    radius = std::min(std::max(radius, leastRadius * rest.diagonal()), mostRadius * rest.diagonal());
    const int other = mirrored(data, tag);
    setRadiusOf(data.state, tag, radius);
    if (other)
        setRadiusOf(data.state, other, radius);
    changeTags();
}

void BendSession::setRimAt(std::size_t slot, double radius) {
    const BendTags &marks = *state().marks;
    std::vector<char> isFixed(marks.size());
    for (std::size_t i = 0; i < isFixed.size(); ++i)
        isFixed[i] = marks[i] == 0;
    setRims(data.state, reach.piece(slot, isFixed), radius, marks.size());
    changeTags();
}

void BendSession::removeHandle(int tag) {
    freeHandle(data.state, tag);
    changeTags();
    writeMarks();
}

void BendSession::reset() {
    motionByHand(data.state).clear();
    if (state().poses || state().rank.empty())
        return; // named poses rely on what handles bend
    data.state.rank.clear();
    changeTags();
}

// --- a stroke along a limb tells where it bends, and what turns ---

Eigen::Vector3d BendSession::seenAt(const Eigen::Vector3d &place, std::size_t slot) const {
    const int holder = tags()[slot];
    return holder >= 2 ? Eigen::Vector3d(motionAt(data, holder) * place)
                       : Eigen::Vector3d(place + positionOf(slot) - rest.world() * rest.at(slot));
}

BendSession::Turned BendSession::turnedBy(BendReach &from, const BendStroke &stroke, double usual) const {
    const auto [extent, isLimb] = from.beyond(stroke.from, stroke.to, usual, hair());
    const std::size_t slot = extent ? extent->vertices.front() : 0;
    const bool isNew = extent && canBecomePoint(data, slot);
    const int tag = isNew ? 0 : tags()[slot];
    if (!extent || (!isNew && tag < 2) || handleOf(state(), tag).isLocked)
        return {};
    return {tag, extent, isLimb && extent->bends ? seenAt(rest.world() * *extent->bends, stroke.from) : stroke.through};
}

BendSession::Turned BendSession::glimpseStroke(const BendStroke &stroke, double usual) {
    if (!reach.begin())
        return {};
    reach.lookAt(stroke.from);
    return turnedBy(reach.glance(), stroke, usual);
}

int BendSession::strokeAt(const BendStroke &stroke, double usual) {
    const Turned found = turnedBy(reach, stroke, usual);
    if (!found.extent)
        throw vcg::fcd::Error(
            "There is no free limb beyond this stroke: draw it from a joint towards the end of the limb.");
    const double radius = std::max(found.extent->radius, leastRadius * rest.diagonal());
    const int tag = found.tag ? found.tag : addAt(found.extent->vertices.front(), radius);
    makeGrip(tag);
    setPivot(data, tag, found.pivot);
    return tag;
}

// --- what follows from a changed state, so that the layer keeps its shape ---

/// Computes the tags from marks and points.
void BendSession::updateTags() {
    data.influence = influenceOf(data.state, data.ground, data.influence.tags);
    forgetGone(data);
}

/// The same after a change that keeps the motions, though handles may hold other vertices.
void BendSession::changeTags() {
    const Centers before = data.influence.center;
    updateTags();
    keepPlaces(data, before, data.state.motion);
    if (!state().poses)
        return;
    PoseSequence poses = *state().poses;
    bool isPlaced = false;
    for (vcg::fcd::NamedPose &each : poses.pose) {
        auto motion = vcg::fcd::ReadMotionText(inNumbers(each.motions));
        if (keepPlaces(data, before, motion)) {
            each.motions = vcg::fcd::WriteMotionText(motion);
            isPlaced = true;
        }
    }
    if (isPlaced)
        setPoses(std::move(poses));
}

/// changeTags() for a point that is new, or holds more: it stays where the layer and the named poses have it.
void BendSession::changeTagsOf(int tag) {
    const auto tagsBefore = data.influence.tags;
    const Centers centerBefore = data.influence.center;
    changeTags();
    keepPlace(tag);
    keepPlaceInPoses(tag, tagsBefore, centerBefore);
}

/// Sets a handle's motion to the one that leaves it where it is.
void BendSession::keepPlace(int tag) {
    if (!rest.isPosed() || state().pose != 100)
        return;
    std::vector<MotionStep> steps = stepsSeen(tag);
    if (steps.empty())
        return;
    if (state().points.count(tag) > 0) // its middle changes if it becomes a grip, or another handle lies beyond
        setPlaces(steps, data.rest(tag));
    motionByHand(data.state)[tag] = std::move(steps);
}

/// The rigid motion nearest to how the layer shows a handle, as steps; none if it is at rest.
std::vector<MotionStep> BendSession::stepsSeen(int tag) const {
    std::vector<std::size_t> held;
    for (std::size_t i = 0; i < tags().size(); ++i)
        if (tags()[i] == tag)
            held.push_back(i);
    const Eigen::Vector3d middle = data.rest(tag);
    Eigen::Matrix3Xd before(3, Eigen::Index(held.size())), after = before;
    for (std::size_t i = 0; i < held.size(); ++i) {
        before.col(Eigen::Index(i)) = rest.world() * rest.at(held[i]) - middle;
        after.col(Eigen::Index(i)) = positionOf(held[i]) - middle;
    }
    return rigidSteps(before, after, middle, 1e-6 * rest.diagonal());
}

void BendSession::mark(const std::vector<std::size_t> &vertices, int tag) {
    if (!marking)
        marking = state().marks ? std::make_shared<BendTags>(*state().marks)
                                : std::make_shared<BendTags>(layer.cm.vert.size(), 1);
    for (std::size_t i : vertices)
        (*marking)[i] = tag;
    marked.insert(marked.end(), vertices.begin(), vertices.end());
}

void BendSession::endMarks(double rim) {
    if (!marking)
        return;
    const std::set<int> added = takeMarks(data.state, *marking, marked, rim, data.influence.center);
    marking.reset();
    marked.clear();
    const auto tagsBefore = data.influence.tags;
    const Centers centerBefore = data.influence.center;
    changeTags();
    for (const int tag : added)
        keepPlace(tag);
    if (state().poses && !added.empty()) {
        beginBeside();
        for (const int tag : added)
            keepPlaceInPoses(tag, tagsBefore, centerBefore);
        endBeside();
    }
    writeMarks();
}

void BendSession::clearMarks() {
    data.state.marks.reset();
    data.state.rims.reset();
    data.state.points.clear();
    motionByHand(data.state).clear();
    updateTags();
    writeMarks();
}

/// Writes the marks to the layer.
void BendSession::writeMarks() {
    dropMarks(layer);
    if (state().marks)
        setMarks(document, layer, *state().marks);
    else if (marksNow(layer)) // other tags of the layer must not be seen
        setMarks(document, layer, BendTags(layer.cm.vert.size(), 1));
    isMarkedHere = hasMarks(layer);
}
