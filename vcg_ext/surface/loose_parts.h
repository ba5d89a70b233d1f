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
    std::vector<Index> partOf; ///< of each vertex slot: its loose part, or -1; empty if there are no loose parts
    Index parts = 0;
    Index components = 0;         ///< connected components of the free surface and what holds it, loose ones included
    Index isolated = 0;           ///< loose vertices without a neighbour
    bool isPartOfSurface = false; ///< some loose part has nodes in the surface
};

/// The free surface of a mesh and the held vertices beside it; only its reach if it is more than \p of.reach.
/// \param tag, of as in FreeRegion
/// \throw BadInput as FreeRegion and BuildSurfaceGraph
SurfaceGraph ReadFreeSurface(const SurfaceView &mesh, const std::vector<int> &tag, const Eigen::Matrix3d &metric,
                             const Progress &progress, double weldDistance = defaultWeldDistance,
                             const CloudPart &of = {});

/// The loose parts of a surface. \param slotTag one per vertex slot, noVertex where it is not read
/// \param point slots of point handles \param components of \p surface
/// \param least a component of at least this area (frame units^2), or the largest one, is not loose even if nothing
/// holds it
LooseSurface FindLoose(const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                       const SurfaceGraph &surface, const FreeComponents &components, const Progress &progress,
                       double least = std::numeric_limits<double>::infinity());

/// What loose parts follow: the surface nearby, as a button follows the sleeve. A small part follows one place, its
/// leader; each vertex of a large part follows several places by itself.
struct LooseFollowing {
    static constexpr std::size_t none = std::size_t(-1);
    static constexpr int several = 8; ///< the most places that a vertex follows
    std::vector<std::size_t> leader;  ///< of each part, the slot of the nearest place, or none
    std::vector<std::size_t> place;   ///< slots that vertices of large parts follow, each once
    struct Vertex {
        std::size_t slot;
        Index place[several]; ///< indices into LooseFollowing::place, -1 beyond the last one
        float weight[several];
    };
    std::vector<Vertex> vertex; ///< of large parts
};

/// Finds what each loose part follows. \param position 3 x slots, mesh units \param frame its metric is read
/// \param large large(leader): parts of a larger diameter (world units) with that leader are large
LooseFollowing FollowNearest(const PositionsRef &position, const std::vector<int> &slotTag, const Frame &frame,
                             const LooseSurface &loose, const std::function<double(std::size_t)> &large,
                             const Progress &progress);

} // namespace vcg::fcd

#endif
