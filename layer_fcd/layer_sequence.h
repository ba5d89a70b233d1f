// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_SEQUENCE_H
#define FCD_LAYER_SEQUENCE_H

#include <vcg_ext/sequence/sequence_frames.h> // these before Qt
#include <vcg_ext/sequence/surface_look.h>

#include "parameters.h"
#include "prepared_layers.h"

#include <functional>
#include <map>
#include <optional>
#include <vector>

/// The result of FCD: Pose Sequence.
struct SequenceLayers {
    vcg::fcd::SequenceReport report;
    int poses = 0, keyFrames = 0, nodes = 0;
    int companions = 0; ///< layers carried along in the .glb file
    vcg::fcd::TagCount tags;
    std::vector<MeshModel *> layers; ///< new ones
    double seconds = 0;
};

/// FCD: Pose Sequence: adds layers, and writes files, with the frames of a sequence of poses. Poses of the rest shape
/// of a posed layer begin at that. \param remark may be empty \throw vcg::fcd::Error, vcg::fcd::Cancelled; the document
/// and all files are then as they were
SequenceLayers makeSequence(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers,
                            const SequenceParam &param, const Remark &remark, const vcg::fcd::Progress &progress);

/// Takes a frame that is to become a layer, as NewLayers::addDeformed does. \param what "frame 1", "key frame 1" ...
using TakeFrame = std::function<void(const QString &what, const Eigen::Matrix3Xd &position,
                                     const std::vector<Eigen::Matrix3f> &linear)>;
/// Lets \p output hand these frames to \p take. \param layer at rest or posed \param surface at rest; it and
/// \p deformer outlive \p output
void takeFrames(SequenceParam::Layers which, const MeshModel &layer, const vcg::fcd::SurfaceView &surface,
                const vcg::fcd::Deformer &deformer, vcg::fcd::SequenceOutput &output, const TakeFrame &take);

/// The poses that \p layer keeps; none: it keeps none. (No file of MeshLab can hold them.)
std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer);
/// Lets \p layer keep \p poses instead of those that it has; without any pose, none.
void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses);

/// The poses of a file or, if \p file is empty, those that \p layer keeps. \param surface of the layer
/// \throw vcg::fcd::Error there are none, they are invalid, or of another surface
vcg::fcd::PoseSequence readPoses(const MeshModel &layer, const QString &file, const vcg::fcd::SurfaceMark &surface);

/// The motions of the handles in each pose, by tag. \param center of the handles, mesh units \param world the matrix
/// \throw vcg::fcd::Error naming the pose
std::vector<std::map<int, vcg::fcd::Motion>> motionsOf(const vcg::fcd::PoseSequence &sequence,
                                                       const MeshDocument &document, const MeshModel &layer,
                                                       const std::map<vcg::fcd::Index, Eigen::Vector3d> &center,
                                                       const Eigen::Affine3d &world);

/// The look of \p layer, for a file: its own colours, not those of tags; texture coordinates of corners or, if there
/// are none, of vertices; and its textures: the bytes of a PNG or JPEG file, or a PNG of the image that the layer
/// holds, if that differs. A texture that cannot be read is reported to \p remark, and has no content.
vcg::fcd::SurfaceLook lookOf(const MeshDocument &document, const MeshModel &layer, const Remark &remark);

#endif
