// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_REGION_READER_H
#define VCG_FCD_REGION_READER_H

#include <vcg_ext/region_deformer.h>
#include <vcg_ext/surface/loose_parts.h>
#include <vcg_ext/surface/surface_regions.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// The regions of a surface, and what else was met in it.
struct ReadRegions {
    std::vector<ReadRegion> regions;
    LooseSurface loose;                              ///< of the slots of what was read
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as of SurfaceGraph
    Index together = 0;                              ///< as of SurfaceRegions
    Index gaps = 0; ///< between regions, too: as of SurfaceReport; 0 where there is one
    std::vector<std::pair<std::uint32_t, int>> heldBeside; ///< vertices held as others at their place are: their tags
    Index placedNodes = 0;                                 ///< how many of the given nodes lie on the surface
    double reach = 0;                                      ///< as of Region
};

/// Reads the free surface of a mesh, divides it into regions, and reads each of these by itself, in its own frame. The
/// weld distance is relative: in the frame of a region, a seam of the whole may be a gap. A region that falls apart so
/// is divided again.
class RegionReader {
  public:
    /// Refers to \p param. \param metric as of Frame
    RegionReader(const DeformerParam &param, const Eigen::Matrix3d &metric) : param(param), metric(metric) {}

    /// \throw BadInput a coordinate that is not finite, point handles that make no sense, nodes that belong elsewhere
    /// \throw Cancelled
    ReadRegions Read(const RegionSource &source, const Progress &progress) { return ReadPart(source, true, progress); }

  private:
    ReadRegions ReadPart(const RegionSource &source, bool isWhole, const Progress &progress);
    void Divide(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held,
                const SurfaceRegions &regions, const Progress &progress, ReadRegions &found);
    void DivideCloud(const RegionSource &source, const SurfaceGraph &surface, const SurfaceRegions &regions,
                     const Progress &progress, std::vector<RegionSource> &parts, std::vector<ReadRegions> &within,
                     const ReadRegions &found);
    ReadRegion RegionOf(const RegionSource &source, SurfaceGraph surface, HeldNodes held) const;
    void FindGiven(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held, ReadRegions &found);

    const DeformerParam &param;
    const Eigen::Matrix3d metric;
    std::vector<std::size_t> given; // slots of the nodes that are given
};

} // namespace vcg::fcd

#endif
