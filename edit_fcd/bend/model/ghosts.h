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
/// Onion skin: the shapes of the key frames before and after the shown one.

/// The weights of the poses in those key frames, percent; empty: none.
struct GhostFrames {
    std::vector<double> before, after;
};
/// The key frames next to a time; none if there are less than two. \param keys ascending \param time seconds
/// \param isShown the shown shape is the animation's at that time; false: something else is posed, and a key frame at
/// just that time counts as before
GhostFrames ghostFrames(const std::vector<vcg::fcd::KeyFrame> &keys, double time, bool isShown);

/// Computes the shapes of blends of poses. It reads neither session nor layer, so it may run in the background.
struct BlendShapes {
    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest
    std::shared_ptr<const std::vector<int>> tags;           ///< one per vertex slot
    Eigen::Affine3d world;                                  ///< the layer's matrix
    vcg::fcd::DeformationParam param;
    std::vector<std::map<int, vcg::fcd::Motion>> poses;
    std::shared_ptr<const vcg::fcd::Deformer> deformer; ///< for these tags and parameters; null: of() prepares it

    /// \param weight percent of each pose
    /// \param slot vertices \return three coordinates for each of these, layer units \throw vcg::fcd::Error
    /// \throw vcg::fcd::Cancelled
    std::vector<float> of(const std::vector<double> &weight, const std::vector<std::uint32_t> &slot,
                          const vcg::fcd::Progress &progress);
};

#endif
