// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_session.h"

#include <layer_fcd/layer_normals.h>

#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>
#include <atomic>
#include <numeric>

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

double BendSession::prepare() {
    if (solver.isPrepared(effective, options))
        return 0;
    const vcg::fcd::Stopwatch watch;
    rest.restoreVertices();
    solver.prepare(effective, options);
    return 1000 * watch.Seconds();
}

BendSession::Times BendSession::pose(bool full) {
    Times times;
    if (!moves()) {
        restoreShape();
        updateStretch();
        return times;
    }
    times.prepare = prepare();
    vcg::fcd::Stopwatch watch;
    const vcg::fcd::Deformer::Pose &pose = solver.solve(motionsNow(), options, full);
    times.solve = 1000 * watch.Seconds();
    watch = {};
    rest.leave();
    writeMoving(layer.cm, rest.positions().data(), rest.normals().data(), *solver.prepared(), pose);
    if (full) {
        computeFaceNormals(layer.cm, {});
        vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
        rest.know(shapeOf(layer.cm));
    }
    updateStretch();
    times.write = 1000 * watch.Seconds();
    return times;
}

void BendSession::restore() {
    hideStretch();
    restoreShape();
}

void BendSession::restoreShape() {
    rest.restore();
    solver.forgetPose();
}

void BendSession::updateStretch() {
    if (!options.stretch || marking || layer.cm.fn == 0) {
        hideStretch();
        return;
    }
    if (!stretch)
        stretch = std::make_unique<StretchColors>(layer);
    stretch->show(rest.positions(), rest.world().linear());
}

void BendSession::hideStretch() {
    if (stretch)
        stretch->bringBack();
    stretch.reset();
}

bool BendSession::isUpToDate() const {
    const CMeshO &mesh = layer.cm;
    Eigen::Matrix4d present;
    mesh.Tr.ToEigenMatrix(present);
    if (!fits() || present != rest.world().matrix())
        return false;
    const bool hasTags = now.marks && target.attribute.isEmpty();
    if (hasTags && !layer.hasDataMask(MeshModel::MM_VERTQUALITY))
        return false;
    const std::size_t grain = 1 << 14; // each vertex is read once
    std::atomic<bool> isSame{true};
    std::vector<std::uint64_t> sums((mesh.vert.size() + grain - 1) / grain, 0);
    vcg::fcd::ParallelFor(0, mesh.vert.size(), grain, [&](std::size_t first, std::size_t last) {
        std::uint64_t sum = 0;
        for (std::size_t i = first; i < last; ++i)
            if (const CVertexO &vertex = mesh.vert[i]; !vertex.IsD()) {
                sum += shapeTerm(i, vertex.cP());
                if (hasTags && double(vertex.cQ()) != double((*effective)[i]))
                    isSame = false;
            }
        sums[first / grain] = sum;
    });
    return isSame && std::accumulate(sums.begin(), sums.end(), std::uint64_t(0)) == rest.known();
}
