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

/// The regions of a surface, and what else was found in it.
struct ReadRegions {
    std::vector<ReadRegion> regions;
    LooseSurface loose;                              ///< slots of the source that was read
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as in SurfaceGraph
    Index together = 0;                              ///< as in SurfaceRegions
    Index gaps = 0;                                  ///< as in SurfaceReport, also between regions; 0 for one region
    std::vector<std::pair<std::uint32_t, int>> heldBeside; ///< vertices that share a held node, and its tag
    Index placedNodes = 0;                                 ///< number of given nodes on the surface
    double reach = 0; ///< as in Region; if it is more than that of the source, nothing else is set
};

/// Reads the free surface of a mesh, divides it into regions, and reads each of these again by itself, in its own
/// frame. The weld distance is relative to the frame, so a seam of the whole surface may be a gap of a region. A region
/// that falls apart for that reason is divided again.
class RegionReader {
  public:
    /// \param param must outlive this \param metric as in Frame
    RegionReader(const DeformerParam &param, const Eigen::Matrix3d &metric) : param(param), metric(metric) {}

    /// \throw BadInput a coordinate that is not finite, invalid point handles, or given nodes that lie elsewhere
    /// \throw Cancelled
    ReadRegions Read(const RegionSource &source, const Progress &progress) { return ReadPart(source, true, progress); }

  private:
    ReadRegions ReadPart(const RegionSource &source, bool isWhole, const Progress &progress);
    void Divide(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held,
                const SurfaceRegions &regions, const Progress &progress, ReadRegions &found);
    void DivideCloud(const RegionSource &source, const SurfaceGraph &surface, const SurfaceRegions &regions,
                     const Progress &progress, std::vector<RegionSource> &parts, std::vector<ReadRegions> &within);
    ReadRegion RegionOf(const RegionSource &source, SurfaceGraph surface, HeldNodes held) const;
    void FindGiven(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held, ReadRegions &found);

    const DeformerParam &param;
    const Eigen::Matrix3d metric;
    std::vector<std::size_t> given; // slots of the vertices nearest to the given nodes
};

} // namespace vcg::fcd

#endif
