// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/shape/pose_solver.h"

#include <algorithm>

vcg::fcd::DeformationParam deformationOf(const BendOptions &options) {
    vcg::fcd::DeformationParam param;
    param.smoothness = options.smoothness;
    param.pose = options.pose;
    param.graph.initialPatches = options.initialPatches;
    param.weights = options.weights;
    return asHandedOver(param);
}

bool BendSolver::isPrepared(const std::shared_ptr<const BendTags> &tags, const BendOptions &options) const {
    return preparedFor && preparedFor == tags && preparedPatches == options.initialPatches &&
           preparedWeights == options.weights;
}

void BendSolver::prepare(const std::shared_ptr<const BendTags> &tags, const BendOptions &options,
                         const vcg::fcd::SurfaceView &surface, const Eigen::Affine3d &world,
                         const vcg::fcd::Progress &progress) {
    last.reset();
    preparedFor.reset();
    deformer.prepare(surface, *tags, world, deformationOf(options), progress);
    preparedFor = tags;
    preparedPatches = options.initialPatches;
    preparedWeights = options.weights;
}

void BendSolver::clear() {
    last.reset();
    preparedFor.reset();
    deformer.forget();
    kept.clear();
}

const vcg::fcd::Deformer::Pose &BendSolver::solve(Motions motions, const BendOptions &options, bool full) {
    vcg::fcd::DeformationParam param = deformationOf(options);
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

const vcg::fcd::Deformer::Pose &BendSolver::solveBlend(std::vector<std::map<int, vcg::fcd::Motion>> poses,
                                                       const Eigen::Affine3d &world, const std::vector<double> &weight,
                                                       const BendOptions &options) {
    beginBlends(std::move(poses), world, options);
    const vcg::fcd::Deformer::Pose &pose = last.emplace(solveNextBlend(weight));
    endBlends();
    return pose;
}

void BendSolver::beginBlends(std::vector<std::map<int, vcg::fcd::Motion>> poses, const Eigen::Affine3d &world,
                             const BendOptions &options) {
    blends = std::make_unique<vcg::fcd::SequenceSolver>(*prepared()->deformer, world, std::move(poses),
                                                        deformationOf(options));
}
