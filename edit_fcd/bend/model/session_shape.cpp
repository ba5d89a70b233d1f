// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_normals.h>
#include <layer_fcd/marks.h>

#include <vcg/complex/algorithms/update/bounding.h>

// The pose of a layer.

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
