// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/patches/given_nodes.h>
#include <vcg_ext/region_reader.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>
#include <vcg_ext/surface/cloud_parts.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

/// The smallest slot of a free vertex.
std::uint32_t FirstOf(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held) {
    for (std::size_t i = 0; i < surface.nodeOf.size(); ++i)
        if (const Index u = surface.nodeOf[i]; u >= 0 && held.tag[std::size_t(u)] == 1)
            return source.InMesh(i);
    return 0;
}

/// Adds the loose parts found in a part of a source to those of the source.
void AddLoose(const LooseSurface &loose, const RegionSource &part, const RegionSource &source, LooseSurface &all) {
    if (loose.parts > 0 && all.partOf.empty())
        AssignLarge(all.partOf, source.tag.size(), Index(-1));
    for (std::size_t i = 0; i < loose.partOf.size(); ++i)
        if (loose.partOf[i] >= 0)
            all.partOf[source.Find(part.InMesh(i))] = all.parts + loose.partOf[i];
    all.parts += loose.parts;
    all.isolated += loose.isolated;
}

/// The vertices that share a node with vertices held by another tag, and that tag: they move with it, also where there
/// is no region.
std::vector<std::pair<std::uint32_t, int>> HeldBeside(const SurfaceGraph &surface, const std::vector<int> &tag,
                                                      const HeldNodes &held, const Progress &progress) {
    return CollectInOrder<std::pair<std::uint32_t, int>>(
        progress, readingStage, surface.slots.size(), [&](std::size_t i, auto &beside) {
            const std::uint32_t slot = surface.slots[i];
            if (const Index u = surface.nodeOf[slot]; u >= 0)
                if (const Index heldTag = held.Original(held.tag[std::size_t(u)]);
                    heldTag != 1 && heldTag >= 0 && heldTag != std::max(0, tag[slot]))
                    beside.emplace_back(slot, heldTag);
        });
}

/// The faces with a free node, as nodes.
std::vector<std::array<Index, 3>> FacesOf(const SurfaceView &mesh, const SurfaceGraph &surface, const HeldNodes &held) {
    std::vector<std::array<Index, 3>> faces;
    for (std::uint32_t f : surface.faces) {
        std::array<Index, 3> face;
        for (std::size_t i = 0; i < 3; ++i)
            face[i] = surface.nodeOf[mesh.corner[3 * std::size_t(f) + i]];
        if (std::all_of(face.begin(), face.end(), [](Index u) { return u >= 0; }) &&
            std::any_of(face.begin(), face.end(), [&](Index u) { return held.tag[std::size_t(u)] == 1; }))
            faces.push_back(face);
    }
    return faces;
}

} // namespace

ReadRegions RegionReader::ReadPart(const RegionSource &source, bool isWhole, const Progress &progress) {
    ReadRegions found;
    SurfaceGraph surface =
        ReadFreeSurface(source.mesh, source.tag, metric, progress.Slice(0, 0.5), param.weldDistance, source.of);
    found.reach = surface.reach;
    if (found.reach > source.of.reach)
        return found;
    HeldNodes held = HoldNodes(surface, source.tag, source.point, progress.Slice(0.5, 0.5));
    const double patch =
        param.bendsUnheld ? surface.area / param.graph.Patches() : std::numeric_limits<double>::infinity();
    FreeComponents components = FindComponents(surface, held.tag, progress.Slice(0.5, 0.55));
    found.loose = FindLoose(source.tag, source.point, surface, components, progress.Slice(0.55, 0.55), patch);
    if (isWhole) {
        found.apart = std::move(surface.apart);
        if (param.nodes.cols() > 0)
            FindGiven(source, surface, held, found);
    }
    const bool hasLoose = std::exchange(found.loose.isPartOfSurface, false);
    if (source.isOne) {
        if (hasLoose) {
            std::vector<int> tag = source.tag;
            for (std::size_t i = 0; i < tag.size(); ++i)
                if (found.loose.partOf[i] >= 0)
                    tag[i] = source.mesh.isCloud ? 0 : noVertex; // points of a cloud are counted among those around
            surface = ReadFreeSurface(source.mesh, tag, metric, progress.Slice(0.55, 1), param.weldDistance, source.of);
            found.reach = std::max(found.reach, surface.reach);
            if (found.reach > source.of.reach)
                return found;
            held = HoldNodes(surface, tag, source.point, progress.Slice(1, 1));
        }
        found.regions.push_back(RegionOf(source, std::move(surface), std::move(held)));
        return found;
    }
    const SurfaceRegions regions = FindRegions(surface, std::move(components));
    if (regions.count == 1 && !hasLoose) {
        found.regions.push_back(RegionOf(source, std::move(surface), std::move(held)));
        return found;
    }
    found.together = regions.together;
    found.gaps = regions.count > 1 ? surface.report.gaps : 0;
    found.heldBeside = HeldBeside(surface, source.tag, held, progress.Slice(0.55, 0.55));
    Divide(source, surface, held, regions, progress.Slice(0.55, 1), found);
    return found;
}

/// Reads each region of a surface by itself.
void RegionReader::Divide(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held,
                          const SurfaceRegions &regions, const Progress &progress, ReadRegions &found) {
    std::vector<RegionSource> parts = TakeRegions(source, surface, held.tag, regions, progress.Slice(0, 0.1));
    if (regions.together > 0)
        parts.back().isOne = true;
    std::vector<ReadRegions> within(parts.size());
    if (source.mesh.isCloud)
        DivideCloud(source, surface, regions, progress.Slice(0.1, 1), parts, within);
    else
        ParallelTasks(progress.Slice(0.1, 1), readingStage, within.size(), [&](std::size_t r, const Progress &part) {
            within[r] = ReadPart(parts[r], false, part);
            parts[r].tag = {};
        });
    for (std::size_t r = 0; r < within.size(); ++r) {
        for (ReadRegion &each : within[r].regions)
            found.regions.push_back(std::move(each));
        AddLoose(within[r].loose, parts[r], source, found.loose);
        found.reach = std::max(found.reach, within[r].reach);
    }
}

/// Divides a cloud. Any point around may be a neighbour, so a region is read from all points around its free ones, as
/// if all others were fixed. If neighbours may lie farther away than these points reach, it is read from more of them.
void RegionReader::DivideCloud(const RegionSource &source, const SurfaceGraph &surface, const SurfaceRegions &regions,
                               const Progress &progress, std::vector<RegionSource> &parts,
                               std::vector<ReadRegions> &within) {
    if (parts.empty())
        return;
    const auto isLive = [&](std::size_t i) { return source.tag[i] != noVertex; };
    const detail::CloudParts cloud(source.mesh, isLive, metric, progress.Slice(0, 0.1));
    std::vector<std::vector<std::uint32_t>> free(parts.size()); // slots, also those that share a point handle's node
    std::vector<Index> of;
    for (std::size_t i = 0; i < source.tag.size(); ++i)
        if (const Index u = surface.nodeOf[i]; u >= 0 && source.tag[i] == 1) {
            regions.Of(surface.graph, u, of);
            for (Index region : of)
                free[std::size_t(region)].push_back(std::uint32_t(i));
        }
    ParallelTasks(progress.Slice(0.1, 1), readingStage, parts.size(), [&](std::size_t r, const Progress &progress) {
        const std::vector<std::size_t> point = std::move(parts[r].point);
        RegionSource &part = parts[r];
        const bool isWhole = source.of.places.isEmpty();
        part.of = {isWhole ? cloud.places : source.of.places, isWhole ? 0 : std::numeric_limits<double>::infinity()};
        for (bool isEnough = false; !isEnough;) {
            part.slotOf = cloud.Around(free[r], detail::CloudNeighbourhood<double>::most, part.of.reach);
            part.arrays = SurfaceArrays(part.slotOf.size(), 0, 0, false);
            part.arrays.isCloud = true;
            part.mesh = part.arrays.View();
            part.tag.clear();
            for (std::uint32_t i : part.slotOf) {
                Eigen::Map<Eigen::Vector3d>(part.arrays.Position(part.tag.size())) = source.mesh.At(i);
                part.tag.push_back(source.tag[i] == 1 ? 0 : source.tag[i]);
            }
            for (std::uint32_t i : free[r])
                part.tag[part.Find(i)] = 1;
            part.point.clear();
            for (std::size_t i : point)
                part.point.push_back(part.Find(i));
            for (std::uint32_t &i : part.slotOf)
                i = source.InMesh(i);
            within[r] = ReadPart(part, false, progress);
            isEnough = within[r].reach <= part.of.reach;
            if (!isEnough) // with more points, the reach that is found mostly gets smaller
                part.of.reach = std::min(2 * part.of.reach, 1.25 * within[r].reach);
        }
        part.tag = {};
    });
}

ReadRegion RegionReader::RegionOf(const RegionSource &source, SurfaceGraph surface, HeldNodes held) const {
    ReadRegion read;
    read.first = FirstOf(source, surface, held);
    if (param.elastic)
        read.faces = FacesOf(source.mesh, surface, held);
    read.slotOf = source.slotOf;
    if (!source.faceOf.empty())
        for (std::uint32_t &f : surface.faces)
            f = source.faceOf[f];
    std::vector<Index> pointTag;
    for (std::size_t i = 0; i < source.point.size(); ++i)
        if (HeldNodes::IsSingle(held.pointTag[i])) {
            pointTag.push_back(held.pointTag[i]);
            read.point.push_back(source.InMesh(source.point[i]));
        }
    held.pointTag = std::move(pointTag);
    read.hasGivenNodes = param.nodes.cols() > 0;
    std::vector<char> isTaken(given.empty() ? 0 : std::size_t(surface.graph.Size()), 0);
    for (std::size_t inMesh : given)
        if (const std::size_t slot = source.Find(inMesh); slot < surface.nodeOf.size())
            if (const Index u = surface.nodeOf[slot];
                u >= 0 && held.tag[std::size_t(u)] == 1 && !std::exchange(isTaken[std::size_t(u)], char(1)))
                read.center.push_back(u);
    read.surface = std::move(surface);
    read.held = std::move(held);
    return read;
}

/// Sets `given`.
void RegionReader::FindGiven(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held,
                             ReadRegions &found) {
    const std::vector<Index> node =
        detail::NearestNodes(source.mesh.Positions(), surface, source.tag, held.tag, param.nodes, found.placedNodes);
    std::vector<Index> number(std::size_t(surface.graph.Size()), -1);
    for (std::size_t i = 0; i < node.size(); ++i)
        number[std::size_t(node[i])] = Index(i);
    given.assign(node.size(), 0);
    for (std::uint32_t slot : surface.slots)
        if (const Index u = surface.nodeOf[slot]; u >= 0 && number[std::size_t(u)] >= 0)
            given[std::size_t(number[std::size_t(u)])] = slot;
}

} // namespace vcg::fcd
