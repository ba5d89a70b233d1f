// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MOVING_SURFACE_H
#define VCG_FCD_MOVING_SURFACE_H

#include <vcg_ext/map/moving_region.h>
#include <vcg_ext/surface/loose_parts.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

namespace vcg::fcd {

/// One pose of a surface: of all its regions.
struct SurfacePose {
    HeldMotions given;
    std::vector<RegionPose> region;
    int iterations = 0; ///< the most of a region
    PosePath path;      ///< steps: the most of a region; jumps, unstable: of any region
    bool converged = true;
    double energy = 0; ///< Eq. 2, world units^2

    bool Moves() const {
        return given.Moves() ||
               std::any_of(region.begin(), region.end(), [](const RegionPose &each) { return each.Moves(); });
    }
};

/// A surface that deforms: its regions, its loose parts, and vertices that only move with handles.
struct MovingSurface {
    /// The node of a vertex.
    struct Place {
        const MovingRegion *region; ///< null if the vertex is in none
        std::size_t number;         ///< of the region
        Index node;                 ///< of its surface
    };

    Frame frame; ///< of the first region; if there is none, only the metric
    std::vector<std::shared_ptr<const MovingRegion>> regions;
    LooseSurface loose;
    std::vector<int> slotTag; ///< one per vertex slot, noVertex if it is deleted; vertices in no region at the position
                              ///< of a held one have the tag of that
    LooseFollowing following;
    std::vector<Eigen::Vector3d> leaderRest; ///< rest position of each loose part's leader, mesh units
    std::vector<std::uint32_t> carried;      ///< slots of handles, and of loose parts
    /// Per vertex slot: its node, in the first region that has the vertex; -1 for none.
    std::vector<Index> nodeOf;
    std::vector<std::uint32_t> regionOf; ///< per vertex slot: its region, if it has a node; empty if there is only one

    MovingSurface() = default;
    MovingSurface(const MovingSurface &) = delete; // others refer to it
    MovingSurface &operator=(const MovingSurface &) = delete;

    Place At(std::size_t slot) const {
        if (nodeOf.empty() || nodeOf[slot] < 0)
            return {nullptr, 0, -1};
        const std::size_t number = regionOf.empty() ? 0 : regionOf[slot];
        return {regions[number].get(), number, nodeOf[slot]};
    }

    /// Per vertex slot: the region in which it is free; if there is none, -1 - its tag.
    std::vector<Index> FreeIn() const {
        std::vector<Index> region;
        region.reserve(slotTag.size());
        for (int tag : slotTag)
            region.push_back(-1 - std::max(0, tag));
        for (std::size_t r = 0; r < regions.size(); ++r)
            for (const MovingRegion::Bent &vertex : regions[r]->bent)
                region[vertex.slot] = Index(r);
        return region;
    }

    /// Number of nodes of all graphs.
    Index Nodes() const {
        Index all = 0;
        for (const auto &region : regions)
            all += region->graph.Size();
        return all;
    }

    /// Calls body(slot) once for each slot that may move in some pose.
    template <class Body>
    void ForMoving(const Body &body) const {
        for (const auto &region : regions)
            for (const MovingRegion::Bent &vertex : region->bent)
                body(std::size_t(vertex.slot));
        for (std::uint32_t i : carried)
            body(std::size_t(i));
    }
};

} // namespace vcg::fcd

#endif
