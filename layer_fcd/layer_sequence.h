// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_SEQUENCE_H
#define FCD_LAYER_SEQUENCE_H

#include <vcg_ext/sequence/pose_sequence.h> // before Qt

#include "parameters.h"
#include "prepared_layers.h"

#include <map>
#include <optional>
#include <vector>

/// What FCD: Pose Sequence did.
struct SequenceLayers {
    vcg::fcd::SequenceReport report;
    int poses = 0, keyFrames = 0, nodes = 0;
    int companions = 0; ///< layers that go along in the .glb file
    vcg::fcd::TagCount tags;
    std::vector<MeshModel *> layers; ///< that are new
    double seconds = 0;
};

/// FCD: Pose Sequence: poses a layer again and again; the frames are in new layers, and files. Poses that are of the
/// rest shape of a posed layer pose that. \param remark may be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document and all files are then
/// as they were
SequenceLayers makeSequence(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers,
                            const SequenceParam &param, const Remark &remark, const vcg::fcd::Progress &progress);

/// The poses that \p layer keeps, none where it keeps none: no file of MeshLab has room for them.
std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer);
/// Lets \p layer keep \p poses, in the place of those that it has; without any, it keeps none.
void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses);

/// The poses of a file, or, where \p file is empty, those that \p layer keeps. \param surface of the layer
/// \throw vcg::fcd::Error none, what is wrong with them, or poses of another surface
vcg::fcd::PoseSequence readPoses(const MeshModel &layer, const QString &file, const vcg::fcd::SurfaceMark &surface);

/// The motions of the handle tags in each pose. \param center of the handles, in the layer \param world its matrix
/// \throw vcg::fcd::Error naming the pose
std::vector<std::map<int, vcg::fcd::Motion>> motionsOf(const vcg::fcd::PoseSequence &sequence,
                                                       const MeshDocument &document, const MeshModel &layer,
                                                       const std::map<vcg::fcd::Index, Eigen::Vector3d> &center,
                                                       const Eigen::Affine3d &world);

#endif
