// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a Deformer of a surface.
#include <vcg_ext/deformer.h>
#include <vcg_ext/region_reader.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace vcg::fcd {

/// Makes a Deformer: reads its regions, and prepares them in parallel.
class DeformerMaker {
  public:
    DeformerMaker(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param, const Deformer *kept)
        : mesh(mesh), param(param), metric(handles.world.linear()), kept(kept), made(new Deformer()) {
        for (const PointHandle &p : handles.point) {
            if (p.vertex >= mesh.vertexSlots || mesh.IsDeleted(p.vertex))
                throw BadInput("Point handle " + std::to_string(made->point.size() + 1) + " is at vertex " +
                               std::to_string(p.vertex) + ", which does not exist.");
            made->point.push_back(p.vertex);
            made->pointRest.emplace_back(mesh.At(p.vertex));
        }
    }

    std::unique_ptr<Deformer> Make(const std::vector<int> &tag, const Progress &progress) {
        const LoopHelpers helpers;
        RegionSource whole;
        whole.mesh = mesh;
        whole.point = made->point;
        whole.isOne = param.IsOneRegion();
        AssignLarge(whole.tag, mesh.vertexSlots, 0);
        ParallelForEach(progress.threads, mesh.vertexSlots, 1 << 16,
                        [&](std::size_t i) { whole.tag[i] = mesh.IsDeleted(i) ? noVertex : std::max(-1, tag[i]); });
        same = SameAs(whole);
        TagSame(whole.tag, mesh.isCloud ? 0 : noVertex); // in a cloud, kept points may be neighbours
        RegionReader reader(param, metric);
        ReadRegions found = reader.Read(whole, progress.Slice(0, 0.4));
        TagSame(whole.tag, 1);
        const bool isMany = !same.empty() && same.size() + found.regions.size() > std::size_t(SurfaceRegions::most);
        if (isMany || IsBesideSame(found.regions) ||
            !Prepare(found.regions, progress.Slice(0.4, 0.95))) { // begin again, and reuse nothing
            same.clear();
            found = reader.Read(whole, progress.Slice(0, 0.4));
            Prepare(found.regions, progress.Slice(0.4, 0.95));
        }
        made->apart = std::move(found.apart);
        made->report.together = found.together;
        made->placedNodes = found.placedNodes;
        made->slotTag = std::move(whole.tag);
        made->center = HandleCenters(made->slotTag, [&](std::size_t i) { return Eigen::Vector3d(mesh.At(i)); });
        for (const auto &[slot, held] : found.heldBeside)
            made->slotTag[slot] = held;
        made->loose = std::move(found.loose);
        Join(same.empty() ? found.gaps : std::max(found.gaps, kept->report.gaps));
        FollowLoose(progress.Slice(0.95, 1));
        FindCarried(progress.Slice(1, 1));
        return std::move(made);
    }

  private:
    /// The regions of `kept` that are unchanged in \p whole: all of their vertices have the same tags, and are the same
    /// point handles.
    std::vector<std::shared_ptr<const RegionDeformer>> SameAs(const RegionSource &whole) const {
        std::vector<std::shared_ptr<const RegionDeformer>> found;
        if (!kept || kept->slotTag.size() != whole.tag.size() || whole.isOne || kept->report.together > 0 ||
            param.nodes.cols() > 0)
            return found;
        std::vector<char> changed(whole.tag.size(), 0);
        for (std::size_t i = 0; i < changed.size(); ++i)
            changed[i] = whole.tag[i] != kept->slotTag[i];
        std::vector<char> isPoint(whole.point.empty() && kept->point.empty() ? 0 : changed.size(), 0);
        for (const std::vector<std::size_t> *points : {&kept->point, &whole.point})
            for (std::size_t i : *points)
                isPoint[i] ^= 1;
        for (std::size_t i = 0; i < isPoint.size(); ++i)
            changed[i] |= isPoint[i];
        for (const auto &region : kept->regions) {
            const auto isSame = [&](const MovingRegion::Bent &vertex) { return !changed[vertex.slot]; };
            if (std::all_of(region->bent.begin(), region->bent.end(), isSame) &&
                std::all_of(region->beside.begin(), region->beside.end(), isSame))
                found.push_back(std::static_pointer_cast<const RegionDeformer>(region));
        }
        return found;
    }

    /// Sets the tag of the free vertices of the regions that are reused.
    void TagSame(std::vector<int> &tag, int newTag) const {
        for (const auto &region : same)
            for (const MovingRegion::Bent &vertex : region->bent)
                tag[vertex.slot] = newTag;
    }

    /// Whether, in a cloud, a region that was read reaches free points of a reused region.
    bool IsBesideSame(const std::vector<ReadRegion> &read) const {
        if (!mesh.isCloud || same.empty())
            return false;
        std::vector<char> isSame(mesh.vertexSlots, 0);
        for (const auto &region : same)
            for (const MovingRegion::Bent &vertex : region->bent)
                isSame[vertex.slot] = 1;
        return std::any_of(read.begin(), read.end(), [&](const ReadRegion &each) {
            return std::any_of(each.surface.slots.begin(), each.surface.slots.end(), [&](std::uint32_t slot) {
                return each.surface.nodeOf[slot] >= 0 && isSame[each.slotOf.empty() ? slot : each.slotOf[slot]];
            });
        });
    }

    /// Prepares the regions that were read. \return false: reused regions would have other numbers of patches now
    bool Prepare(std::vector<ReadRegion> &read, const Progress &progress) {
        std::vector<std::pair<std::uint32_t, double>>
            areas; // sorted by first slot: the bits of sums depend on the order
        areas.reserve(read.size() + same.size());
        double largest = 0;
        for (const ReadRegion &each : read)
            largest = std::max(largest, each.surface.frame.scale);
        for (const auto &each : same)
            largest = std::max(largest, each->surface.frame.scale);
        const double unit = detail::UnitOf(largest);
        for (const ReadRegion &each : read)
            areas.emplace_back(each.first, AreaOf(each.surface, unit));
        for (const auto &each : same)
            areas.emplace_back(each->first, AreaOf(each->surface, unit));
        std::sort(areas.begin(), areas.end());
        double all = 0;
        for (const auto &each : areas)
            all += each.second;
        const auto patchesOf = [&](const SurfaceGraph &surface) {
            const double share = areas.size() == 1 ? 1
                                 : all > 0         ? AreaOf(surface, unit) / all
                                                   : 1 / double(areas.size());
            const int given = param.graph.initialPatches; // of all regions together, by area
            return given > 0 ? std::max(1, int(std::lround(share * given))) : 0;
        };
        const int most = MostOf(read);
        if (std::any_of(same.begin(), same.end(), [&](const auto &each) {
                return each->askedPatches != patchesOf(each->surface) || each->most != most;
            }))
            return false;
        std::vector<std::shared_ptr<const RegionDeformer>> regions(read.size());
        std::vector<std::vector<Index>> nodeOf(read.size());
        const auto prepare = [&](std::size_t r, const Progress &part) {
            DeformerParam ofRegion = param;
            ofRegion.graph.initialPatches = patchesOf(read[r].surface);
            read[r].most = most;
            regions[r] = std::make_shared<RegionDeformer>(std::move(read[r]), ofRegion, nodeOf[r], part);
            if (areas.size() > 1)
                nodeOf[r] = {};
        };
        if (read.size() == 1)
            prepare(0, progress);
        else
            ParallelTasks(progress, "Building the graph", read.size(), prepare);
        if (areas.size() == 1 && read.size() == 1 && nodeOf[0].size() == mesh.vertexSlots)
            made->nodeOf = std::move(nodeOf[0]);
        regions.insert(regions.end(), same.begin(), same.end());
        std::sort(regions.begin(), regions.end(), [](const auto &a, const auto &b) { return a->first < b->first; });
        made->regions.assign(regions.begin(), regions.end());
        made->report.limited =
            Index(std::count_if(regions.begin(), regions.end(), [](const auto &each) { return each->IsLimited(); }));
        return true;
    }

    /// The largest automatic number of patches of a region: smaller if all regions together could have so many that a
    /// pose takes more than about a second.
    int MostOf(const std::vector<ReadRegion> &read) const {
        const std::int64_t mostOfAll = 30000;
        std::vector<Index> nodes; // no region has more patches
        nodes.reserve(read.size() + same.size());
        for (const ReadRegion &each : read)
            nodes.push_back(each.surface.graph.Size());
        for (const auto &each : same)
            nodes.push_back(each->surface.graph.Size());
        int most = mostPatches;
        const auto all = [&] {
            std::int64_t sum = 0;
            for (Index each : nodes)
                sum += std::min(each, Index(most));
            return sum;
        };
        while (most > fewPatches && all() > mostOfAll)
            --most;
        return most;
    }
    /// \param unit of lengths, world units
    static double AreaOf(const SurfaceGraph &surface, double unit) {
        return surface.area * (surface.frame.scale / unit) * (surface.frame.scale / unit);
    }
    /// Sets node and region of each vertex, and the report of all regions. \param gaps of the whole surface
    void Join(Index gaps) {
        Deformer &all = *made;
        const std::size_t count = all.regions.size();
        if (count > 0)
            all.frame = all.regions[0]->surface.frame;
        if (all.nodeOf.empty() && count > 0) {
            AssignLarge(all.nodeOf, mesh.vertexSlots, Index(-1));
            if (count > 1)
                AssignLarge(all.regionOf, mesh.vertexSlots, std::uint32_t(0));
            const auto set = [&](std::size_t r, const std::vector<MovingRegion::Bent> &list) {
                for (const MovingRegion::Bent &vertex : list) {
                    all.nodeOf[vertex.slot] = vertex.node;
                    if (count > 1)
                        all.regionOf[vertex.slot] = std::uint32_t(r);
                }
            };
            for (std::size_t r = count; r-- > 0;) // a held vertex of several regions gets the first
                set(r, all.regions[r]->beside);
            for (std::size_t r = 0; r < count; ++r)
                set(r, all.regions[r]->bent);
        }
        SurfaceReport &sum = all.report;
        for (const auto &region : all.regions) {
            const SurfaceReport &each = region->surface.report;
            for (Index SurfaceReport::*number :
                 {&SurfaceReport::vertices, &SurfaceReport::welded, &SurfaceReport::isolated,
                  &SurfaceReport::nonManifoldEdges, &SurfaceReport::repeatedFaces, &SurfaceReport::degenerateFaces,
                  &SurfaceReport::seams, &SurfaceReport::gaps, &SurfaceReport::oneSided, &SurfaceReport::unenclosed})
                sum.*number += each.*number;
        }
        sum.gaps = std::max(sum.gaps, gaps); // these include gaps between regions
        sum.pointCloud = mesh.isCloud;
        sum.components = same.empty() ? all.loose.components : CountComponents(); // if not all was read
        sum.isolated += all.loose.isolated;
    }

    Index CountComponents() const {
        const Deformer &all = *made;
        DisjointSets joined(Index(all.regions.size()));
        Index components = Index(all.regions.size()) + all.loose.parts;
        for (std::size_t r = 0; r < all.regions.size(); ++r)
            for (const MovingRegion::Bent &vertex : all.regions[r]->beside)
                components -= joined.Join(Index(r), Index(all.At(vertex.slot).number));
        return components;
    }

    void FollowLoose(const Progress &progress) {
        Deformer &all = *made;
        double largest = all.regions.empty() ? std::numeric_limits<double>::infinity() : 0;
        for (std::size_t r = 0; r < all.regions.size(); ++r)
            largest = std::max(largest, all.Region(r).Reach() * all.regions[r]->surface.frame.scale);
        const auto large = [&](std::size_t leader) { // the diameter of a patch
            const MovingSurface::Place place =
                leader == LooseFollowing::none ? MovingSurface::Place{nullptr, 0, -1} : all.At(leader);
            return 2 * (place.region ? all.Region(place.number).Reach() * place.region->surface.frame.scale : largest);
        };
        all.following = param.looseParts == LooseParts::Follow
                            ? FollowNearest(mesh.Positions(), all.slotTag, all.frame, all.loose, large, progress)
                            : LooseFollowing{std::vector<std::size_t>(all.loose.parts, LooseFollowing::none), {}, {}};
        for (std::size_t i : all.following.leader)
            all.leaderRest.push_back(i == LooseFollowing::none ? Eigen::Vector3d::Zero() : Eigen::Vector3d(mesh.At(i)));
    }

    /// Lists the vertices that move, but do not bend: of handles, loose parts and isolated point handles.
    void FindCarried(const Progress &progress) {
        Deformer &all = *made;
        std::vector<char> isPoint; // one per slot, if there are point handles
        for (std::size_t i : all.point) {
            isPoint.resize(all.slotTag.size(), 0);
            isPoint[i] = 1;
        }
        const auto isCarried = [&](std::size_t i) {
            if (const MovingSurface::Place place = all.At(i); place.region) {
                const Index tag = place.region->held.tag[std::size_t(place.node)];
                return tag != 1 && !place.region->held.IsFixed(tag);
            }
            if (all.slotTag[i] != 1)
                return all.slotTag[i] > 1;
            return (!all.loose.partOf.empty() && all.loose.partOf[i] >= 0) || (!isPoint.empty() && isPoint[i]);
        };
        all.carried = NumbersThat<std::uint32_t>(progress, "Preparing the mapping", all.slotTag.size(), isCarried);
    }

    const SurfaceView mesh;
    const DeformerParam &param;
    const Eigen::Matrix3d metric;
    const Deformer *kept;
    std::vector<std::shared_ptr<const RegionDeformer>> same; // its regions that are reused
    std::unique_ptr<Deformer> made;
};

std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress, const Deformer *kept) {
    assert(handles.tag.size() == mesh.vertexSlots);
    return DeformerMaker(mesh, handles, param, kept).Make(handles.tag, progress);
}

} // namespace vcg::fcd
