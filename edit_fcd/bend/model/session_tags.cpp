// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/marks.h"
#include "edit_fcd/bend/model/session.h"
#include "edit_fcd/bend/model/steps.h"

#include <layer_fcd/marks.h>
#include <layer_fcd/tagging.h>

// What follows from a state that has changed, so that the layer shows what it showed.

using vcg::fcd::MotionStep;
using vcg::fcd::PoseSequence;

/// Makes the tags that marks and points amount to.
void BendSession::updateTags() {
    data.influence = influenceOf(data.state, data.ground, data.influence.tags);
    forgetGone(data);
}

/// The same, where the state has changed, and has not become another one: motions are what they were, though their
/// handles hold other vertices.
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

/// changeTags() for a point that is new, or holds more: it stays where the layer, and the poses that have names, show
/// it.
void BendSession::changeTagsOf(int tag) {
    const auto tagsBefore = data.influence.tags;
    const Centers centerBefore = data.influence.center;
    changeTags();
    keepPlace(tag);
    keepPlaceInPoses(tag, tagsBefore, centerBefore);
}

/// A handle has the motion that leaves it where the layer shows it.
void BendSession::keepPlace(int tag) {
    if (!rest.isPosed() || state().pose != 100)
        return;
    std::vector<MotionStep> steps = stepsSeen(tag);
    if (steps.empty())
        return;
    if (state().points.count(tag) > 0) // whose middle is another one when it becomes a grip, or another lies beyond
        setPlaces(steps, data.rest(tag));
    motionByHand(data.state)[tag] = std::move(steps);
}

/// What a rigid motion can tell of where the layer shows a handle; none where that is at rest.
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

/// Gives the layer the marks.
void BendSession::writeMarks() {
    dropMarks(layer);
    if (state().marks)
        setMarks(document, layer, *state().marks);
    else if (marksNow(layer)) // it has tags elsewhere, which are not to be seen
        setMarks(document, layer, BendTags(layer.cm.vert.size(), 1));
    isMarkedHere = hasMarks(layer);
}
