// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/ghosts.h"

#include <vcg_ext/map/carrier.h>
#include <vcg_ext/sequence/sequence_solver.h>

GhostFrames ghostFrames(const std::vector<vcg::fcd::KeyFrame> &keys, double time, bool isShown) {
    GhostFrames ghosts;
    if (keys.size() < 2)
        return ghosts;
    for (const vcg::fcd::KeyFrame &each : keys) {
        if (each.time < time || (each.time == time && !isShown))
            ghosts.before = each.weight;
        if (each.time > time) {
            ghosts.after = each.weight;
            break;
        }
    }
    return ghosts;
}

std::vector<float> BlendShapes::of(const std::vector<double> &weight, const std::vector<std::uint32_t> &slot,
                                   const vcg::fcd::Progress &progress) {
    if (!deformer) {
        vcg::fcd::Handles handles;
        handles.tag = *tags;
        handles.world = world;
        vcg::fcd::CountHandles(handles, surface->Slots(), surface->View().deleted);
        deformer = vcg::fcd::PrepareDeformer(surface->View(), handles, param, progress);
    }
    vcg::fcd::SequenceSolver solver(*deformer, world, poses, param);
    Eigen::Matrix3Xd position = surface->View().Copy();
    vcg::fcd::Carrier(*deformer, solver.Go(weight, progress)).Apply(position, nullptr, progress);
    std::vector<float> shape;
    shape.reserve(3 * slot.size());
    for (const std::uint32_t i : slot)
        for (int d = 0; d < 3; ++d)
            shape.push_back(float(position(d, i)));
    return shape;
}
