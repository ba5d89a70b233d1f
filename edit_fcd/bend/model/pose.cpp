// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_normals.h>
#include <layer_fcd/marks.h>
#include <layer_fcd/rest_shape.h>

#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>

// The pose of a layer while it is bent, and whether the layer has it.

BendSolver::Motions BendSession::motionsNow() const {
    BendSolver::Motions motions;
    for (const auto &[tag, steps] : now.motion)
        if (center.count(tag))
            motions[tag] = vcg::fcd::ToMotion(steps, rest.world() * center.at(tag));
    return motions;
}

bool BendSession::moves() const {
    const BendSolver::Motions motions = motionsNow();
    return options.pose != 0 && std::any_of(motions.begin(), motions.end(), [](const auto &each) {
               return !each.second.matrix.isIdentity(0) || !each.second.turn.isZero(0);
           });
}

double BendSession::prepare(const vcg::fcd::Progress &progress) {
    if (solver.isPrepared(effective, options))
        return 0;
    const vcg::fcd::Stopwatch watch;
    readSurface();
    solver.prepare(effective, options, surface->View(), rest.world(), progress);
    isFresh = true;
    return 1000 * watch.Seconds();
}

/// Vertices alone.
void BendSession::writePose(const vcg::fcd::Deformer::Pose &pose) {
    if (isFresh)
        rest.restoreVertices();
    isFresh = false;
    rest.leave();
    writeMoving(layer.cm, rest.positions().data(), rest.normals().data(), *solver.prepared(), pose);
}

BendSession::Times BendSession::pose(bool full, bool faces) {
    Times times;
    if (!moves()) {
        restore();
        return times;
    }
    isLeft = false;
    times.prepare = prepare();
    vcg::fcd::Stopwatch watch;
    const vcg::fcd::Deformer::Pose &pose = full && !now.weights.empty()
                                               ? solver.solveBlend(motionsOfPoses(), rest.world(), now.weights, options)
                                               : solver.solve(motionsNow(), options, full);
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

void BendSession::restore() {
    isLeft = false;
    rest.restore();
    solver.forgetPose();
}

bool BendSession::isUpToDate() const {
    const CMeshO &mesh = layer.cm;
    Eigen::Matrix4d present;
    mesh.Tr.ToEigenMatrix(present);
    return fits() && present == rest.world().matrix() && hasMarks(layer) == isMarkedHere && rest.isAsKnown();
}
