// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/pose_sequence.h> // before Qt

#include "kept_poses.h"

#include <memory>
#include <string>

namespace {

// A host does not free what a mesh's attributes hold when the mesh goes: the document does that, as in
// kept_deformation.
using KeptPoses = std::weak_ptr<std::string>; // a table, which any build can read; empty: none

/// It is no plain data, so only a library that was built in the same way may find it: by this name.
std::string posesName() {
    std::string name = "fcd_poses_2_" + std::to_string(sizeof(KeptPoses)) + "_" + std::to_string(sizeof(std::string));
#ifdef _LIBCPP_VERSION
    name += "_libc++";
#endif
    return name;
}

} // namespace

void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses) {
    const std::string table = poses.pose.empty() ? std::string() : vcg::fcd::PoseSequenceText(poses);
    const KeptPoses *kept = host::meshAttribute<KeptPoses>(layer.cm, posesName());
    if (const std::shared_ptr<std::string> held = kept ? kept->lock() : nullptr) {
        *held = table;
        return;
    }
    if (table.empty())
        return;
    // Not by make_shared, whose memory goes with the last weak pointer.
    auto held = std::make_shared<std::shared_ptr<std::string>>(new std::string(table));
    host::madeMeshAttribute<KeptPoses>(layer.cm, posesName()) = *held;
    // What is connected holds it, and goes with the document.
    QObject::connect(&document, &MeshDocument::meshRemoved, [held, number = layer.id()](int gone) {
        if (gone == number)
            held->reset();
    });
}

std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer) {
    const KeptPoses *kept = host::meshAttribute<KeptPoses>(layer.cm, posesName());
    const std::shared_ptr<const std::string> table = kept ? kept->lock() : nullptr;
    if (!table || table->empty())
        return {};
    return vcg::fcd::ReadPoseSequence(*table, "poses of the layer");
}
