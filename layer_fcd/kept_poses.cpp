// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/pose_sequence.h> // before Qt

#include "kept_poses.h"
#include "kept_with_layer.h"

#include <memory>
#include <string>

namespace {

using Table = std::string; // which any build can read

std::string posesName() { return nameOfKept("fcd_poses", {3, sizeof(Table)}); }

} // namespace

void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses) {
    keepWith<Table>(document, layer, posesName(),
                    poses.pose.empty() ? nullptr : std::make_shared<const Table>(vcg::fcd::PoseSequenceText(poses)));
}

std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer) {
    const std::shared_ptr<const Table> table = keptWith<Table>(layer, posesName());
    if (!table)
        return {};
    return vcg::fcd::ReadPoseSequence(*table, "poses of the layer");
}
