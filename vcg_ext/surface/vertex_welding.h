// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_VERTEX_WELDING_H
#define VCG_FCD_VERTEX_WELDING_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/morton.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/sort_short.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace vcg::fcd::detail {

/// Makes a node for each position of vertices, in Morton order. Call Put for each vertex, then Sort, FindNodes,
/// ForEach.
class VertexWelder {
  public:
    /// \param count number of vertices to Put \param slots all slots are below it
    VertexWelder(std::size_t count, std::size_t slots)
        : count(count), order(LargeArray<std::uint64_t>(count)), bySlot(3, slots) {
        PreferLargePages(bySlot.data(), slots * sizeof(Eigen::Vector3f));
    }

    /// Sets vertex number \p at of [0, count); slots ascend with it. \param p frame units, without negative zeros
    void Put(std::size_t at, std::size_t slot, const Eigen::Vector3f &p) {
        bySlot.col(slot) = p;
        order[at] = std::uint64_t(MortonCode(p[0], p[1], p[2])) << 32 | slot;
    }

    void Sort(const Progress &progress) { RadixSortUpper30(order, count, progress, readingStage); }

    /// \param isOptional isOptional(slot): positions that have optional vertices only are dropped
    template <class IsOptional>
    void FindNodes(const IsOptional &isOptional, const Progress &progress) {
        const std::size_t grain = 1 << 16;
        const auto codeEnd = [&](std::size_t i) { // the first position from i on where a code begins
            while (i > 0 && i < count && Code(i) == Code(i - 1))
                ++i;
            return std::min(i, count);
        };
        for (std::size_t i = 0; i < count; i = codeEnd(i + grain))
            rangeBegin.push_back(i);
        const std::size_t ranges = rangeBegin.size();
        rangeBegin.push_back(count);
        firstNode.assign(ranges + 1, 0);
        firstKept.assign(ranges + 1, 0);
        position.resize(3, count);
        PreferLargePages(position.data(), count * sizeof(Eigen::Vector3f));
        ParallelFor(progress, readingStage, ranges, 1,
                    [&](std::size_t range, std::size_t) { WeldRange(range, isOptional); });
        for (std::size_t range = 0; range < ranges; ++range) {
            firstNode[range + 1] += firstNode[range];
            firstKept[range + 1] += firstKept[range];
        }
    }
    Index Nodes() const { return firstNode.back(); }
    std::size_t Kept() const { return firstKept.back(); } ///< vertices that were not dropped

    /// Calls body(node, slot, at) for every vertex that was kept, number \p at of [0, Kept()), from several threads;
    /// all vertices of a node come in one thread. Call it last. \return position of each node, frame units
    template <class Body>
    Eigen::Matrix3Xf ForEach(const Body &body, const Progress &progress) {
        const bool shifted = std::size_t(Nodes()) < count;
        bySlot.resize(3, 0); // first: Eigen's resize frees the old memory twice where it gets no new one
        if (shifted)
            bySlot.resize(3, Nodes());
        ParallelFor(progress, readingStage, rangeBegin.size() - 1, 1, [&](std::size_t range, std::size_t) {
            Index node = firstNode[range] - 1;
            std::size_t at = firstKept[range];
            for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i) {
                if (SlotAt(i) == dropped)
                    continue;
                if (i == rangeBegin[range] || position.col(i) != position.col(i - 1)) {
                    ++node;
                    if (shifted)
                        bySlot.col(node) = position.col(i);
                }
                body(node, SlotAt(i), at++);
            }
        });
        if (shifted)
            position.swap(bySlot);
        order.reset();
        bySlot.resize(3, 0);
        return std::move(position);
    }

  private:
    static constexpr std::uint32_t dropped = std::uint32_t(-1);

    struct Item {
        float p[3];
        std::uint32_t slot;
        bool operator<(const Item &o) const {
            for (int d = 0; d < 3; ++d)
                if (p[d] != o.p[d])
                    return p[d] < o.p[d];
            return slot < o.slot;
        }
        bool SamePlace(const Item &o) const { return p[0] == o.p[0] && p[1] == o.p[1] && p[2] == o.p[2]; }
    };

    std::uint32_t SlotAt(std::size_t i) const { return std::uint32_t(order[i]); }
    std::uint64_t Code(std::size_t i) const { return order[i] >> 32; }
    void SetSlot(std::size_t i, std::uint32_t slot) { order[i] = Code(i) << 32 | slot; }

    template <class IsOptional>
    void WeldRange(std::size_t range, const IsOptional &isOptional) {
        std::vector<Item> sameCode;
        Index found = 0;
        std::size_t kept = 0;
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i)
            position.col(i) = bySlot.col(SlotAt(i));
        for (std::size_t i = rangeBegin[range], next; i < rangeBegin[range + 1]; i = next) {
            for (next = i + 1; next < rangeBegin[range + 1] && Code(next) == Code(i);)
                ++next;
            if (next - i == 1) {
                if (isOptional(SlotAt(i)))
                    SetSlot(i, dropped);
                else
                    ++found, ++kept;
                continue;
            }
            sameCode.clear();
            for (std::size_t j = i; j < next; ++j)
                sameCode.push_back({{position(0, j), position(1, j), position(2, j)}, SlotAt(j)});
            SortShort(sameCode.data(), sameCode.data() + sameCode.size());
            for (std::size_t a = 0, b; a < sameCode.size(); a = b) {
                bool isNode = false;
                for (b = a; b < sameCode.size() && sameCode[b].SamePlace(sameCode[a]); ++b)
                    isNode |= !isOptional(sameCode[b].slot);
                for (std::size_t j = a; j < b; ++j) {
                    position.col(i + j) << sameCode[j].p[0], sameCode[j].p[1], sameCode[j].p[2];
                    SetSlot(i + j, isNode ? sameCode[j].slot : dropped);
                }
                found += isNode;
                kept += isNode ? b - a : 0;
            }
        }
        firstNode[range + 1] = found;
        firstKept[range + 1] = kept;
    }

    const std::size_t count;
    std::unique_ptr<std::uint64_t[]> order; // Morton code << 32 | slot
    Eigen::Matrix3Xf bySlot, position;      // 3 x slots, and 3 x count in the order
    // Ranges of the order. A code, and so a position, is in one range.
    std::vector<std::size_t> rangeBegin;
    std::vector<Index> firstNode;       // ranges + 1: nodes of the ranges before
    std::vector<std::size_t> firstKept; // ranges + 1: vertices of them that are kept
};

} // namespace vcg::fcd::detail

#endif
