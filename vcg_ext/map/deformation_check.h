// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_CHECK_H
#define VCG_FCD_DEFORMATION_CHECK_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/map/moving_surface.h>

#include <map>

namespace vcg::fcd {

/// What in a deformation is probably not meant.
struct DeformationCheck {
    static constexpr double volumeIsSeen = 0.01; ///< a volumeOff from which on there is a warning

    bool rigid = false;   ///< all that is held makes one and the same motion, so the surface moves rigidly
    Index overruled = 0;  ///< handle vertices held as another one at their place: fixed, or of a smaller tag
    Index strained = 0;   ///< edges between two held regions that get at least twice, or at most half, as long
    double longest = 1;   ///< the largest ratio of the length of such an edge to that at rest
    Index flipped = 0;    ///< triangles whose normals point to the other side
    double volumeOff = 0; ///< of parts that should keep their volume: the largest change, as a share of it
};

namespace detail {

/// Whether all held nodes of a region make the same motion, and one that moves them. \param tag n, 1 where free \param
/// motion of each other tag; of 0 whether there is such a node or not
bool MovesAsOne(const std::vector<Index> &tag, const std::map<Index, Eigen::Matrix4d> &motion);

/// \param tag one per vertex slot
Index CountOverruled(const MovingSurface &surface, const std::vector<int> &tag);

/// Checks edges between two held regions: no free vertex lies between their ends, so the edge alone bears the
/// difference of the motions. \param apart ends of the edges, slots \param position 3 x slots, deformed, mesh units
void CheckEdgesBetweenHeld(const SurfaceView &mesh, const Frame &frame,
                           const std::vector<std::array<std::uint32_t, 2>> &apart, const PositionsRef &position,
                           DeformationCheck &check);

/// Counts flipped triangles: the normal points away from where the patches of the corners turn it. Needles do not
/// count; their normals are noise. \param r number of the region whose triangles they are \param linear of its patches
Index CountFlipped(const SurfaceView &mesh, const MovingSurface &moving, std::size_t r,
                   const std::vector<Eigen::Matrix3d> &linear, const PositionsRef &position, const Progress &progress);

} // namespace detail
} // namespace vcg::fcd

#endif
