// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FREE_REGION_H
#define VCG_FCD_FREE_REGION_H

#include "frame.h"
#include "graph.h"
#include "memory.h"
#include "point_cloud.h"
#include "progress.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace tri {

/// Which vertex slots of a mesh deform, and what holds them.
struct Region {
    static constexpr unsigned char none = 0, part = 1, candidate = 2;
    std::vector<unsigned char> flag;  ///< part: free, or held and joined to a free one; candidate: held, and part of it
                                      ///< where one that is part has the same position
    std::vector<std::uint32_t> faces; ///< as of SurfaceGraph
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as of SurfaceGraph
    static constexpr std::size_t boxed = 1 << 12;
    std::vector<Eigen::AlignedBox3d> box; ///< of the positions of each \p boxed slots, mesh units
};

} // namespace tri

namespace fcd {
namespace detail {

/// Finds what FreeRegion gives: Classify, then one of the two that reach neighbours.
template <class MeshType>
class RegionFinder {
  public:
    RegionFinder(const MeshType &m, const std::vector<int> &tag, const Eigen::Matrix3Xd *known)
        : m(m), tag(tag), known(known), slots(m.vert.size()), state(new std::atomic<unsigned char>[slots]) {}

    /// \throw Error a coordinate of any vertex is not finite
    void Classify(const std::vector<char> &excluded, const Progress &progress) {
        const bool isCompact = std::size_t(m.vn) == slots; // then vertices need not be read
        std::vector<std::size_t> bad((slots + grain - 1) / grain, slots);
        region.box.resize((slots + tri::Region::boxed - 1) / tri::Region::boxed);
        ParallelFor(progress, readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const bool takesPart = (isCompact || !m.vert[i].IsD()) && (excluded.empty() || !excluded[i]);
                if (takesPart) {
                    const Eigen::Vector3d p = PositionAt(i);
                    if (!p.allFinite())
                        bad[first / grain] = std::min(bad[first / grain], i);
                    region.box[i / tri::Region::boxed].extend(p);
                }
                const int held = std::min(int(many), std::max(0, tag[i])) * few;
                state[i].store((unsigned char)(held | (takesPart ? tag[i] == 1 ? live | free : live : 0)),
                               std::memory_order_relaxed);
            }
        });
        for (std::size_t i : bad)
            if (i < slots)
                throw NotFinite(i);
    }

    /// Reaches the free points of a cloud and the nearest ones of each.
    void ReachNearest(const Eigen::Matrix3d &metric, const Progress &progress) {
        std::vector<std::size_t> slotOf;
        std::vector<vcg::Point3d> point;
        for (std::size_t i = 0; i < slots; ++i)
            if (Is(i, live)) {
                slotOf.push_back(i);
                const Eigen::Vector3d p = metric * PositionAt(i);
                point.emplace_back(p[0], p[1], p[2]);
            }
        if (point.size() < 2)
            return;
        vcg::ConstDataWrapper<vcg::Point3d> wrapper(point.data(), point.size());
        vcg::KdTree<double> tree(wrapper);
        const int wanted = int(std::min<std::size_t>(cloudNeighbours + 1, point.size()));
        ParallelFor(progress, "Finding neighbours", point.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
            vcg::KdTree<double>::PriorityQueue queue;
            for (std::size_t k = first; k < last; ++k) {
                if (!Is(slotOf[k], free))
                    continue;
                Reach(slotOf[k]); // among more points at its place it need not be found
                tree.doQueryK(point[k], wanted, queue);
                for (int j = 0; j < queue.getNofElements(); ++j)
                    Reach(slotOf[queue.getIndex(j)]);
            }
        });
    }

    /// Reaches the vertices of faces and edge elements that have a free one.
    void ReachAlongElements(const Progress &progress) {
        struct Found {
            std::vector<std::uint32_t> faces;
            std::vector<std::array<std::uint32_t, 2>> apart;
        };
        std::vector<Found> found((m.face.size() + grain - 1) / grain);
        ParallelFor(progress, readingStage, m.face.size(), grain, [&](std::size_t first, std::size_t last) {
            Found here;
            for (std::size_t f = first; f < last; ++f) {
                const auto &face = m.face[f];
                if (face.IsD())
                    continue;
                std::size_t slot[3];
                unsigned char s[3];
                for (int j = 0; j < 3; ++j) {
                    slot[j] = std::size_t(face.cV(j) - &m.vert[0]);
                    s[j] = Is(slot[j], all);
                }
                if (s[0] == s[1] && s[1] == s[2] && !(s[0] & free) && s[0] / few != many)
                    continue; // held as one, as mostly where little is free
                if (Join(slot, s, 3))
                    here.faces.push_back(std::uint32_t(f));
                for (int j = 0, k = 1; j < 3; ++j, k = k == 2 ? 0 : k + 1) {
                    const int one = s[j] / few, other = s[k] / few;
                    if ((one == other && one != many) || one == 1 || other == 1)
                        continue;
                    const std::size_t a = std::min(slot[j], slot[k]), b = std::max(slot[j], slot[k]);
                    if (std::max(0, tag[a]) != std::max(0, tag[b]))
                        here.apart.push_back({std::uint32_t(a), std::uint32_t(b)});
                }
            }
            found[first / grain] = std::move(here);
        });
        std::vector<std::size_t> begin(1, 0);
        for (const Found &here : found) {
            begin.push_back(begin.back() + here.faces.size());
            region.apart.insert(region.apart.end(), here.apart.begin(), here.apart.end());
        }
        AssignLarge(region.faces, begin.back(), std::uint32_t(0));
        ParallelFor(progress.threads, found.size(), 1, [&](std::size_t c, std::size_t) {
            std::copy(found[c].faces.begin(), found[c].faces.end(), region.faces.begin() + std::ptrdiff_t(begin[c]));
        });
        std::sort(region.apart.begin(), region.apart.end());
        region.apart.erase(std::unique(region.apart.begin(), region.apart.end()), region.apart.end());
        for (const auto &e : m.edge)
            if (!e.IsD()) {
                const std::size_t slot[2] = {std::size_t(e.cV(0) - &m.vert[0]), std::size_t(e.cV(1) - &m.vert[0])};
                const unsigned char s[2] = {Is(slot[0], all), Is(slot[1], all)};
                Join(slot, s, 2);
            }
    }

    /// The last that is asked.
    tri::Region TakeRegion(const Progress &progress) {
        using tri::Region;
        AssignLarge(region.flag, slots, Region::none);
        ParallelFor(progress, readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                region.flag[i] = Is(i, reached)                ? Region::part
                                 : Is(i, live) && !Is(i, free) ? Region::candidate
                                                               : Region::none;
        });
        return std::move(region);
    }

  private:
    static constexpr std::size_t grain = 1 << 16;
    static_assert(grain % tri::Region::boxed == 0, "one thread a box");
    // A byte a vertex: what it is, whether a free neighbour or itself being one makes it part of the region, and, so
    // that few tags have to be looked up, its tag.
    static constexpr unsigned char live = 1, free = 2, reached = 4, few = 8, many = 31, all = 255;

    Eigen::Vector3d PositionAt(std::size_t i) const { return tri::PositionOf(m, i, known); }
    unsigned char Is(std::size_t i, unsigned char what) const {
        return (unsigned char)(state[i].load(std::memory_order_relaxed) & what);
    }
    void Reach(std::size_t i) {
        if (!Is(i, reached))
            state[i].fetch_or(reached, std::memory_order_relaxed);
    }
    /// Reaches all corners where one is free. \param s their states \return whether that is so
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

    const MeshType &m;
    const std::vector<int> &tag;
    const Eigen::Matrix3Xd *known;
    const std::size_t slots;
    std::unique_ptr<std::atomic<unsigned char>[]> state;
    tri::Region region;
};

} // namespace detail
} // namespace fcd

namespace tri {

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them; \p excluded ones (flags, or
/// empty) are left out. \param known as of PositionOf \throw fcd::Error a coordinate of any vertex is not finite
template <class MeshType>
Region FreeRegion(const MeshType &m, const std::vector<int> &tag, const std::vector<char> &excluded,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const fcd::Progress &progress = {},
                  const Eigen::Matrix3Xd *known = nullptr) {
    fcd::detail::RegionFinder<MeshType> finder(m, tag, known);
    finder.Classify(excluded, progress.Slice(0, 0.1));
    if (m.fn == 0 && m.en == 0)
        finder.ReachNearest(metric, progress.Slice(0.1, 0.9));
    else
        finder.ReachAlongElements(progress.Slice(0.1, 0.9));
    return finder.TakeRegion(progress.Slice(0.9, 1));
}

} // namespace tri
} // namespace vcg

#endif
