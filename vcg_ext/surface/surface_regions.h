// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_REGIONS_H
#define VCG_FCD_SURFACE_REGIONS_H

#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vcg::fcd {

/// The regions of a surface of n nodes: connected components of its free nodes, with a held node beside them.
struct SurfaceRegions {
    /// The largest number of regions. If there are more, the smallest are merged into one: even a tiny region costs
    /// some tens of microseconds to prepare and to pose.
    static constexpr Index most = 1000;

    Index count = 0;
    Index together = 0;          ///< how many regions were merged into the last one
    std::vector<Index> regionOf; ///< n, the region of each free node; -1: held, or loose

    /// The regions that \p node is free in, or holds, ascending. \param graph of the surface
    void Of(const Graph &graph, Index node, std::vector<Index> &regions) const;
};

/// The connected components of the free nodes of a surface of n nodes.
struct FreeComponents {
    Index count = 0;
    std::vector<Index> componentOf; ///< n, the component of each free node; -1: held
    std::vector<char> isHeld;       ///< count flags: a held node is beside it
    Index connected = 0;            ///< connected components of all nodes
};

/// \param tag n; 1 is free
FreeComponents FindComponents(const SurfaceGraph &surface, const std::vector<Index> &tag, const Progress &progress);

/// \param components of \p surface
SurfaceRegions FindRegions(const SurfaceGraph &surface, FreeComponents components);

/// What a free surface is read from: a whole mesh, or the part of it with one region.
struct RegionSource {
    SurfaceView mesh;
    SurfaceArrays arrays;              ///< owns the arrays of a part's mesh
    std::vector<int> tag;              ///< one per slot, noVertex where it is not read
    std::vector<std::uint32_t> slotOf; ///< of each slot, ascending: its slot in the whole mesh; empty: the same
    std::vector<std::uint32_t> faceOf; ///< of each face: its index in the whole mesh; empty: the same
    std::vector<std::size_t> point;    ///< slots of the point handles in it
    bool isOne = false;                ///< the free surface is one region, connected or not
    CloudPart of;                      ///< as in FreeRegion

    std::uint32_t InMesh(std::size_t slot) const { return slotOf.empty() ? std::uint32_t(slot) : slotOf[slot]; }
    /// The slot here of a slot of the whole mesh; the number of slots if it is not part of this.
    std::size_t Find(std::size_t inMesh) const;
};

/// The part of a mesh for each of its regions. Of a cloud, only their point handles are set.
/// \param surface as read from \p source \param tag as in FindComponents
std::vector<RegionSource> TakeRegions(const RegionSource &source, const SurfaceGraph &surface,
                                      const std::vector<Index> &tag, const SurfaceRegions &regions,
                                      const Progress &progress);

} // namespace vcg::fcd

#endif
