// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_GHOSTS_H
#define FCD_BEND_GHOSTS_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/sequence/pose_sequence.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

/// \file
/// Onion skin: the shapes of the key frames beside what is shown.

/// Which ones, by what they have of the poses, percent; empty: none.
struct GhostFrames {
    std::vector<double> before, after;
};
/// The key frames next to a time; none of less than two. \param keys ascending \param time seconds \param isShown the
/// animation is shown as it is then; else something is being posed, and a key frame of just that time is before it
GhostFrames ghostFrames(const std::vector<vcg::fcd::KeyFrame> &keys, double time, bool isShown);

/// Finds the shapes that blends of poses have, beside the window: it reads nothing of session and layer.
struct BlendShapes {
    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest
    std::shared_ptr<const std::vector<int>> tags;           ///< one per vertex slot
    Eigen::Affine3d world;                                  ///< the layer's matrix
    vcg::fcd::DeformationParam param;
    std::vector<std::map<int, vcg::fcd::Motion>> poses;
    std::shared_ptr<const vcg::fcd::Deformer> deformer; ///< for these tags and numbers; null: it is prepared first

    /// \param weight percent of each pose \param slot vertices \return three numbers for each of these, layer units
    /// \throw vcg::fcd::Error \throw vcg::fcd::Cancelled
    std::vector<float> of(const std::vector<double> &weight, const std::vector<std::uint32_t> &slot,
                          const vcg::fcd::Progress &progress);
};

#endif
