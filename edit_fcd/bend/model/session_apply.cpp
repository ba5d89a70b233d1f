// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/shape/applies.h"

#include <layer_fcd/marks.h>
#include <layer_fcd/tagging.h>

// How a bend becomes what a filter would have made of it.

HandleParam BendSession::handleParam() const {
    HandleParam param;
    param.source = HandleParam::Attribute;
    param.tagAttribute = QString::fromStdString(appliedTags(document, layer));
    param.transforms = QString::fromStdString(vcg::fcd::WriteMotionText(state().motion));
    return param;
}

/// The layer at rest, with the tags that the filters read: marks, and what points bend.
void BendSession::handOver() {
    restore();
    writeAppliedTags();
}

void BendSession::writeAppliedTags() {
    TagTarget target;
    target.attribute = QString::fromStdString(appliedTags(document, layer));
    target.colorize = false;
    writeTags(document, layer, tags(), target);
}

/// What makes of the layer what a filter does; a blend of poses has the bits that it is shown with.
LayerDeformer BendSession::applying(const Remark &remark) {
    LayerDeformer deformer(document, layer, solver.preparedLayers(), remark);
    if (!state().weights.empty())
        deformer.solveBy([poses = motionsOfPoses(), world = rest.world(), weights = state().weights](
                             const vcg::fcd::Deformer &of, const vcg::fcd::DeformationParam &param,
                             const vcg::fcd::Progress &progress) {
            return vcg::fcd::SequenceSolver(of, world, poses, param).Go(weights, progress);
        });
    return deformer;
}

/// The layer gets the pose as FCD: Pose in Place gives it. \return the calls
std::string BendSession::poseByFilter(const Remark &remark) {
    PoseParam param;
    param.handles = handleParam();
    param.deformation = deformationOf(data.options);
    handOver();
    std::string calls;
    if (RestShape::exists(layer) && RestShape(layer).shape() != shapeOf(layer.cm)) {
        resetPose(document, layer, {true, ResetPoseParam::LastShape},
                  {}); // poses begin with the shape that it has here
        calls = "ms.apply_filter('apply_coord_fcd_reset', keep_shape=True); ";
    }
    applying(remark).pose(param, vcg::fcd::Progress());
    return calls + callInPlace();
}

std::string BendSession::leave(const Remark &remark) {
    std::string calls;
    if (!isMoved(data)) {
        restore();
        if (state().poses)
            writeAppliedTags(); // for them
    } else if (!isLeft) {
        calls = poseByFilter(remark);
        rest.leave();
        rest.know();
        isLeft = true;
    }
    keepState();
    solver.clear();
    surface.reset();
    reach.clear();
    return calls;
}

std::string BendSession::applyInPlace(const Remark &remark) {
    restore();
    const Applied what{state(), data.options, rest.known()};
    const std::string calls = poseByFilter(remark);
    applied.resize(applies);
    applied.push_back(what);
    beginAnew();
    forgetWhatIsGone();
    return calls;
}

/// What was moved rests.
void BendSession::forgetMotions() {
    motionByHand(data.state).clear();
    if (!state().marks && !state().poses)
        data.state.points.clear();
    updateTags();
}

/// The present shape is the rest shape of another apply.
void BendSession::beginAnew() {
    for (auto &[tag, each] : data.state.handles)
        if (each.pivot)
            each.pivot = motionAt(data, tag) * *each.pivot; // where it is now is where it rests
    keepRest();
    data.state.applies = ++applies;
    forgetMotions();
    if (state().poses)
        setPoses(*state().poses); // which are of this rest shape from now on
}

/// Makes the rest shape that of the state, whose number of applies is another one.
void BendSession::crossApplies() {
    const BendState to = state();
    if (to.applies < applies) {
        goBackTo(document, layer, applied[to.applies].rest);
        applies = to.applies;
        data.options = applied[applies].options;
        keepRest();
    }
    while (applies < to.applies) {
        data.state = applied[applies].state;
        data.options = applied[applies].options;
        restore();
        updateTags();
        poseByFilter({});
        beginAnew();
    }
    data.state = to;
}

/// Forgets what led to shapes that the layer does not keep.
void BendSession::forgetWhatIsGone() {
    const std::size_t first = firstKept(layer, applies, [&](std::size_t i) { return applied[i].rest; });
    history.forget([&](const BendState &before) { return before.applies < first; });
}

std::string BendSession::applyToNewLayer(bool graphLayers, const Remark &remark) {
    DeformMeshParam param;
    param.handles = handleParam();
    param.deformation = deformationOf(data.options);
    param.graphLayers = graphLayers;
    const std::string call = callToNewLayer(graphLayers);
    handOver();
    applying(remark).deform(std::move(param), false, vcg::fcd::Progress());
    forgetMotions();
    return call;
}
