// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/morton.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/cloud_places.h>
#include <vcg_ext/surface/free_region.h>
#include <vcg_ext/surface/point_cloud.h>
#include <vcg_ext/surface/surface_graph.h>
#include <vcg_ext/surface/vertex_chunks.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

namespace vcg::fcd {

namespace {

/// Finds the result of FreeRegion: Classify, ReachNearest or ReachAlongElements, then TakeRegion.
class RegionFinder {
  public:
    RegionFinder(const SurfaceView &mesh, const std::vector<int> &tag)
        : mesh(mesh), tag(tag), slots(mesh.vertexSlots), state(new std::atomic<unsigned char>[slots]) {}

    /// \throw BadInput a coordinate of any vertex is not finite
    void Classify(const Progress &progress) {
        std::vector<std::size_t> bad((slots + grain - 1) / grain, slots);
        region.box.resize((slots + Region::boxed - 1) / Region::boxed);
        ParallelFor(progress, readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const bool takesPart = !mesh.IsDeleted(i) && tag[i] != noVertex;
                if (takesPart) {
                    const Eigen::Vector3d p = mesh.At(i);
                    if (!p.allFinite())
                        bad[first / grain] = std::min(bad[first / grain], i);
                    region.box[i / Region::boxed].extend(p);
                }
                const int held = std::min(int(many), std::max(0, tag[i])) * few;
                state[i].store((unsigned char)(held | (!takesPart    ? 0
                                                       : tag[i] == 1 ? live | free
                                                                     : live)),
                               std::memory_order_relaxed);
            }
        });
        for (std::size_t i : bad)
            if (i < slots)
                throw detail::NotFinite(i);
    }

    /// Marks as reached the free points of a cloud, and the places looked at to find their neighbours. Points a hair
    /// apart are one place. \param given metric \param of as in FreeRegion
    void ReachNearest(const Eigen::Matrix3d &given, const CloudPart &of, const Progress &progress) {
        Frame world;
        world.SetMetric(given);
        const auto isLive = [&](std::size_t i) { return bool(Is(i, live)); };
        const auto isFree = [&](std::size_t i) { return isLive(i) && Is(i, free); };
        const detail::VertexChunks chunks = detail::FindVertices(mesh, isLive, world, progress.Slice(0, 0));
        Eigen::AlignedBox3d ofFree = detail::FindVertices(mesh, isFree, world, progress.Slice(0, 0)).box;
        const std::size_t n = chunks.Live();
        const bool isPart = !of.places.isEmpty();
        region.reach = isPart ? INFINITY : 0;
        if (n < 2 || ofFree.isEmpty())
            return;
        // The box is that without strays, and these go to its outermost cells. Else all others would share a few cells.
        const auto at = [&](std::size_t k) -> Eigen::Vector3d {
            return given * mesh.At(detail::SlotOf(k, chunks.begin, isLive));
        };
        Eigen::AlignedBox3d box = isPart ? of.places : detail::WithoutStrays(chunks.box, n, at);
        if (const Eigen::AlignedBox3d near = ofFree.intersection(box); !near.isEmpty())
            ofFree = near;
        const double unit = detail::TakeUnit(chunks.box, box, ofFree);
        const Eigen::Matrix3d metric = given / unit;
        // Points that SurfaceGraph welds are some hairs apart, and mostly in one of these cells.
        const double cell = std::max(8 * defaultWeldDistance * ofFree.diagonal().norm(), 1e-300);
        // In Morton order, so that queries that follow each other visit the same memory.
        const Eigen::Vector3d scale = (box.max() * 0.5 - box.min() * 0.5).cwiseMax(1e-300).cwiseInverse() * 0.5;
        std::unique_ptr<std::uint64_t[]> order = LargeArray<std::uint64_t>(n);
        ParallelFor(progress.threads, slots, grain, [&](std::size_t first, std::size_t last) {
            std::size_t k = chunks.begin[first / grain];
            for (std::size_t i = first; i < last; ++i)
                if (Is(i, live)) {
                    const Eigen::Vector3d p = (metric * mesh.At(i) - (box.min() * 0.5 + box.max() * 0.5));
                    const Eigen::Vector3f x = p.cwiseProduct(scale).cast<float>();
                    order[k++] = std::uint64_t(detail::MortonCode(x[0], x[1], x[2])) << 32 | i;
                }
        });
        detail::RadixSortUpper30(order, n, progress.Slice(0, 0.1), "Finding neighbours");
        const std::unique_ptr<std::uint32_t[]> slotOf = LargeArray<std::uint32_t>(n); // ordered by place
        std::vector<std::vector<std::uint32_t>> begins((n + grain - 1) / grain);      // of the places of each chunk
        const auto codeAt = [&](std::size_t i) { return order[i] >> 32; };
        ParallelFor(progress.threads, n, grain, [&](std::size_t first, std::size_t last) {
            std::vector<std::uint32_t> here; // of the places whose code begins in the chunk
            here.reserve(last - first);
            std::vector<std::pair<std::array<double, 3>, std::uint32_t>> same; // cells and slots of one code
            std::size_t i = first, next;
            while (i > 0 && i < last && codeAt(i) == codeAt(i - 1))
                ++i;
            for (; i < last; i = next) {
                next = i + 1;
                if (next == n || codeAt(next) != codeAt(i)) {
                    slotOf[i] = std::uint32_t(order[i]);
                    here.push_back(std::uint32_t(i));
                    continue;
                }
                same.clear();
                for (next = i; next < n && codeAt(next) == codeAt(i); ++next) {
                    const Eigen::Vector3d p = metric * mesh.At(std::uint32_t(order[next]));
                    const Eigen::Vector3d at = ((p - ofFree.min()) / cell).array().floor();
                    same.push_back({{at[0], at[1], at[2]}, std::uint32_t(order[next])});
                }
                std::sort(same.begin(), same.end());
                for (std::size_t j = 0; j < same.size(); ++j) {
                    slotOf[i + j] = same[j].second;
                    if (j == 0 || same[j].first != same[j - 1].first)
                        here.push_back(std::uint32_t(i + j));
                }
            }
            begins[first / grain] = std::move(here);
        });
        order.reset();
        begins.back().push_back(std::uint32_t(n));
        const std::vector<std::uint32_t> start = Together(begins); // of each place's slots
        const std::size_t places = start.size() - 1;
        const auto reachPlace = [&](std::size_t place) {
            for (std::size_t k = start[place]; k < start[place + 1]; ++k)
                Reach(slotOf[k]);
        };
        if (places < 2) {
            reachPlace(0);
            return;
        }
        Eigen::Matrix3Xd point(3, Eigen::Index(places)); // the first of each place
        PreferLargePages(point.data(), places * sizeof(Eigen::Vector3d));
        const std::unique_ptr<char[]> has = LargeArray<char>(places);
        ParallelForEach(progress.threads, places, grain, [&](std::size_t place) {
            point.col(Eigen::Index(place)) = metric * mesh.At(slotOf[start[place]]);
            char of = 0;
            for (std::size_t k = start[place]; k < start[place + 1]; ++k)
                of = char(of | (Is(slotOf[k], free) ? hasFree : hasHeld));
            has[place] = of;
        });
        if (isPart)
            region.reach = unit * (ReachOf(point, has.get(), progress.Slice(0.1, 0.2)) + 2 * cell); // a place's width
        if (region.reach <= of.reach)
            ReachAround(point, has.get(), reachPlace, progress.Slice(0.2, 1));
    }

    /// Marks as reached the vertices of faces and edge elements with a free vertex.
    void ReachAlongElements(const Progress &progress) {
        struct Found {
            std::vector<std::uint32_t> faces;
            std::vector<std::array<std::uint32_t, 2>> apart;
        };
        std::vector<Found> found((mesh.faces + grain - 1) / grain);
        ParallelFor(progress, readingStage, mesh.faces, grain, [&](std::size_t first, std::size_t last) {
            Found here;
            for (std::size_t f = first; f < last; ++f) {
                if (!mesh.IsFace(f))
                    continue;
                std::size_t slot[3];
                unsigned char s[3];
                for (int j = 0; j < 3; ++j) {
                    slot[j] = mesh.corner[3 * f + std::size_t(j)];
                    s[j] = Is(slot[j], all);
                }
                if (s[0] == s[1] && s[1] == s[2] && !(s[0] & free) && s[0] / few != many)
                    continue; // all corners are held by one tag: most faces, if little is free
                if (Join(slot, s, 3))
                    here.faces.push_back(std::uint32_t(f));
                for (int j = 0, k = 1; j < 3; ++j, k = k == 2 ? 0 : k + 1) {
                    const int one = s[j] / few, other = s[k] / few;
                    if ((one == other && one != many) || one == 1 || other == 1 || !(s[j] & s[k] & live))
                        continue;
                    const std::size_t a = std::min(slot[j], slot[k]), b = std::max(slot[j], slot[k]);
                    if (std::max(0, tag[a]) != std::max(0, tag[b]))
                        here.apart.push_back({std::uint32_t(a), std::uint32_t(b)});
                }
            }
            found[first / grain] = std::move(here);
        });
        region.faces = Together(found, &Found::faces);
        region.apart = Together(found, &Found::apart);
        SortUnique(region.apart);
        for (std::size_t e = 0; e < mesh.edges; ++e)
            if (mesh.IsEdge(e)) {
                const std::size_t slot[2] = {mesh.end[2 * e], mesh.end[2 * e + 1]};
                const unsigned char s[2] = {Is(slot[0], all), Is(slot[1], all)};
                Join(slot, s, 2);
            }
    }

    /// Call it last.
    Region TakeRegion(const Progress &progress) {
        AssignLarge(region.flag, slots, Region::none);
        ParallelForEach(progress, readingStage, slots, grain, [&](std::size_t i) {
            region.flag[i] = Is(i, reached)                ? Region::part
                             : Is(i, live) && !Is(i, free) ? Region::candidate
                                                           : Region::none;
        });
        return std::move(region);
    }

  private:
    static constexpr char hasFree = 1, hasHeld = 2; // flags of a place

    /// Calls reachPlace for places with free points and for the places around them. Far from held points those around
    /// are free, too; so neighbours are searched near held points alone.
    /// \param point of each place, in Morton order \param has flags of each place
    template <class ReachPlace>
    static void ReachAround(const Eigen::Matrix3Xd &point, const char *has, const ReachPlace &reachPlace,
                            const Progress &progress) {
        const auto boxOfHeld = [&](std::size_t place) {
            const Eigen::Vector3d p = point.col(Eigen::Index(place));
            return (has[place] & hasHeld) ? Eigen::AlignedBox3d(p) : Eigen::AlignedBox3d();
        };
        const detail::BoxTree held(std::size_t(point.cols()), boxOfHeld);
        const detail::PlaceRuns runs(point, progress.threads);
        std::vector<Eigen::AlignedBox3d> around(
            runs.part.size()); // boxes with the neighbours of parts near held points
        const std::size_t grain = 256;
        const Progress looking = progress.Slice(0, 0.3);
        ParallelForEach(looking, detail::findingNeighbours, runs.box.size(), grain, [&](std::size_t r) {
            bool hasAny[2] = {false, false};
            for (std::size_t place = r * runs.size; place < runs.End(r); ++place)
                if (has[place] & hasFree) {
                    hasAny[runs.PartOf(place) % 2] = true;
                    reachPlace(place);
                }
            for (std::size_t p : {2 * r, 2 * r + 1})
                if (hasAny[p % 2])
                    if (const double reach = runs.Reach(p); held.IsNear(runs.part[p], reach))
                        around[p] = {runs.part[p].min().array() - reach, runs.part[p].max().array() + reach};
        });
        const detail::BoxTree searched(around.size(), [&](std::size_t p) { return around[p]; });
        std::vector<std::vector<std::size_t>> touched((runs.box.size() + grain - 1) / grain);
        const Progress touching = progress.Slice(0.3, 0.4);
        ParallelFor(touching, detail::findingNeighbours, runs.box.size(), grain,
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t r = first; r < last; ++r)
                            if (searched.IsNear(runs.box[r], 0))
                                for (std::size_t place = r * runs.size; place < runs.End(r); ++place)
                                    touched[first / grain].push_back(place);
                    });
        const std::vector<std::size_t> there = Together(touched); // the places in these boxes
        if (there.empty())
            return;
        const PointTree<double> blocks(Eigen::Matrix3Xd(point(Eigen::all, there)), progress.threads);
        ParallelFor(progress.Slice(0.4, 1), detail::findingNeighbours, blocks.Blocks(), 64,
                    [&](std::size_t first, std::size_t last) {
                        detail::CloudNeighbourhood<double> neighbourhood(blocks);
                        for (std::size_t at = blocks.Begin(first); at < blocks.Begin(last); ++at) {
                            const std::size_t place = there[std::size_t(blocks.Number(at))];
                            if (!(has[place] & hasFree) || around[runs.PartOf(place)].isEmpty())
                                continue;
                            neighbourhood.Look(at);
                            for (Index other : neighbourhood.around)
                                reachPlace(there[other]);
                        }
                    });
    }

    /// An upper bound of the distance from a free place to the places that are looked at. Parameters as in ReachAround.
    static double ReachOf(const Eigen::Matrix3Xd &point, const char *has, const Progress &progress) {
        const std::size_t wanted = detail::CloudNeighbourhood<double>::most + 1; // and the place itself
        const PointTree<double> blocks(point, progress.threads);
        std::vector<double> reach(blocks.Blocks(), blocks.Size() < wanted ? INFINITY : 0);
        ParallelFor(progress, detail::findingNeighbours, reach.size(), 64, [&](std::size_t first, std::size_t last) {
            std::vector<PointTree<double>::Neighbour> nearest;
            for (std::size_t b = first; b < last; ++b) {
                Eigen::AlignedBox3d free;
                for (std::size_t k = blocks.Begin(b); k < blocks.Begin(b + 1); ++k)
                    if (has[blocks.Number(k)] & hasFree)
                        free.extend(Eigen::Vector3d(point.col(blocks.Number(k))));
                if (free.isEmpty() || reach[b] > 0)
                    continue;
                blocks.Nearest(free.center(), wanted, nearest, b);
                reach[b] = std::sqrt(nearest.back().square) + 0.5 * free.diagonal().norm();
            }
        });
        return *std::max_element(reach.begin(), reach.end());
    }

    static constexpr std::size_t grain = detail::VertexChunks::grain;
    static_assert(grain % Region::boxed == 0, "one thread a box");
    // The state of a vertex: three flags, and above them its tag (times few); tags from `many` on share one value.
    static constexpr unsigned char live = 1, free = 2, reached = 4, few = 8, many = 31, all = 255;

    unsigned char Is(std::size_t i, unsigned char what) const {
        return (unsigned char)(state[i].load(std::memory_order_relaxed) & what);
    }
    void Reach(std::size_t i) {
        if (!Is(i, reached))
            state[i].fetch_or(reached, std::memory_order_relaxed);
    }
    /// Marks all corners as reached, if one is free and none is dead. \param s their states \return whether it did
    bool Join(const std::size_t *slot, const unsigned char *s, int corners) {
        unsigned char any = 0, every = live;
        for (int j = 0; j < corners; ++j) {
            any |= s[j] & free;
            every &= s[j];
        }
        if (!any || !every)
            return false;
        for (int j = 0; j < corners; ++j)
            if (!(s[j] & reached))
                state[slot[j]].fetch_or(reached, std::memory_order_relaxed);
        return true;
    }

    const SurfaceView &mesh;
    const std::vector<int> &tag;
    const std::size_t slots;
    std::unique_ptr<std::atomic<unsigned char>[]> state;
    Region region;
};

} // namespace

Region FreeRegion(const SurfaceView &mesh, const std::vector<int> &tag, const Eigen::Matrix3d &metric,
                  const Progress &progress, const CloudPart &of) {
    assert(tag.size() == mesh.vertexSlots);
    RegionFinder finder(mesh, tag);
    finder.Classify(progress.Slice(0, 0.1));
    if (mesh.isCloud)
        finder.ReachNearest(metric, of, progress.Slice(0.1, 0.9));
    else
        finder.ReachAlongElements(progress.Slice(0.1, 0.9));
    return finder.TakeRegion(progress.Slice(0.9, 1));
}

} // namespace vcg::fcd
