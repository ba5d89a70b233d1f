// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/pose_sequence.h> // before Qt

#include "kept_poses.h"

#include <memory>
#include <string>

namespace {

// A host does not free what a mesh's attributes hold when the mesh goes: the document does that, as in
// kept_deformation.
using KeptPoses = std::weak_ptr<const std::string>; // a table, which any build can read

/// It is no plain data, so only a library that was built in the same way may find it: by this name.
std::string posesName() {
    std::string name = "fcd_poses_1_" + std::to_string(sizeof(KeptPoses)) + "_" + std::to_string(sizeof(std::string));
#ifdef _LIBCPP_VERSION
    name += "_libc++";
#endif
    return name;
}

} // namespace

void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses) {
    if (poses.pose.empty()) {
        if (host::meshAttribute<KeptPoses>(layer.cm, posesName()))
            host::madeMeshAttribute<KeptPoses>(layer.cm, posesName()).reset();
        return;
    }
    // Not by make_shared, whose memory goes with the last weak pointer.
    auto held =
        std::make_shared<std::shared_ptr<const std::string>>(new std::string(vcg::fcd::PoseSequenceText(poses)));
    KeptPoses &kept = host::madeMeshAttribute<KeptPoses>(layer.cm, posesName());
    const std::shared_ptr<const std::string> before = kept.lock();
    if (before && *before == **held)
        return;
    kept = *held;
    // What is connected holds it, and goes with the document.
    QObject::connect(&document, &MeshDocument::meshRemoved, [held, number = layer.id()](int gone) {
        if (gone == number)
            held->reset();
    });
}

std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer) {
    const KeptPoses *kept = host::meshAttribute<KeptPoses>(layer.cm, posesName());
    const std::shared_ptr<const std::string> table = kept ? kept->lock() : nullptr;
    if (!table)
        return {};
    return vcg::fcd::ReadPoseSequence(*table, "poses of the layer");
}
