// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_REGIONS_H
#define VCG_FCD_SURFACE_REGIONS_H

#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vcg::fcd {

/// Regions of a surface: the connected components of its free nodes that something holds.
struct SurfaceRegions {
    /// The largest number of regions. Beyond it, the smallest are joined to one: each costs some tens of microseconds
    /// to prepare and to pose, even a tiny one.
    static constexpr Index most = 1000;

    Index count = 0;
    Index together = 0;          ///< that are one, the last, as there are so many; else 0
    std::vector<Index> regionOf; ///< n, of the free nodes; -1 of others, and where nothing holds them

    /// The regions that a node is free in, or holds, ascending. \param graph as of the surface
    void Of(const Graph &graph, Index node, std::vector<Index> &regions) const;
};

/// The connected components of the free nodes of a surface.
struct FreeComponents {
    Index count = 0;
    std::vector<Index> componentOf; ///< n, of the free nodes; -1 of others
    std::vector<char> isHeld;       ///< count flags: a held node is beside it
    Index connected = 0;            ///< connected components of all nodes
};

/// \param tag of each node of \p surface; 1 is free
FreeComponents FindComponents(const SurfaceGraph &surface, const std::vector<Index> &tag, const Progress &progress);

/// \param components of \p surface
SurfaceRegions FindRegions(const SurfaceGraph &surface, FreeComponents components);

/// What a free surface is read from: a mesh, or the part of it that one region is read from.
struct RegionSource {
    SurfaceView mesh;
    SurfaceArrays arrays;              ///< of the mesh, where it is made for it
    std::vector<int> tag;              ///< one per slot, noVertex where it is not read
    std::vector<std::uint32_t> slotOf; ///< of each slot, ascending: that of the whole mesh; empty: the same
    std::vector<std::uint32_t> faceOf; ///< of each face, as slotOf
    std::vector<std::size_t> point;    ///< slots of the point handles in it
    bool isOne = false;                ///< the free surface is one region, connected or not
    Eigen::AlignedBox3d places;        ///< of a part of a cloud: as of FreeRegion

    std::uint32_t InMesh(std::size_t slot) const { return slotOf.empty() ? std::uint32_t(slot) : slotOf[slot]; }
    /// The slot that one of the whole mesh has, or that of none: the number of slots.
    std::size_t Find(std::size_t inMesh) const;
};

/// The parts of a mesh with faces or edge elements that its regions are read from; of those of a cloud only the point
/// handles. \param surface that was read of \p source \param tag as of FindComponents
std::vector<RegionSource> TakeRegions(const RegionSource &source, const SurfaceGraph &surface,
                                      const std::vector<Index> &tag, const SurfaceRegions &regions,
                                      const Progress &progress);

} // namespace vcg::fcd

#endif
