// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FREE_REGION_H
#define VCG_FCD_FREE_REGION_H

#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vcg::fcd {

/// Which vertex slots of a surface deform, and what holds them.
struct Region {
    static constexpr unsigned char none = 0, part = 1, candidate = 2;
    std::vector<unsigned char> flag;  ///< part: free, or held and joined to a free one; candidate: held, and part of it
                                      ///< where one that is part has the same position
    std::vector<std::uint32_t> faces; ///< as of SurfaceGraph
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as of SurfaceGraph
    static constexpr std::size_t boxed = 1 << 12;
    std::vector<Eigen::AlignedBox3d> box; ///< of the positions of each \p boxed slots, mesh units
    /// Of a part of a cloud: what is farther from all free points changes nothing, world units; infinity where there
    /// are too few points to tell.
    double reach = 0;
};

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them; those of tag noVertex are left
/// out. \param metric as of Frame \param places of a part of a cloud: the box that the points of all of it lie in,
/// world units, without strays. What is one place in all of the cloud then is one here. Empty: its own \throw BadInput
/// a coordinate of any vertex is not finite
Region FreeRegion(const SurfaceView &mesh, const std::vector<int> &tag,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const Progress &progress = {},
                  const Eigen::AlignedBox3d &places = {});

} // namespace vcg::fcd

#endif
