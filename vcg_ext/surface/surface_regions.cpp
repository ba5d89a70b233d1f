// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/surface/surface_regions.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace vcg::fcd {

void SurfaceRegions::Of(const Graph &graph, Index node, std::vector<Index> &regions) const {
    regions.clear();
    if (regionOf[node] >= 0) {
        regions.push_back(regionOf[node]);
        return;
    }
    for (Index v : graph.adjacency[node])
        if (const Index region = regionOf[v]; region >= 0 && (regions.empty() || regions.back() != region))
            regions.push_back(region);
    SortUnique(regions);
}

FreeComponents FindComponents(const SurfaceGraph &surface, const std::vector<Index> &tag, const Progress &progress) {
    FreeComponents found;
    const Csr &adjacency = surface.graph.adjacency;
    const auto isFree = [&](Index u) { return tag[u] == 1; };
    found.count = ConnectedComponents(
        adjacency, isFree, [](Index, Index) { return true; }, found.componentOf, progress, readingStage);
    found.isHeld.assign(std::size_t(found.count), 0);
    const std::vector<Index> held =
        NumbersThat(progress, readingStage, surface.graph.Size(), [&](Index u) { return !isFree(u); });
    DisjointSets joined(found.count + Index(held.size())); // components, then held nodes
    found.connected = found.count + Index(held.size());
    for (std::size_t i = 0; i < held.size(); ++i)
        for (Index v : adjacency[held[i]]) {
            Index other = found.componentOf[v];
            if (other >= 0)
                found.isHeld[other] = 1;
            else
                other = found.count + Index(std::lower_bound(held.begin(), held.end(), v) - held.begin());
            found.connected -= joined.Join(found.count + Index(i), other);
        }
    return found;
}

SurfaceRegions FindRegions(const SurfaceGraph &surface, FreeComponents components) {
    SurfaceRegions regions;
    std::vector<Index> number(std::size_t(components.count), -1);
    for (std::size_t c = 0; c < number.size(); ++c)
        if (components.isHeld[c])
            number[c] = regions.count++;
    regions.regionOf = std::move(components.componentOf);
    if (regions.count < components.count)
        for (Index &region : regions.regionOf)
            region = region < 0 ? -1 : number[region];
    if (regions.count <= SurfaceRegions::most)
        return regions;
    std::vector<double> area(std::size_t(regions.count), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (const Index region = regions.regionOf[u]; region >= 0)
            area[region] += double(surface.nodeArea[u]);
    std::vector<Index> order(area.size()), place(area.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return area[a] > area[b]; });
    const Index last = SurfaceRegions::most - 1;
    for (Index i = 0; i < regions.count; ++i)
        place[std::size_t(order[i])] = std::min(i, last);
    for (Index &region : regions.regionOf)
        region = region < 0 ? -1 : place[region];
    regions.together = regions.count - last;
    regions.count = SurfaceRegions::most;
    return regions;
}

std::size_t RegionSource::Find(std::size_t inMesh) const {
    if (slotOf.empty())
        return inMesh;
    const auto found = std::lower_bound(slotOf.begin(), slotOf.end(), inMesh);
    return found != slotOf.end() && *found == inMesh ? std::size_t(found - slotOf.begin()) : slotOf.size();
}

namespace {

/// Does TakeRegions.
class RegionTaker {
  public:
    RegionTaker(const RegionSource &source, const SurfaceGraph &surface, const std::vector<Index> &tag,
                const SurfaceRegions &regions)
        : source(source), mesh(source.mesh), surface(surface), tag(tag), slotTag(source.tag), regions(regions),
          parts(std::size_t(regions.count)), edges(parts.size()) {
        std::vector<Index> of;
        for (std::size_t i : source.point)
            if (const Index u = NodeOf(i); u >= 0) {
                regions.Of(surface.graph, u, of);
                for (Index region : of)
                    parts[region].point.push_back(i);
            }
    }

    std::vector<RegionSource> Take(const Progress &progress) {
        if (mesh.isCloud)
            return std::move(parts);
        ListElements(progress.Slice(0, 0.3));
        ListSlots(progress.Slice(0.3, 0.5));
        AssignLarge(local, mesh.vertexSlots, std::uint32_t(-1));
        ParallelTasks(progress.Slice(0.5, 1), readingStage, parts.size(),
                      [&](std::size_t r, const Progress &part) { Fill(r, part); });
        return std::move(parts);
    }

  private:
    static constexpr std::size_t grain = 1 << 16;

    Index NodeOf(std::size_t slot) const { return surface.nodeOf[slot]; }
    bool IsFreeIn(std::size_t r, std::size_t slot) const {
        const Index u = NodeOf(slot);
        return u >= 0 && regions.regionOf[u] == Index(r);
    }
    /// The region of an element's free corners; -1: none is free. \param corner its \p count slots
    Index RegionOf(const std::uint32_t *corner, int count) const {
        for (int k = 0; k < count; ++k)
            if (const Index u = NodeOf(corner[k]); u >= 0 && regions.regionOf[u] >= 0)
                return regions.regionOf[u];
        return -1;
    }

    /// The regions that an element without a free node belongs to, ascending: those beside its free vertices, which
    /// share nodes with held ones.
    std::vector<Index> HeldBy(const std::uint32_t *corner, int count) const {
        std::vector<Index> all, of;
        for (int k = 0; k < count; ++k)
            if (const Index u = NodeOf(corner[k]); u >= 0 && slotTag[corner[k]] == 1) {
                regions.Of(surface.graph, u, of);
                all.insert(all.end(), of.begin(), of.end());
            }
        SortUnique(all);
        return all;
    }

    /// Lists the faces and edge elements of each part, and their slots that are not free in it.
    void ListElements(const Progress &progress) {
        std::vector<Index> regionOf;
        AssignLarge(regionOf, surface.faces.size(), Index(-1));
        const auto addCorners = [&](Index region, const std::uint32_t *corner, int count, auto &list) {
            for (int k = 0; k < count; ++k)
                if (!IsFreeIn(std::size_t(region), corner[k]))
                    list.emplace_back(region, corner[k]);
        };
        using Brought = std::pair<Index, std::uint32_t>;
        more = CollectInOrder<Brought>(progress, readingStage, regionOf.size(), [&](Index f, auto &found) {
            const std::uint32_t *corner = mesh.corner + 3 * std::size_t(surface.faces[f]);
            regionOf[f] = RegionOf(corner, 3);
            if (regionOf[f] >= 0)
                addCorners(regionOf[f], corner, 3, found);
        });
        for (std::size_t f = 0; f < regionOf.size(); ++f)
            if (regionOf[f] >= 0) {
                parts[std::size_t(regionOf[f])].faceOf.push_back(surface.faces[f]);
            } else {
                const std::uint32_t *corner = mesh.corner + 3 * std::size_t(surface.faces[f]);
                for (Index region : HeldBy(corner, 3)) {
                    parts[region].faceOf.push_back(surface.faces[f]);
                    addCorners(region, corner, 3, more);
                }
            }
        for (std::size_t e = 0; e < mesh.edges; ++e)
            if (mesh.IsEdge(e)) {
                const std::uint32_t *end = mesh.end + 2 * e;
                std::vector<Index> of(1, RegionOf(end, 2));
                if (of[0] < 0)
                    of = HeldBy(end, 2);
                for (Index region : of) {
                    edges[region].push_back(e);
                    addCorners(region, end, 2, more);
                }
            }
    }

    /// Lists the slots of each part: free ones, those that hold it, and those of its elements.
    void ListSlots(const Progress &progress) {
        std::vector<std::vector<std::pair<Index, std::uint32_t>>> found((mesh.vertexSlots + grain - 1) / grain);
        ParallelFor(progress, readingStage, mesh.vertexSlots, grain, [&](std::size_t first, std::size_t last) {
            std::vector<std::pair<Index, std::uint32_t>> &list = found[first / grain];
            std::vector<Index> of;
            for (std::size_t i = first; i < last; ++i) {
                const Index u = NodeOf(i);
                if (u < 0)
                    continue;
                if (tag[u] == 1)
                    of.assign(1, regions.regionOf[u]);
                else if (slotTag[i] != 1)
                    regions.Of(surface.graph, u, of);
                else // free, but shares a held node: ListElements adds it
                    continue;
                for (Index region : of)
                    if (region >= 0)
                        list.emplace_back(region, std::uint32_t(i));
            }
        });
        for (auto &list : found) {
            for (const auto &[region, slot] : list)
                parts[region].slotOf.push_back(slot);
            list = {};
        }
        for (std::size_t r = 0; r < parts.size(); ++r)
            for (std::size_t i : parts[r].point)
                more.emplace_back(Index(r), std::uint32_t(i));
        SortUnique(more);
        for (std::size_t m = 0, end; m < more.size(); m = end) {
            RegionSource &part = parts[std::size_t(more[m].first)];
            const auto had = std::ptrdiff_t(part.slotOf.size());
            for (end = m; end < more.size() && more[end].first == more[m].first; ++end)
                if (!std::binary_search(part.slotOf.begin(), part.slotOf.begin() + had, more[end].second))
                    part.slotOf.push_back(more[end].second);
            std::inplace_merge(part.slotOf.begin(), part.slotOf.begin() + had, part.slotOf.end());
        }
    }

    void Fill(std::size_t r, const Progress &progress) {
        RegionSource &part = parts[r];
        part.arrays = SurfaceArrays(part.slotOf.size(), part.faceOf.size(), edges[r].size(), false);
        AssignLarge(part.tag, part.slotOf.size(), 0);
        ParallelForEach(progress.threads, part.slotOf.size(), grain, [&](std::size_t i) {
            Eigen::Map<Eigen::Vector3d>(part.arrays.Position(i)) = mesh.At(part.slotOf[i]);
            const std::size_t slot = part.slotOf[i];
            const Index u = NodeOf(slot);
            // A vertex that only a degenerate face brings in is free in another region, and held in this one.
            const bool isOfOthers = u >= 0 && tag[u] == 1 && !IsFreeIn(r, slot);
            part.tag[i] = isOfOthers ? 0 : slotTag[slot];
            if (IsFreeIn(r, slot))
                local[slot] = std::uint32_t(i);
        });
        const auto find = [&](std::size_t slot) {
            return IsFreeIn(r, slot) ? local[slot] : std::uint32_t(part.Find(slot));
        };
        ParallelForEach(progress.threads, part.faceOf.size(), grain, [&](std::size_t f) {
            for (std::size_t k = 0; k < 3; ++k)
                part.arrays.Corner(f)[k] = find(mesh.corner[3 * std::size_t(part.faceOf[f]) + k]);
        });
        for (std::size_t e = 0; e < edges[r].size(); ++e)
            for (std::size_t k = 0; k < 2; ++k)
                part.arrays.End(e)[k] = find(mesh.end[2 * edges[r][e] + k]);
        for (std::size_t &i : part.point)
            i = find(i);
        part.mesh = part.arrays.View();
        if (source.slotOf.empty())
            return;
        for (std::uint32_t &i : part.slotOf)
            i = source.slotOf[i];
        for (std::uint32_t &f : part.faceOf)
            f = source.faceOf[f];
    }

    const RegionSource &source;
    const SurfaceView &mesh;
    const SurfaceGraph &surface;
    const std::vector<Index> &tag;
    const std::vector<int> &slotTag;
    const SurfaceRegions &regions;
    std::vector<RegionSource> parts;
    std::vector<std::vector<std::size_t>> edges;       // of each part
    std::vector<std::uint32_t> local;                  // of each free slot: its slot in its part
    std::vector<std::pair<Index, std::uint32_t>> more; // a part, and a slot that an element brings into it
};

} // namespace

std::vector<RegionSource> TakeRegions(const RegionSource &source, const SurfaceGraph &surface,
                                      const std::vector<Index> &tag, const SurfaceRegions &regions,
                                      const Progress &progress) {
    return RegionTaker(source, surface, tag, regions).Take(progress);
}

} // namespace vcg::fcd
