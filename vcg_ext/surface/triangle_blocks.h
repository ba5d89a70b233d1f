// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_BLOCKS_H
#define VCG_FCD_TRIANGLE_BLOCKS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// Nodes cut into blocks that fit the cache, each with a copy of the triangles that have a corner in it.
struct TriangleBlocks {
    struct Triangle {
        Index corner[3];
    };
    Index nodes;
    int shift;                      ///< node u is in block u >> shift
    std::vector<std::size_t> begin; ///< blocks + 1: where each block's triangles begin
    std::unique_ptr<Triangle[]> triangle;

    /// A neighbour and, in the lowest bit, whether a face (not a bare edge) joins it.
    using Entry = std::uint32_t;

    /// Nodes [first, last) and their triangles.
    struct Block {
        Index first, last;
        const Triangle *begin, *end;

        bool Has(Index u) const { return u >= first && u < last; }

        /// Calls body(node - first, next, previous), the last two as Entry, for each corner in the block.
        template <class Body>
        void ForCorners(const Body &body) const {
            for (const Triangle *t = begin; t < end; ++t) {
                const Index *c = t->corner;
                if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) {
                    for (int i = 0, next = 1, previous = 2; i < 3; previous = i++, next = next == 2 ? 0 : next + 1)
                        if (Has(c[i]))
                            body(c[i] - first, Entry(c[next]) << 1 | 1, Entry(c[previous]) << 1 | 1);
                } else { // the edge between its two different corners
                    const Index u = c[0], v = c[0] == c[1] ? c[2] : c[1];
                    if (Has(u))
                        body(u - first, Entry(v) << 1, Entry(v) << 1);
                    if (Has(v))
                        body(v - first, Entry(u) << 1, Entry(u) << 1);
                }
            }
        }
    };
    static int ShiftFor(Index nodes) {
        int shift = 12;
        while ((nodes - 1) >> shift >= 1024)
            ++shift;
        return shift;
    }
    std::size_t Size() const { return begin.size() - 1; }
    Index FirstNode(std::size_t b) const { return Index(std::min(std::size_t(nodes), b << shift)); }
    Block operator[](std::size_t b) const {
        return {FirstNode(b), FirstNode(b + 1), triangle.get() + begin[b], triangle.get() + begin[b + 1]};
    }
};

/// The blocks of nodes [0, nodes). \param corner as in ConnectTriangles
inline TriangleBlocks SortIntoBlocks(Index nodes, const Index *corner, std::size_t triangles,
                                     const Progress &progress) {
    const std::size_t grain = 1 << 15, chunks = (triangles + grain - 1) / grain;
    const int shift = TriangleBlocks::ShiftFor(nodes);
    const std::size_t blocks = (std::size_t(nodes - 1) >> shift) + 1;
    const auto forBlocksOf = [shift](const Index *c, const auto &body) {
        const Index a = c[0] >> shift, b = c[1] >> shift, d = c[2] >> shift;
        if (c[0] == c[1] && c[1] == c[2])
            return;
        body(a);
        if (b != a)
            body(b);
        if (d != a && d != b)
            body(d);
    };

    // Count, prefix sum, fill.
    std::vector<std::size_t> at(chunks * blocks,
                                0); // of each chunk: number, then begin, of its triangles in each block
    ParallelFor(progress.Slice(0, 1.0 / 3), readingStage, triangles, grain, [&](std::size_t first, std::size_t last) {
        std::size_t *count = &at[first / grain * blocks];
        for (std::size_t t = first; t < last; ++t)
            forBlocksOf(corner + 3 * t, [&](Index block) { ++count[block]; });
    });
    std::vector<std::size_t> begin(blocks + 1, 0);
    for (std::size_t b = 0, sum = 0; b < blocks; ++b) {
        for (std::size_t c = 0; c < chunks; ++c) {
            const std::size_t here = at[c * blocks + b];
            at[c * blocks + b] = sum;
            sum += here;
        }
        begin[b + 1] = sum;
    }
    auto triangle = LargeArray<TriangleBlocks::Triangle>(begin[blocks]);
    ParallelFor(progress.Slice(1.0 / 3, 1), readingStage, triangles, grain, [&](std::size_t first, std::size_t last) {
        std::size_t *next = &at[first / grain * blocks];
        for (std::size_t t = first; t < last; ++t) {
            const Index *c = corner + 3 * t;
            forBlocksOf(c, [&](Index block) { triangle[next[block]++] = {{c[0], c[1], c[2]}}; });
        }
    });
    return {nodes, shift, std::move(begin), std::move(triangle)};
}

} // namespace vcg::fcd::detail

#endif
