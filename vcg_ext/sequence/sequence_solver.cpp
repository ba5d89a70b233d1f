// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/sequence_solver.h>

#include <cassert>
#include <utility>

namespace vcg::fcd {

SequenceSolver::SequenceSolver(const Deformer &deformer, const Eigen::Affine3d &world,
                               std::vector<std::map<int, Motion>> pose, const DeformationParam &param)
    : deformer(deformer), pose(std::move(pose)), param(param), world(world) {
    if (!deformer.point.empty())
        throw BadInput(
            "A pose sequence moves only handles, but this surface is prepared with points. Prepare it without them.");
    Handles handles;
    handles.world = world;
    for (const std::map<int, Motion> &each : this->pose) {
        handles.motion = each;
        for (const auto &[tag, rotates] : deformer.MotionsOf(handles, 100).rotates)
            turns[tag] = turns[tag] || rotates;
    }
}

HeldMotions SequenceSolver::MotionsOf(const std::vector<double> &weight) const {
    assert(weight.size() == pose.size());
    Handles blended;
    blended.world = world;
    for (const auto &[tag, middle] : deformer.center) {
        std::vector<std::pair<Motion, double>> motions;
        for (std::size_t i = 0; i < pose.size(); ++i)
            if (const auto found = pose[i].find(tag); found != pose[i].end())
                motions.emplace_back(found->second, weight[i]);
        blended.motion[tag] = Blend(motions, world * middle);
    }
    HeldMotions held = deformer.MotionsOf(blended, 100);
    // Handles that no pose turns follow the surface's turn. Others keep their own turn, also while it is 0, so that
    // nothing jumps when it begins.
    held.rotates = turns;
    return held;
}

const Deformer::Pose &SequenceSolver::Go(const std::vector<double> &weight, const Progress &progress) {
    HeldMotions end = MotionsOf(weight);
    if (!end.Moves())
        last.reset();
    if (!last)
        lastWeight.assign(weight.size(), 0);
    const auto motionsAt = [&](int step, int steps) {
        if (step == steps)
            return end;
        std::vector<double> between = weight;
        for (std::size_t i = 0; i < between.size(); ++i)
            between[i] = lastWeight[i] + (weight[i] - lastWeight[i]) * step / steps;
        return MotionsOf(between);
    };
    last = deformer.SolveAlong(motionsAt, param, last ? &*last : nullptr, progress);
    lastWeight = weight;
    return *last;
}

} // namespace vcg::fcd
