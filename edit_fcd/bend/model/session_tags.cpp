// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/marks.h"
#include "edit_fcd/bend/model/session.h"
#include "edit_fcd/bend/model/steps.h"

#include <layer_fcd/marks.h>
#include <layer_fcd/tagging.h>

// Updates what follows from a changed state, so that the layer keeps its shape.

using vcg::fcd::MotionStep;
using vcg::fcd::PoseSequence;

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
