// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LOOSE_PARTS_H
#define VCG_FCD_LOOSE_PARTS_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/surface_regions.h>

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <vector>

namespace vcg::fcd {

/// The free surface that nothing holds: connected components without a fixed or handle vertex, isolated vertices.
struct LooseSurface {
    std::vector<Index> partOf; ///< per vertex slot: its loose part, -1 for none; empty where there are no loose parts
    Index parts = 0;
    Index components = 0;         ///< connected components of the free surface and what holds it, loose ones included
    Index isolated = 0;           ///< loose vertices without a neighbour
    bool isPartOfSurface = false; ///< some loose part has nodes in the surface that it was found in
};

/// The free surface of a mesh and the held vertices beside it. \param tag, places as of FreeRegion
SurfaceGraph ReadFreeSurface(const SurfaceView &mesh, const std::vector<int> &tag, const Eigen::Matrix3d &metric,
                             const Progress &progress, double weldDistance = defaultWeldDistance,
                             const Eigen::AlignedBox3d &places = {});

/// The loose parts of a surface. \param slotTag one per vertex slot, noVertex where it is not read
/// \param point slots of point handles \param components of \p surface
/// \param least a component of this area, frame units^2, is not loose though nothing holds it
LooseSurface FindLoose(const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                       const SurfaceGraph &surface, const FreeComponents &components, const Progress &progress,
                       double least = std::numeric_limits<double>::infinity());

/// How loose parts follow what holds or bends nearby, so that a button follows the sleeve.
struct LooseFollowing {
    static constexpr std::size_t none = std::size_t(-1);
    static constexpr int several = 8; ///< places that a vertex follows at most
    std::vector<std::size_t> leader;  ///< of each part, the slot of the nearest place, or none
    std::vector<std::size_t> place;   ///< slots that vertices follow, each once
    /// Vertices of parts that reach farther than patches do: each follows what is nearest to it.
    struct Vertex {
        std::size_t slot;
        Index place[several]; ///< of LooseFollowing::place, -1 fills up
        float weight[several];
    };
    std::vector<Vertex> vertex;
};

/// \param frame its metric is read \param large large(leader): the diameter, world units, from which a part with that
/// leader does not move as one
LooseFollowing FollowNearest(const PositionsRef &position, const std::vector<int> &slotTag, const Frame &frame,
                             const LooseSurface &loose, const std::function<double(std::size_t)> &large,
                             const Progress &progress);

} // namespace vcg::fcd

#endif
