// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/patches/given_nodes.h>
#include <vcg_ext/region_reader.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

void TakeMesh(const RegionSource &source, SubMesh &part, RegionSource &each) {
    each.mesh = part.arrays.View();
    each.tag = std::move(part.tag);
    each.slotOf.reserve(part.slotOf.size());
    for (std::uint32_t i : part.slotOf)
        each.slotOf.push_back(source.InMesh(i));
    each.faceOf = std::move(part.faceOf);
    if (!source.faceOf.empty())
        for (std::uint32_t &f : each.faceOf)
            f = source.faceOf[f];
}

/// Of a cloud all points are looked at, as any may be a neighbour: those of other regions as if they were fixed.
void TakePoints(const RegionSource &source, const SurfaceGraph &surface, const HeldNodes &held,
                const SurfaceRegions &regions, const LooseSurface &loose, Index region, RegionSource &each) {
    each.mesh = source.mesh;
    each.leftOut = loose.partOf;
    AssignLarge(each.tag, source.tag.size(), 0);
    std::vector<Index> of;
    for (std::size_t i = 0; i < each.tag.size(); ++i) {
        const Index u = surface.nodeOf[i];
        each.tag[i] = source.tag[i];
        if (source.tag[i] != 1)
            continue;
        bool isOwn = u >= 0 && regions.regionOf[std::size_t(u)] == region;
        if (u >= 0 && held.tag[std::size_t(u)] != 1) { // at the place of what is held, as a point handle
            regions.Of(surface.graph, u, of);
            isOwn = std::binary_search(of.begin(), of.end(), region);
        }
        if (!isOwn)
            each.tag[i] = 0;
    }
}

/// The smallest slot of a free vertex.
std::uint32_t FirstOf(const ReadRegion &read) {
    std::uint32_t first = std::uint32_t(-1);
    for (std::uint32_t slot : read.surface.slots)
        if (const Index u = read.surface.nodeOf[slot]; u >= 0 && read.held.tag[std::size_t(u)] == 1)
            first = std::min(first, read.slotOf.empty() ? slot : read.slotOf[slot]);
    return first;
}

/// Vertices that share a place move as what holds it, be a region there or not.
std::vector<std::pair<std::uint32_t, int>> HeldBeside(const SurfaceGraph &surface, const std::vector<int> &tag,
                                                      const HeldNodes &held) {
    std::vector<std::pair<std::uint32_t, int>> beside;
    for (std::uint32_t slot : surface.slots)
        if (const Index u = surface.nodeOf[slot]; u >= 0)
            if (const Index its = held.Original(held.tag[std::size_t(u)]);
                its != 1 && its >= 0 && its != std::max(0, tag[slot]))
                beside.emplace_back(slot, its);
    return beside;
}

} // namespace

ReadRegions RegionReader::Read(const RegionSource &whole, const std::vector<std::uint32_t> &leaves,
                               const Progress &progress) {
    ReadRegions found = ReadPart(whole, &leaves, progress);
    if (found.regions.size() > 1 || !whole.leftOut.empty() || !leaves.empty())
        for (ReadRegion &each : found.regions)
            each.first = FirstOf(each);
    return found;
}

/// \param leaves as of Read; null: not all of the mesh is read
ReadRegions RegionReader::ReadPart(const RegionSource &source, const std::vector<std::uint32_t> *leaves,
                                   const Progress &progress) {
    ReadRegions found;
    SurfaceGraph surface =
        ReadFreeSurface(source.mesh, source.tag, source.leftOut, metric, progress.Slice(0, 0.5), param.weldDistance);
    HeldNodes held = HoldNodes(surface, source.tag, source.point, progress.Slice(0.5, 0.5));
    const double patch =
        param.bendsUnheld ? surface.area / param.graph.Patches() : std::numeric_limits<double>::infinity();
    std::vector<int> tag; // without what is left out
    if (!source.leftOut.empty()) {
        tag = source.tag;
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (source.leftOut[i] >= 0)
                tag[i] = noVertex;
    }
    FreeComponents components = FindComponents(surface, held.tag, progress.Slice(0.5, 0.55));
    found.loose = FindLoose(source.leftOut.empty() ? source.tag : tag, source.point, surface, components, patch);
    if (leaves) {
        found.apart = std::move(surface.apart);
        if (param.nodes.cols() > 0)
            FindGiven(source, surface, held, found);
    }
    const bool hasLoose = std::exchange(found.loose.isPartOfSurface, false);
    if (source.isOne) {
        if (hasLoose) {
            surface = ReadFreeSurface(source.mesh, source.tag, found.loose.partOf, metric, progress.Slice(0.55, 1),
                                      param.weldDistance);
            held = HoldNodes(surface, source.tag, source.point, progress.Slice(1, 1));
        }
        found.regions.push_back(RegionOf(source, std::move(surface), std::move(held)));
        return found;
    }
    const SurfaceRegions regions = FindRegions(surface, std::move(components));
    std::vector<char> isLeft(std::size_t(regions.count), 0);
    if (leaves)
        for (std::uint32_t slot : *leaves)
            isLeft[std::size_t(regions.regionOf[std::size_t(surface.nodeOf[slot])])] = 1;
    if (regions.count == 1 && !hasLoose && !isLeft[0]) {
        found.regions.push_back(RegionOf(source, std::move(surface), std::move(held)));
        return found;
    }
    found.together = regions.together;
    found.gaps = regions.count > 1 ? surface.report.gaps : 0;
    found.heldBeside = HeldBeside(surface, source.tag, held);
    Divide(source, std::move(surface), held, regions, isLeft, progress.Slice(0.55, 1), found);
    return found;
}

/// Reads each region of a surface by itself.
void RegionReader::Divide(const RegionSource &source, SurfaceGraph surface, const HeldNodes &held,
                          const SurfaceRegions &regions, const std::vector<char> &isLeft, const Progress &progress,
                          ReadRegions &found) {
    std::vector<SubMesh> parts;
    if (!source.mesh.isCloud)
        parts = TakeRegions(source.mesh, surface, held.tag, source.tag, source.point, regions, progress.Slice(0, 0.1));
    std::vector<std::vector<std::size_t>> point(std::size_t(regions.count)); // of each region
    std::vector<Index> of;
    for (std::size_t i : source.point)
        if (const Index u = surface.nodeOf[i]; u >= 0) {
            regions.Of(surface.graph, u, of);
            for (Index region : of)
                point[std::size_t(region)].push_back(i);
        }
    std::vector<ReadRegions> within(point.size());
    ParallelTasks(progress.Slice(0.1, 1), readingStage, within.size(), [&](std::size_t r, const Progress &part) {
        if (isLeft[r])
            return;
        RegionSource each;
        each.isOne = regions.together > 0 && r + 1 == within.size();
        if (source.mesh.isCloud)
            TakePoints(source, surface, held, regions, found.loose, Index(r), each);
        else
            TakeMesh(source, parts[r], each);
        for (std::size_t i : point[r])
            each.point.push_back(source.mesh.isCloud ? i : parts[r].Find(i));
        within[r] = ReadPart(each, nullptr, part);
    });
    for (std::size_t r = 0; r < within.size(); ++r) {
        for (ReadRegion &each : within[r].regions)
            found.regions.push_back(std::move(each));
        static const std::vector<std::uint32_t> same;
        within[r].loose.components = 0; // they are counted where all is read
        AddLoose(within[r].loose, source.mesh.isCloud ? same : parts[r].slotOf, source.tag.size(), found.loose);
    }
}

ReadRegion RegionReader::RegionOf(const RegionSource &source, SurfaceGraph surface, HeldNodes held) const {
    ReadRegion read;
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
    std::vector<char> isTaken(std::size_t(surface.graph.Size()), 0);
    for (std::size_t slot : given) {
        const auto at = std::lower_bound(source.slotOf.begin(), source.slotOf.end(), slot);
        if (!source.slotOf.empty() && (at == source.slotOf.end() || *at != slot))
            continue;
        const Index u = surface.nodeOf[source.slotOf.empty() ? slot : std::size_t(at - source.slotOf.begin())];
        if (u >= 0 && held.tag[std::size_t(u)] == 1 && !std::exchange(isTaken[std::size_t(u)], char(1)))
            read.center.push_back(u);
    }
    read.surface = std::move(surface);
    read.held = std::move(held);
    return read;
}

/// The slots of the nodes that are given.
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
