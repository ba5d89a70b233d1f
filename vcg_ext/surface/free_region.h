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
};

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them; those of tag noVertex are left
/// out. \param metric as of Frame \throw BadInput a coordinate of any vertex is not finite
Region FreeRegion(const SurfaceView &mesh, const std::vector<int> &tag,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const Progress &progress = {});

} // namespace vcg::fcd

#endif
