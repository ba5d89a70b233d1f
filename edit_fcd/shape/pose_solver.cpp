// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/shape/pose_solver.h"

#include <algorithm>

bool PoseSolver::isPrepared(const Tags &tags, const Param &param) const {
    return preparedFor && preparedFor == tags && preparedParam.Numbers() == param.Numbers();
}

void PoseSolver::prepare(const Tags &tags, const Param &param, const vcg::fcd::SurfaceView &surface,
                         const Eigen::Affine3d &world, const vcg::fcd::Progress &progress) {
    last.reset();
    preparedFor.reset();
    deformer.prepare(surface, *tags, world, param, progress);
    preparedFor = tags;
    preparedParam = param;
}

void PoseSolver::clear() {
    last.reset();
    preparedFor.reset();
    deformer.forget();
    kept.clear();
}

const vcg::fcd::Deformer::Pose &PoseSolver::solve(Motions motions, Param param, bool full) {
    deformer.takeMotions(std::move(motions));
    if (full) {
        last = deformer.solve(param);
    } else {
        param.maxIterations = 20;
        param.tolerance = std::max(param.tolerance, 1e-4);
        last = deformer.solveFrom(last ? &*last : nullptr, param);
    }
    return *last;
}

const vcg::fcd::Deformer::Pose &PoseSolver::solveBlend(std::vector<std::map<int, vcg::fcd::Motion>> poses,
                                                       const Eigen::Affine3d &world, const std::vector<double> &weight,
                                                       const Param &param) {
    beginBlends(std::move(poses), world, param);
    const vcg::fcd::Deformer::Pose &pose = last.emplace(solveNextBlend(weight));
    endBlends();
    return pose;
}

void PoseSolver::beginBlends(std::vector<std::map<int, vcg::fcd::Motion>> poses, const Eigen::Affine3d &world,
                             const Param &param) {
    blends = std::make_unique<vcg::fcd::SequenceSolver>(*prepared()->deformer, world, std::move(poses), param);
}
