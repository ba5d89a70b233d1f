// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_GRAPH_H
#define VCG_FCD_TRIANGLE_GRAPH_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/sort_short.h>
#include <vcg_ext/surface/surface_arrays.h>
#include <vcg_ext/surface/triangle_blocks.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// Triangles between nodes. A triangle with a repeated corner stands for an edge; one with three equal corners counts
/// for nothing.
struct TriangleList {
    std::unique_ptr<Index[]> corner; ///< 3 x count nodes
    std::size_t count = 0;
    Index degenerateFaces = 0; ///< as in SurfaceReport
};

/// The faces and edge elements of a mesh, except deleted ones, those with a vertex without a node, and those with held
/// nodes only.
/// \param faces indices of the faces to read; nullptr: all \param nodeOf as in SurfaceGraph \param isHeld isHeld(node)
template <class IsHeld>
TriangleList ElementTriangles(const SurfaceView &mesh, const std::vector<std::uint32_t> *faces,
                              const std::vector<Index> &nodeOf, const IsHeld &isHeld, const Progress &progress) {
    const std::size_t faceCount = faces ? faces->size() : mesh.faces, grain = 1 << 16;
    TriangleList list;
    list.corner = LargeArray<Index>(3 * (faceCount + mesh.edges));
    // Writes the element's nodes to \p to. \return whether it counts
    const auto take = [&](const std::uint32_t *slot, int corners, Index *to) {
        for (int j = 0; j < 3; ++j) {
            to[j] = nodeOf[slot[std::min(j, corners - 1)]];
            if (to[j] < 0)
                return false;
        }
        return !(isHeld(to[0]) && isHeld(to[1]) && isHeld(to[2]));
    };
    struct Count {
        std::size_t triangles = 0;
        Index degenerate = 0;
    };
    std::vector<Count> counts((faceCount + grain - 1) / grain);
    ParallelFor(progress, readingStage, faceCount, grain, [&](std::size_t first, std::size_t last) {
        Index *to = &list.corner[3 * first];
        Count count;
        for (std::size_t f = first; f < last; ++f)
            if (const std::size_t face = faces ? (*faces)[f] : f;
                mesh.IsFace(face) && take(mesh.corner + 3 * face, 3, to)) {
                count.degenerate += to[0] == to[1] || to[1] == to[2] || to[2] == to[0];
                ++count.triangles;
                to += 3;
            }
        counts[first / grain] = count;
    });
    for (std::size_t c = 0; c < counts.size(); ++c) { // close the gaps between the chunks; mostly there are none
        const Index *from = &list.corner[3 * c * grain];
        if (list.count != c * grain)
            std::copy(from, from + 3 * counts[c].triangles, &list.corner[3 * list.count]);
        list.count += counts[c].triangles;
        list.degenerateFaces += counts[c].degenerate;
    }
    for (std::size_t e = 0; e < mesh.edges; ++e)
        list.count += mesh.IsEdge(e) && take(mesh.end + 2 * e, 2, &list.corner[3 * list.count]);
    return list;
}

/// \param items of an adjacency: two an edge \throw BadInput more than 32 bits can number
inline void CheckEdges(std::size_t items) {
    if (items > std::uint32_t(-1))
        throw BadInput("The mesh has more than two thousand million edges; simplify it first.");
}

/// The graph that triangles make of nodes, and what is measured on the way.
struct TriangleGraph {
    Csr adjacency;
    Index nonManifoldEdges = 0;
    Index repeatedFaces = 0; ///< triangles with the same corners as one before them; these count for nothing
    double edgeLengths = 0;  ///< sum over all edges
    std::vector<float> area; ///< of each node: a third of its triangles
    std::vector<char> open;  ///< of each node: whether one of its edges has a single face
};

/// The neighbours of a block's nodes, one node after the other, and what was measured of them.
struct ConnectedBlock {
    std::vector<Index> item;
    Index nonManifoldEdges = 0, repeatedFaces = 0;
    double edgeLengths = 0;
};

/// The triangles of a block without repeated ones: those with the same corners, in any order, as one before them.
/// Degenerate ones stay. \return empty if none is repeated
inline std::vector<TriangleBlocks::Triangle> DistinctTriangles(const TriangleBlocks::Block &in) {
    const auto count = std::size_t(in.end - in.begin);
    std::size_t places = 2;
    while (places < 2 * count)
        places *= 2;
    std::vector<Index> first(places, -1);             // a hash table: the first triangle of those with the same corners
    std::vector<std::array<Index, 3>> corners(count); // ascending
    std::vector<TriangleBlocks::Triangle> distinct;
    distinct.reserve(count);
    for (std::size_t t = 0; t < count; ++t) {
        std::array<Index, 3> &own = corners[t];
        std::copy_n(in.begin[t].corner, 3, own.begin());
        std::sort(own.begin(), own.end());
        bool isNew = true;
        if (own[0] != own[1] && own[1] != own[2]) {
            std::uint64_t h = 0;
            for (Index c : own)
                h = (h ^ h >> 29 ^ std::uint64_t(c)) * 0x9E3779B97F4A7C15u;
            std::size_t at = std::size_t(h >> 20) & (places - 1);
            while (first[at] >= 0 && corners[std::size_t(first[at])] != own)
                at = (at + 1) & (places - 1);
            isNew = first[at] < 0;
            if (isNew)
                first[at] = Index(t);
        }
        if (isNew)
            distinct.push_back(in.begin[t]);
    }
    if (distinct.size() == count)
        distinct.clear();
    return distinct;
}

/// Whether two of the triangles around a node have the same corners.
/// \param entry the other two corners of each triangle; equal ones stand for an edge
inline bool HasRepeated(const TriangleBlocks::Entry *entry, std::size_t triangles) {
    constexpr std::size_t few = 12; // pairs that are compared faster than sorted
    const auto pair = [&](std::size_t i) { return std::minmax(entry[2 * i], entry[2 * i + 1]); };
    if (triangles <= few) {
        for (std::size_t i = 1; i < triangles; ++i)
            for (std::size_t j = 0; j < i; ++j)
                if (pair(i) == pair(j) && entry[2 * i] != entry[2 * i + 1])
                    return true;
        return false;
    }
    std::vector<std::pair<TriangleBlocks::Entry, TriangleBlocks::Entry>> pairs;
    for (std::size_t i = 0; i < triangles; ++i)
        if (entry[2 * i] != entry[2 * i + 1])
            pairs.emplace_back(pair(i));
    std::sort(pairs.begin(), pairs.end());
    return std::adjacent_find(pairs.begin(), pairs.end()) != pairs.end();
}

/// Connects the nodes of a block. Around a node with a closed, evenly oriented fan of triangles, their next corners are
/// each neighbour once. A checksum of next minus previous corners finds the other nodes; for these, both corners are
/// listed. Repeated triangles show in a closed fan as a neighbour that comes next twice, or as a fan of two; around
/// other nodes they are compared.
/// \param graph out: area and open of the block's nodes, and the number of node u's neighbours in adjacency.begin[u +
/// 1] \param isDistinct no triangle is repeated
inline ConnectedBlock ConnectBlock(const Eigen::Matrix3Xf &position, const TriangleBlocks::Block &in,
                                   TriangleGraph &graph, bool isDistinct = false) {
    using Entry = TriangleBlocks::Entry;
    const auto scramble = [](Entry e) {
        std::uint64_t v = (e + 1) * 0x9E3779B97F4A7C15u;
        return (v ^ v >> 29) * 0xBF58476D1CE4E5B9u;
    };
    struct Node {
        std::uint64_t checksum = 0; // 0: closed
        std::uint32_t corners = 0, begin = 0, end = 0;
    };
    std::vector<Node> node(in.last - in.first);
    in.ForCorners([&](Index u, Entry next, Entry previous) {
        node[u].checksum += scramble(next) - scramble(previous);
        ++node[u].corners;
    });
    std::uint32_t entries = 0;
    for (Node &n : node) {
        n.begin = n.end = entries;
        entries += n.checksum ? 2 * n.corners : n.corners;
    }
    std::vector<Entry> entry(entries);
    in.ForCorners([&](Index u, Entry next, Entry previous) {
        entry[node[u].end++] = next;
        if (node[u].checksum)
            entry[node[u].end++] = previous;
    });
    bool mayRepeat = false;
    for (const Node &n : node)
        mayRepeat = mayRepeat || (n.checksum ? HasRepeated(entry.data() + n.begin, n.corners) : n.corners == 2);
    ConnectedBlock block;
    block.item.reserve(entries);
    for (Index u = in.first; u < in.last; ++u) {
        const Node &n = node[u - in.first];
        SortShort(entry.data() + n.begin, entry.data() + n.end);
        const Eigen::Vector3f x = position.col(u);
        const std::size_t size = block.item.size();
        for (std::uint32_t i = n.begin; i < n.end;) {
            const Index v = Index(entry[i] >> 1);
            Index faces = 0;
            for (; i < n.end && Index(entry[i] >> 1) == v; ++i)
                faces += entry[i] & 1;
            block.nonManifoldEdges += u < v && (n.checksum ? faces > 2 : faces > 1);
            mayRepeat |= !n.checksum && faces > 1;
            graph.open[u] |= n.checksum && faces == 1;
            block.item.push_back(v);
            if (u < v)
                block.edgeLengths += (position.col(v) - x).norm();
        }
        graph.adjacency.begin[u + 1] = std::uint32_t(block.item.size() - size);
    }
    if (mayRepeat && !isDistinct)
        if (const std::vector<TriangleBlocks::Triangle> distinct = DistinctTriangles(in); !distinct.empty()) {
            std::fill(graph.open.begin() + in.first, graph.open.begin() + in.last, 0);
            const auto begunHere = [&](const TriangleBlocks::Triangle *first, const TriangleBlocks::Triangle *last) {
                return std::count_if(first, last,
                                     [&](const auto &t) { return in.Has(*std::min_element(t.corner, t.corner + 3)); });
            };
            const TriangleBlocks::Triangle *first = distinct.data(), *last = first + distinct.size();
            block = ConnectBlock(position, {in.first, in.last, first, last}, graph, true);
            block.repeatedFaces = Index(begunHere(in.begin, in.end) - begunHere(first, last));
            return block;
        }
    for (const TriangleBlocks::Triangle *t = in.begin; t < in.end; ++t) {
        const Eigen::Vector3f x = position.col(t->corner[0]);
        const Eigen::Vector3f e = position.col(t->corner[1]) - x, f = position.col(t->corner[2]) - x;
        const float third = e.cross(f).norm() / 6;
        for (Index u : t->corner)
            if (in.Has(u))
                graph.area[u] += third;
    }
    block.item.shrink_to_fit();
    return block;
}

/// The graph of the triangles of a TriangleList, made block by block.
/// \param position 3 x nodes, in Morton order for speed \param corner 3 x triangles nodes
/// \throw BadInput as CheckEdges \throw Cancelled
inline TriangleGraph ConnectTriangles(const Eigen::Matrix3Xf &position, const Index *corner, std::size_t triangles,
                                      const Progress &progress) {
    const Index nodes = Index(position.cols());
    TriangleBlocks in = SortIntoBlocks(nodes, corner, triangles, progress.Slice(0, 0.3));
    const std::size_t blocks = in.Size();
    std::vector<ConnectedBlock> done(blocks);
    TriangleGraph graph;
    AssignLarge(graph.area, std::size_t(nodes), 0.f);
    graph.open.assign(std::size_t(nodes), 0);
    AssignLarge(graph.adjacency.begin, std::size_t(nodes) + 1, 0u);
    ParallelFor(progress.Slice(0.3, 0.9), readingStage, blocks, 1,
                [&](std::size_t b, std::size_t) { done[b] = ConnectBlock(position, in[b], graph); });
    in.triangle.reset();

    // Join the blocks.
    std::vector<std::size_t> itemBegin(blocks + 1, 0);
    for (std::size_t b = 0; b < blocks; ++b) {
        itemBegin[b + 1] = itemBegin[b] + done[b].item.size();
        graph.nonManifoldEdges += done[b].nonManifoldEdges;
        graph.repeatedFaces += done[b].repeatedFaces;
        graph.edgeLengths += done[b].edgeLengths;
    }
    CheckEdges(itemBegin[blocks]);
    graph.adjacency.item = Together(done, &ConnectedBlock::item);
    ParallelFor(progress.Slice(0.9, 1), readingStage, blocks, 1, [&](std::size_t b, std::size_t) {
        std::uint32_t sum = std::uint32_t(itemBegin[b]);
        for (Index u = in.FirstNode(b); u < in.FirstNode(b + 1); ++u)
            graph.adjacency.begin[u + 1] = sum += graph.adjacency.begin[u + 1];
    });
    return graph;
}

} // namespace vcg::fcd::detail

#endif
