// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FREE_REGION_H
#define VCG_FCD_FREE_REGION_H

#include "frame.h"
#include "graph.h"
#include "memory.h"
#include "point_cloud.h"
#include "progress.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
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
};

} // namespace tri

namespace fcd {
namespace detail {

/// Finds what FreeRegion gives: Classify, then one of the two that reach neighbours.
template <class MeshType>
class RegionFinder {
  public:
    RegionFinder(const MeshType &m, const std::vector<int> &tag)
        : m(m), tag(tag), slots(m.vert.size()), state(new std::atomic<unsigned char>[slots]) {}

    /// \throw Error a coordinate of any vertex is not finite
    void Classify(const std::vector<char> &excluded, const Progress &progress) {
        std::vector<std::size_t> bad((slots + grain - 1) / grain, slots);
        ParallelFor(progress, readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const bool takesPart = !m.vert[i].IsD() && (excluded.empty() || !excluded[i]);
                if (takesPart && !tri::PositionOf(m.vert[i]).allFinite())
                    bad[first / grain] = std::min(bad[first / grain], i);
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
                const Eigen::Vector3d p = metric * tri::PositionOf(m.vert[i]);
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
        for (const Found &here : found) {
            region.faces.insert(region.faces.end(), here.faces.begin(), here.faces.end());
            region.apart.insert(region.apart.end(), here.apart.begin(), here.apart.end());
        }
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
    // A byte a vertex: what it is, whether a free neighbour or itself being one makes it part of the region, and, so
    // that few tags have to be looked up, its tag.
    static constexpr unsigned char live = 1, free = 2, reached = 4, few = 8, many = 31, all = 255;

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
    const std::size_t slots;
    std::unique_ptr<std::atomic<unsigned char>[]> state;
    tri::Region region;
};

/// body(number) for the cell of \p x in a grid of \p cells a unit, and for those nearer than \p hair, which is at most
/// a cell's width. In the frame, no two cells have the same number.
template <class Body>
void ForCells(const Eigen::Vector3f &x, float cells, float hair, const Body &body) {
    std::uint64_t low[3], high[3];
    for (int d = 0; d < 3; ++d) {
        const auto cellAt = [&](float at) {
            const float most = 1e15f; // far outside of the frame
            return std::uint64_t(std::int64_t(std::floor(std::min(most, std::max(-most, at * cells))))) &
                   ((std::uint64_t(1) << 21) - 1);
        };
        low[d] = cellAt(x[d] - hair);
        high[d] = cellAt(x[d] + hair);
    }
    for (int corner = 0; corner < 8; ++corner) {
        std::uint64_t number = 0;
        bool isNew = true;
        for (int d = 0; d < 3; ++d) {
            isNew &= !(corner >> d & 1) || high[d] != low[d];
            number = number << 21 | (corner >> d & 1 ? high[d] : low[d]);
        }
        if (isNew)
            body(number);
    }
}

/// A set of numbers: surely those that were put in, and a few others that share their bits.
class CellSet {
  public:
    /// \param wanted numbers, about
    explicit CellSet(std::size_t wanted) {
        while (words < wanted)
            words *= 2;
        bits = std::make_unique<std::atomic<std::uint32_t>[]>(words);
    }
    void Insert(std::uint64_t cell) {
        const std::uint64_t h = Hash(cell);
        bits[Word(h)].fetch_or(1u << (h & 31), std::memory_order_relaxed);
    }
    bool Contains(std::uint64_t cell) const {
        const std::uint64_t h = Hash(cell);
        return bits[Word(h)].load(std::memory_order_relaxed) >> (h & 31) & 1;
    }

  private:
    static std::uint64_t Hash(std::uint64_t cell) {
        std::uint64_t h = cell * 0x9E3779B97F4A7C15u;
        h = (h ^ h >> 29) * 0xBF58476D1CE4E5B9u;
        return h >> 20;
    }
    std::size_t Word(std::uint64_t hash) const { return (hash >> 5) & (words - 1); }

    std::size_t words = 1 << 10;
    std::unique_ptr<std::atomic<std::uint32_t>[]> bits;
};

/// The candidates that may be at a part of the region, or a hair from it, ascending. There is a bit for each cell of a
/// grid with such a place, some of them shared.
/// \param parts, candidates how many slots are flagged as such \param at at(slot): position in the frame
/// \param box of the parts, in the frame \param hair frame units, >= 0
template <class At>
std::vector<std::uint32_t> CandidatesBeside(const tri::Region &region, std::size_t parts, std::size_t candidates,
                                            const At &at, const Eigen::AlignedBox3f &box, float hair,
                                            const Progress &progress) {
    using tri::Region;
    const std::size_t slots = region.flag.size();
    // Wide enough for most hairs to lie in one, and narrow enough for few others.
    const float cells = hair > 0 ? 0.05f / hair : 1e6f;
    // Most candidates are not even near: a part's cell and those a hair from it end before, and so does what floats
    // round.
    const Eigen::Vector3f reach =
        Eigen::Vector3f::Constant(hair + 2 / cells) + 1e-6f * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
    const Eigen::AlignedBox3f near(box.min() - reach, box.max() + reach);
    const auto forCells = [&](std::size_t i, bool ofPart, const auto &body) {
        const Eigen::Vector3f x = at(i);
        if (ofPart || near.contains(x))
            ForCells(x, cells, ofPart ? hair : 0, body);
    };
    const auto isOn = [&](std::size_t i, bool ofPart) {
        return region.flag[i] == (ofPart ? Region::part : Region::candidate);
    };
    // Of the smaller side, parts or candidates, all cells; then those of the other that are in one of them, and the
    // same back.
    const bool partsFirst = parts <= candidates;
    CellSet first(std::min(parts, candidates));
    ParallelFor(progress.Slice(0, 0.5), readingStage, slots, 1 << 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (isOn(i, partsFirst))
                forCells(i, partsFirst, [&](std::uint64_t cell) { first.Insert(cell); });
    });
    const auto thoseIn = [&](const CellSet &set, bool ofPart) {
        return CollectInOrder<std::uint32_t>(
            progress.Slice(0.5, 1), readingStage, Index(slots), [&](Index i, std::vector<std::uint32_t> &found) {
                bool isIn = false;
                if (isOn(std::size_t(i), ofPart))
                    forCells(std::size_t(i), ofPart, [&](std::uint64_t cell) { isIn = isIn || set.Contains(cell); });
                if (isIn)
                    found.push_back(std::uint32_t(i));
            });
    };
    std::vector<std::uint32_t> part = thoseIn(first, !partsFirst), beside;
    CellSet second(part.size());
    for (std::uint32_t i : part)
        forCells(i, !partsFirst, [&](std::uint64_t cell) { second.Insert(cell); });
    beside = thoseIn(second, partsFirst);
    if (partsFirst)
        part.swap(beside);
    std::vector<std::uint64_t> cell;
    for (std::uint32_t i : part)
        forCells(i, true, [&](std::uint64_t c) { cell.push_back(c); });
    std::sort(cell.begin(), cell.end());
    const auto isNowhere = [&](std::uint32_t i) {
        bool isIn = false;
        forCells(i, false, [&](std::uint64_t c) { isIn = std::binary_search(cell.begin(), cell.end(), c); });
        return !isIn;
    };
    beside.erase(std::remove_if(beside.begin(), beside.end(), isNowhere), beside.end());
    return beside;
}

} // namespace detail
} // namespace fcd

namespace tri {

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them; \p excluded ones (flags, or
/// empty) are left out. \throw fcd::Error a coordinate of any vertex is not finite
template <class MeshType>
Region FreeRegion(const MeshType &m, const std::vector<int> &tag, const std::vector<char> &excluded,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const fcd::Progress &progress = {}) {
    fcd::detail::RegionFinder<MeshType> finder(m, tag);
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
