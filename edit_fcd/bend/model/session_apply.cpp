// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/kept_tool.h>
#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_normals.h>
#include <layer_fcd/tagging.h>

#include <vcg/complex/algorithms/update/bounding.h>

// Applies a bend exactly as the filters would.

HandleParam BendSession::handleParam() const {
    HandleParam param;
    param.source = HandleParam::Attribute;
    param.tagAttribute = QString::fromStdString(appliedTags(document, layer));
    param.transforms = QString::fromStdString(vcg::fcd::WriteMotionText(state().motion));
    return param;
}

/// Gives the layer the tags for filters: marks, and what points hold.
void BendSession::writeAppliedTags() {
    TagTarget target;
    target.attribute = QString::fromStdString(appliedTags(document, layer));
    target.colorize = false;
    writeTags(document, layer, tags(), target);
}

/// A deformer that makes what a filter makes. For a blend of poses, it has the shown shape, to the bit.
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

/// Gives the layer the pose as FCD: Pose in Place makes it. \return the filter calls
std::string BendSession::poseByFilter(const Remark &remark) {
    PoseParam param;
    param.handles = handleParam();
    param.deformation = deformationOf(data.options);
    restore();
    writeAppliedTags();
    std::string calls;
    if (RestShape::exists(layer) && RestShape(layer).shape() != shapeOf(layer.cm)) {
        resetPose(document, layer, {true, ResetPoseParam::LastShape}, {}); // poses begin from the present rest shape
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
            writeAppliedTags();
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

/// Removes all motions.
void BendSession::forgetMotions() {
    motionByHand(data.state).clear();
    if (!state().marks && !state().poses)
        data.state.points.clear();
    updateTags();
}

/// Makes the present shape the rest shape, after an apply.
void BendSession::beginAnew() {
    for (auto &[tag, each] : data.state.handles)
        if (each.pivot)
            each.pivot = motionAt(data, tag) * *each.pivot; // the present place is that at rest now
    keepRest();
    data.state.applies = ++applies;
    forgetMotions();
    if (state().poses)
        setPoses(*state().poses); // they belong to this rest shape from now on
}

/// Restores the rest shape of the state, if its number of applies differs.
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

/// Forgets states of rest shapes that the layer does not keep.
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
    restore();
    writeAppliedTags();
    applying(remark).deform(std::move(param), false, vcg::fcd::Progress());
    forgetMotions();
    return call;
}

// --- the pose of a layer ---

vcg::fcd::DeformationParam deformationOf(const BendOptions &options) {
    vcg::fcd::DeformationParam param;
    param.smoothness = options.smoothness;
    param.falloff = options.falloff;
    param.elastic = options.elastic;
    if (!options.elastic) // elastic has precedence, as the panel shows
        param.rigidity = options.rigidity;
    param.pose = options.pose;
    param.graph.initialPatches = options.initialPatches;
    param.weights = options.weights;
    return asHandedOver(param);
}

double BendSession::prepare(const vcg::fcd::Progress &progress) {
    if (solver.isPrepared(data.influence.tags, deformationOf(data.options)))
        return 0;
    const vcg::fcd::Stopwatch watch;
    readSurface();
    solver.prepare(data.influence.tags, deformationOf(data.options), surface->View(), rest.world(), progress);
    isFresh = true;
    return 1000 * watch.Seconds();
}

/// Writes vertices only.
void BendSession::writePose(const vcg::fcd::Deformer::Pose &pose) {
    contactOfPose = {};
    if (isFresh)
        rest.restoreVertices();
    isFresh = false;
    rest.leave();
    writeMoving(layer.cm, rest.positions().data(), rest.normals().data(), *solver.prepared(), pose);
}

BendSession::Times BendSession::pose(bool full, bool faces) {
    Times times;
    if (!isMoved(data)) {
        restore();
        return times;
    }
    isLeft = false;
    times.prepare = prepare();
    vcg::fcd::Stopwatch watch;
    const vcg::fcd::DeformationParam param = deformationOf(data.options);
    const vcg::fcd::Deformer::Pose &pose =
        full && !state().weights.empty() ? solver.solveBlend(motionsOfPoses(), rest.world(), state().weights, param)
                                         : solver.solve(motionsOf(data), param, full);
    times.solve = 1000 * watch.Seconds();
    watch = {};
    writePose(pose);
    if (faces && !full)
        computeFaceNormals(layer.cm, solver.prepared()->moving);
    if (full) {
        computeFaceNormals(layer.cm, {});
        vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
        rest.know();
    }
    times.write = 1000 * watch.Seconds();
    return times;
}

void BendSession::findContact() {
    const vcg::fcd::DeformationParam param = deformationOf(data.options);
    if (!isMoved(data) || layer.cm.fn == 0 || layer.cm.face.size() > vcg::fcd::contactUnasked ||
        !solver.isPrepared(data.influence.tags, param))
        return;
    readSurface();
    contactOfPose = vcg::fcd::ContactOf(surface->View(), *solver.prepared()->deformer, positionsOf(layer), param);
}

void BendSession::restore() {
    contactOfPose = {};
    isLeft = false;
    rest.restore();
    solver.forgetPose();
}
