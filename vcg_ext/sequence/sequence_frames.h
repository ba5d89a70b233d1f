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

/// Another surface or cloud of an animation, which goes along with the one that is posed.
struct Companion {
    SurfaceView surface;   ///< at rest
    Eigen::Affine3d world; ///< from its mesh units
    std::string name;
    SurfaceLook look;
    /// Where a pose takes it: gets its positions at rest, 3 x vertex slots, its mesh units, and changes them.
    std::function<void(const Carrier &carrier, Eigen::Matrix3Xd &position)> carry;
};

/// What a pose sequence is written as, and to whom.
struct SequenceOutput {
    enum Shapes {
        EachFrame, ///< each frame has its own morph target: it is what it is
        EachPose   ///< each pose has one, mixed in straight lines
    };

    double rate = 24;                  ///< frames a second
    std::string name;                  ///< of the mesh, in glTF
    SurfaceLook look;                  ///< in glTF
    std::vector<Companion> companions; ///< in glTF
    WriteAt gltf;                      ///< gets a .glb file in the world, or is empty
    Shapes shapes = EachFrame;
    WriteAt pc2, mdd; ///< each gets a point cache in mesh units, or is empty

    /// A frame that is wanted: its pose, and the positions, 3 x vertex slots, mesh units.
    using Take = std::function<void(std::size_t number, const Deformer::Pose &pose, const Eigen::Matrix3Xd &position)>;
    Take frame;    ///< gets each frame, or is empty
    Take keyFrame; ///< gets each key frame, also where it is between two frames, or is empty
};

/// A frame in which the surface passes through itself.
struct FrameContact {
    double time = 0; ///< seconds
    std::size_t triangles = 0;
    double depth = 0; ///< world units
};

/// What became of a pose sequence.
struct SequenceReport {
    std::size_t frames = 0; ///< that were written, or taken
    double difference = 0;  ///< of shapes for each pose, mixed, from the frames: the largest of a vertex; world units
    bool converged = true;  ///< whether all came to rest
    bool jumps = false, unstable = false; ///< any, as PoseWay tells
    /// As Deformer::DiscretisationError gives it, of the frame that is bent most (has most energy, Eq. 2): a solution
    /// of its own, once, and not in each frame.
    double discretisationError = 0;
    Index folded = 0; ///< flipped triangles, in the frame that has most
    /// As SurfaceContact tells of each frame, where there is any; looked for in no more than contactUnasked faces, or
    /// where DeformationParam::contact asks.
    std::vector<FrameContact> contacts;

    std::size_t MostContact() const; ///< triangles, in the frame that has most
    double ContactDepth() const;     ///< at most
    std::string ContactText() const; ///< a sentence with the count of each such frame; empty without any
};

/// Solves the frames of a pose sequence, one from the other, and writes them, no more than one at a time in memory (but
/// for shapes of each pose, which stay there in single precision). Frames have the same bits whatever else is made.
/// \param surface at rest, that \p deformer was prepared from with \p handles; the motions of these are not read
/// \param motions of the handle tags in each of the poses, in the world
/// \throw BadInput what is wrong with sequence, rate or motions, or a file that would be too large, or nothing to do
/// \throw Unsolvable \throw Cancelled
SequenceReport WriteFrames(const SurfaceView &surface, const Handles &handles, const Deformer &deformer,
                           const PoseSequence &sequence, const std::vector<std::map<int, Motion>> &motions,
                           const DeformationParam &param, const SequenceOutput &output, const Progress &progress = {});

} // namespace vcg::fcd

#endif
