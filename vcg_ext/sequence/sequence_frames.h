// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SEQUENCE_FRAMES_H
#define VCG_FCD_SEQUENCE_FRAMES_H

#include <vcg_ext/map/carrier.h>
#include <vcg_ext/sequence/frame_files.h>
#include <vcg_ext/sequence/pose_sequence.h>
#include <vcg_ext/sequence/sequence_solver.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Another surface or cloud of an animation, which follows the posed one.
struct Companion {
    SurfaceView surface;   ///< at rest
    Eigen::Affine3d world; ///< its mesh units to the world
    std::string name;
    SurfaceLook look;
    /// Poses it. \p position is 3 x vertex slots, its mesh units; in: at rest, out: posed.
    std::function<void(const Carrier &carrier, Eigen::Matrix3Xd &position)> carry;
};

/// What is made of a pose sequence. Outputs that are empty are not made.
struct SequenceOutput {
    enum Shapes {
        EachFrame, ///< a morph target for each frame: exact
        EachPose   ///< a morph target for each pose, mixed linearly
    };

    double rate = 24;                  ///< frames a second
    std::string name;                  ///< of the mesh, in glTF
    SurfaceLook look;                  ///< in glTF
    std::vector<Companion> companions; ///< in glTF
    WriteAt gltf;                      ///< gets a .glb file, world units
    Shapes shapes = EachFrame;
    WriteAt pc2, mdd; ///< each gets a point cache, mesh units

    /// Gets a frame: its number, its pose, and its positions, 3 x vertex slots, mesh units.
    using Take = std::function<void(std::size_t number, const Deformer::Pose &pose, const Eigen::Matrix3Xd &position)>;
    Take frame;    ///< gets each frame
    Take keyFrame; ///< gets each key frame, also between two frames
};

/// A frame in which the surface passes through itself.
struct FrameContact {
    double time = 0; ///< seconds
    std::size_t triangles = 0;
    double depth = 0; ///< world units
};

/// The result of WriteFrames.
struct SequenceReport {
    std::size_t frames = 0; ///< frames that were made, and key frames between them
    double difference = 0;  ///< with EachPose: largest distance of a vertex, mixed, from the frame, world units
    bool converged = true;  ///< all poses
    bool jumps = false, unstable = false; ///< any pose, as in PosePath
    /// Deformer::DiscretisationError of the pose with most energy (Eq. 2). Only of that, since it takes another
    /// solution.
    double discretisationError = 0;
    Index folded = 0; ///< flipped triangles, the most of a pose
    /// The frames with contact. Looked for with DeformationParam::contact, or in at most contactUnasked faces.
    std::vector<FrameContact> contacts;

    std::size_t MostContact() const; ///< triangles, the most of a frame
    double ContactDepth() const;     ///< the largest, world units
    std::string ContactText() const; ///< a sentence with the frames with contact; empty without any
};

/// Solves the frames of a pose sequence, each from the one before, and makes the outputs. Only one frame is in memory
/// at a time; with EachPose also all poses, in single precision. The bits of a frame do not depend on other outputs.
/// \param surface, handles from which \p deformer was prepared; motions of handles are not read \param motions of the
/// handle tags in each pose, world units \throw BadInput sequence, rate or motions are wrong, a file would be too
/// large, or there is nothing to make \throw Unsolvable \throw Cancelled
SequenceReport WriteFrames(const SurfaceView &surface, const Handles &handles, const Deformer &deformer,
                           const PoseSequence &sequence, const std::vector<std::map<int, Motion>> &motions,
                           const DeformationParam &param, const SequenceOutput &output, const Progress &progress = {});

} // namespace vcg::fcd

#endif
