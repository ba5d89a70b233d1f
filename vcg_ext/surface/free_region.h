// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FREE_REGION_H
#define VCG_FCD_FREE_REGION_H

#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace vcg::fcd {

/// The vertex slots of a surface that can deform, and those that hold them.
struct Region {
    static constexpr unsigned char none = 0, part = 1, candidate = 2;
    std::vector<unsigned char> flag;  ///< of each slot. part: free, or held beside a free one; candidate: held, and a
                                      ///< part if it has the position of a part
    std::vector<std::uint32_t> faces; ///< as in SurfaceGraph
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as in SurfaceGraph
    static constexpr std::size_t boxed = 1 << 12;
    std::vector<Eigen::AlignedBox3d> box; ///< of the positions of each \p boxed slots, mesh units
    /// Of a part of a cloud: points farther than this from all free points change nothing, world units. Infinity: there
    /// are too few points to tell. If it is more than CloudPart::reach, no part is looked for.
    double reach = 0;
};

/// What a part of a cloud was taken from.
struct CloudPart {
    /// The box of all the cloud's points, without strays, world units, so that points are welded as in the whole cloud.
    /// Empty: it is the whole, or no cloud.
    Eigen::AlignedBox3d places;
    /// All the cloud's points within this distance of the free ones are in the part, world units.
    double reach = std::numeric_limits<double>::infinity();
};

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them. Vertices of tag noVertex are left
/// out.
/// \param metric as in Frame \param of what \p mesh is a part of, if it is a part of a cloud
/// \throw BadInput a coordinate is not finite
Region FreeRegion(const SurfaceView &mesh, const std::vector<int> &tag,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const Progress &progress = {},
                  const CloudPart &of = {});

} // namespace vcg::fcd

#endif
