// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_CHECK_H
#define VCG_FCD_DEFORMATION_CHECK_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/map/moving_surface.h>

#include <map>

namespace vcg::fcd {

/// Signs that a deformation is not as intended.
struct DeformationCheck {
    static constexpr double volumeIsSeen = 0.01; ///< least volumeOff with a warning

    bool rigid = false; ///< all held vertices make the same motion, so the surface moves as one
    Index overruled =
        0;              ///< handle vertices at the position of another held one, which wins: fixed, or of a smaller tag
    Index strained = 0; ///< edges between two held regions that become at least twice or at most half as long
    double longest = 1; ///< the largest ratio of such an edge's length to that at rest, >= 1
    Index flipped = 0;  ///< triangles whose normals point to the other side
    double volumeOff = 0; ///< largest change of a volume that should be kept, over that volume
};

namespace detail {

/// Whether all held nodes of a region make the same motion, and not the identity. \param tag n, 1 for free nodes
/// \param motion of each other tag, always with 0
bool MovesAsOne(const std::vector<Index> &tag, const std::map<Index, Eigen::Matrix4d> &motion);

/// As DeformationCheck::overruled. \param tag one per vertex slot
Index CountOverruled(const MovingSurface &surface, const std::vector<int> &tag);

/// Sets strained and longest, of edges between two held regions. \param apart the slots of their ends \param position 3
/// x slots, deformed, mesh units
void CheckEdgesBetweenHeld(const SurfaceView &mesh, const Frame &frame,
                           const std::vector<std::array<std::uint32_t, 2>> &apart, const PositionsRef &position,
                           DeformationCheck &check);

/// Counts triangles whose normal points away from the rest normal, turned as the patches of the corners turn. Needles
/// do not count: their normals are noise. \param r number of the region \param linear of its patches \param position 3
/// x slots, deformed, mesh units
Index CountFlipped(const SurfaceView &mesh, const MovingSurface &moving, std::size_t r,
                   const std::vector<Eigen::Matrix3d> &linear, const PositionsRef &position, const Progress &progress);

} // namespace detail
} // namespace vcg::fcd

#endif
