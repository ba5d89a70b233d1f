// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_GRAPH_H
#define VCG_FCD_SURFACE_GRAPH_H

#include "graph.h"
#include "memory.h"
#include "morton.h"
#include "progress.h"

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <string>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace fcd {

/// The unit frame in which everything is computed: origin at the centre of the bounding box, the box's diagonal in
/// (0.5, 1]. The scale is a power of two, so that going there and back costs no bits.
struct Frame {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< in mesh units
    double scale = 1;                                 ///< mesh units per frame unit

    Eigen::Vector3d ToFrame(const Eigen::Vector3d &p) const { return (p - origin) / scale; }
    Eigen::Vector3d FromFrame(const Eigen::Vector3d &p) const { return p * scale + origin; }

    /// An affine motion in mesh units (4 x 4), expressed in the frame.
    Eigen::Affine3d ToFrame(const Eigen::Matrix4d &motion) const {
        Eigen::Affine3d m(motion);
        m.translation() = (m.linear() * origin + m.translation() - origin) / scale;
        return m;
    }
};

/// What was met in a mesh.
struct SurfaceReport {
    Index vertices = 0;         ///< live vertices
    Index welded = 0;           ///< vertices that share the position of another one and hence its node
    Index isolated = 0;         ///< nodes without a neighbour
    Index components = 0;       ///< connected components, isolated nodes included
    Index nonManifoldEdges = 0; ///< edges of more than two faces
    Index degenerateFaces = 0;  ///< faces with a repeated position
    bool pointCloud = false;    ///< no faces, no edges: neighbours are the nearest points
};

/// The connectivity of a mesh: a node per position, in Morton order, so that what is near on the surface is near in
/// memory.
struct SurfaceGraph {
    Graph graph;               ///< n nodes, positions in the frame
    Frame frame;               ///< from mesh units
    std::vector<Index> nodeOf; ///< node of each vertex slot, -1 for a deleted vertex
    double area = 0;           ///< of the surface, frame units^2
    double averageEdge = 0;    ///< mean length of the graph's edges, frame units
    double diagonal = 0;       ///< of the bounding box, frame units
    SurfaceReport report;      ///< components is left 0
};

namespace detail {

/// std::sort, fast for the few items that most lists here have.
template <class T>
void SortShort(T *first, T *last) {
    if (last - first > 32) {
        std::sort(first, last);
        return;
    }
    for (T *i = first; i < last; ++i) {
        const T item = *i;
        T *at = i;
        for (; at > first && item < at[-1]; --at)
            *at = at[-1];
        *at = item;
    }
}

/// A graph of triangles, and what is measured on the way.
struct TriangleGraph {
    Csr adjacency;
    Index nonManifoldEdges = 0;
    double edgeLengths = 0; ///< sum over all edges
    double area = 0;
};

/// Joins the corners of triangles (3 x triangles nodes). A triangle with a repeated corner counts as the edge that is
/// left of it, and one with three equal corners not at all.
///
/// The nodes are cut into blocks that fit the cache, and each block gets a copy of the triangles that have a corner in
/// it. Around a node whose triangles form a closed, evenly oriented fan, the corners that come next are every neighbour
/// once; a checksum of next minus previous corners tells the other nodes, for which both are taken.
/// \pre neighbours have numbers that are close (Morton order), for speed
inline TriangleGraph ConnectTriangles(const Eigen::Matrix3Xf &position, const Index *corner, std::size_t triangles,
                                      const Progress &progress) {
    const char *stage = "Reading the mesh";
    const Index nodes = Index(position.cols());
    const std::size_t grain = 1 << 15, chunks = (triangles + grain - 1) / grain;
    int shift = 12;
    while ((nodes - 1) >> shift >= 1024)
        ++shift;
    const std::size_t blocks = (std::size_t(nodes - 1) >> shift) + 1;
    auto forBlocksOf = [shift](const Index *c, const auto &body) {
        const Index a = c[0] >> shift, b = c[1] >> shift, d = c[2] >> shift;
        if (c[0] == c[1] && c[1] == c[2])
            return;
        body(a);
        if (b != a)
            body(b);
        if (d != a && d != b)
            body(d);
    };

    // Triangles by block: count, prefix sum, fill.
    std::vector<std::size_t> at(chunks * blocks, 0); // of each chunk's triangles in each block
    ParallelFor(progress.Slice(0, 0.1), stage, triangles, grain, [&](std::size_t first, std::size_t last) {
        std::size_t *count = &at[first / grain * blocks];
        for (std::size_t t = first; t < last; ++t)
            forBlocksOf(corner + 3 * t, [&](Index block) { ++count[block]; });
    });
    std::vector<std::size_t> blockBegin(blocks + 1, 0);
    for (std::size_t b = 0, sum = 0; b < blocks; ++b) {
        for (std::size_t c = 0; c < chunks; ++c) {
            const std::size_t here = at[c * blocks + b];
            at[c * blocks + b] = sum;
            sum += here;
        }
        blockBegin[b + 1] = sum;
    }
    struct Triangle {
        Index corner[3];
    };
    std::unique_ptr<Triangle[]> triangle = LargeArray<Triangle>(blockBegin[blocks]);
    ParallelFor(progress.Slice(0.1, 0.3), stage, triangles, grain, [&](std::size_t first, std::size_t last) {
        std::size_t *next = &at[first / grain * blocks];
        for (std::size_t t = first; t < last; ++t) {
            const Index *c = corner + 3 * t;
            forBlocksOf(c, [&](Index block) { triangle[next[block]++] = {{c[0], c[1], c[2]}}; });
        }
    });

    // Blocks.
    struct Block {
        std::vector<Index> item;
        Index nonManifoldEdges = 0;
        double edgeLengths = 0, area = 0;
    };
    std::vector<Block> done(blocks);
    TriangleGraph result;
    AssignLarge(result.adjacency.begin, std::size_t(nodes) + 1, 0u);
    using Entry = std::uint32_t; // a neighbour and, in the lowest bit, whether a face is what joins it
    auto scramble = [](Entry e) {
        std::uint64_t v = (e + 1) * 0x9E3779B97F4A7C15u;
        return (v ^ v >> 29) * 0xBF58476D1CE4E5B9u;
    };
    ParallelFor(progress.Slice(0.3, 0.9), stage, blocks, 1, [&](std::size_t b, std::size_t) {
        const Index first = Index(b << shift), last = std::min(nodes, Index((b + 1) << shift));
        const Triangle *begin = triangle.get() + blockBegin[b], *end = triangle.get() + blockBegin[b + 1];
        // body(node, next, previous) for every corner in this block
        auto forCorners = [&](const auto &body) {
            for (const Triangle *t = begin; t < end; ++t) {
                const Index *c = t->corner;
                if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) {
                    for (int i = 0, next = 1, previous = 2; i < 3; previous = i++, next = next == 2 ? 0 : next + 1)
                        if (c[i] >= first && c[i] < last)
                            body(c[i] - first, Entry(c[next]) << 1 | 1, Entry(c[previous]) << 1 | 1);
                } else { // the edge between its two different corners
                    const Index u = c[0], v = c[0] == c[1] ? c[2] : c[1];
                    if (u >= first && u < last)
                        body(u - first, Entry(v) << 1, Entry(v) << 1);
                    if (v >= first && v < last)
                        body(v - first, Entry(u) << 1, Entry(u) << 1);
                }
            }
        };
        struct Node {
            std::uint64_t checksum = 0; // 0: closed
            std::uint32_t corners = 0, begin = 0, end = 0;
        };
        std::vector<Node> node(last - first);
        forCorners([&](Index u, Entry next, Entry previous) {
            node[u].checksum += scramble(next) - scramble(previous);
            ++node[u].corners;
        });
        std::uint32_t entries = 0;
        for (Node &n : node) {
            n.begin = n.end = entries;
            entries += n.checksum ? 2 * n.corners : n.corners;
        }
        std::vector<Entry> entry(entries);
        forCorners([&](Index u, Entry next, Entry previous) {
            entry[node[u].end++] = next;
            if (node[u].checksum)
                entry[node[u].end++] = previous;
        });
        Block &block = done[b];
        block.item.reserve(entries);
        for (Index u = first; u < last; ++u) {
            const Node &n = node[u - first];
            SortShort(entry.data() + n.begin, entry.data() + n.end);
            const Eigen::Vector3f x = position.col(u);
            const std::size_t size = block.item.size();
            for (std::uint32_t i = n.begin; i < n.end;) {
                const Index v = Index(entry[i] >> 1);
                Index faces = 0;
                for (; i < n.end && Index(entry[i] >> 1) == v; ++i)
                    faces += entry[i] & 1;
                block.nonManifoldEdges += u < v && (n.checksum ? faces > 2 : faces > 1);
                block.item.push_back(v);
                if (u < v)
                    block.edgeLengths += (position.col(v) - x).norm();
            }
            result.adjacency.begin[u + 1] = std::uint32_t(block.item.size() - size);
        }
        for (const Triangle *t = begin; t < end; ++t)
            if (t->corner[0] >= first && t->corner[0] < last) {
                const Eigen::Vector3f x = position.col(t->corner[0]);
                const Eigen::Vector3f e = position.col(t->corner[1]) - x, f = position.col(t->corner[2]) - x;
                block.area += 0.5 * double(e.cross(f).norm());
            }
        block.item.shrink_to_fit();
    });
    triangle.reset();

    // All of it in one.
    std::vector<std::size_t> itemBegin(blocks + 1, 0);
    for (std::size_t b = 0; b < blocks; ++b) {
        itemBegin[b + 1] = itemBegin[b] + done[b].item.size();
        result.nonManifoldEdges += done[b].nonManifoldEdges;
        result.edgeLengths += done[b].edgeLengths;
        result.area += done[b].area;
    }
    if (itemBegin[blocks] > std::uint32_t(-1))
        throw Error("The mesh has more than two thousand million edges; simplify it first.");
    AssignLarge(result.adjacency.item, itemBegin[blocks], 0);
    ParallelFor(progress.Slice(0.9, 1), stage, blocks, 1, [&](std::size_t b, std::size_t) {
        std::copy(done[b].item.begin(), done[b].item.end(), result.adjacency.item.begin() + itemBegin[b]);
        done[b].item = {};
        std::uint32_t sum = std::uint32_t(itemBegin[b]);
        for (Index u = Index(b << shift); u < std::min(nodes, Index((b + 1) << shift)); ++u)
            result.adjacency.begin[u + 1] = sum += result.adjacency.begin[u + 1];
    });
    return result;
}

/// Triangles with a repeated corner that join each point with its \p k nearest ones. \param triangles their number, out
inline std::unique_ptr<Index[]> NearestNeighbourPairs(const Eigen::Matrix3Xf &position, int k, std::size_t &triangles,
                                                      const Progress &progress) {
    const Index n = Index(position.cols());
    std::vector<vcg::Point3f> point(n);
    for (Index i = 0; i < n; ++i)
        point[i] = vcg::Point3f(position(0, i), position(1, i), position(2, i));
    vcg::ConstDataWrapper<vcg::Point3f> wrapper(point.data(), n);
    vcg::KdTree<float> tree(wrapper);
    const int wanted = std::min<int>(k, n - 1);
    triangles = std::size_t(n) * wanted;
    std::unique_ptr<Index[]> corner = LargeArray<Index>(3 * triangles);
    ParallelFor(progress, "Finding neighbours", n, 1 << 12, [&](std::size_t first, std::size_t last) {
        vcg::KdTree<float>::PriorityQueue queue;
        std::vector<Index> found;
        for (std::size_t i = first; i < last; ++i) {
            tree.doQueryK(point[i], wanted + 1, queue);
            found.clear();
            for (int j = 0; j < queue.getNofElements(); ++j)
                if (queue.getIndex(j) != int(i))
                    found.push_back(queue.getIndex(j));
            std::sort(found.begin(), found.end());
            Index *at = corner.get() + i * wanted * 3;
            for (int j = 0; j < wanted; ++j, at += 3) {
                at[0] = Index(i);
                at[1] = at[2] = j < int(found.size()) ? found[j] : Index(i);
            }
        }
    });
    return corner;
}

} // namespace detail
} // namespace fcd

namespace tri {

template <class VertexType>
Eigen::Vector3d PositionOf(const VertexType &v) {
    return Eigen::Vector3d(v.cP()[0], v.cP()[1], v.cP()[2]);
}

/// Reads the connectivity of a mesh. Neighbours are the vertices that share a face or an edge element; in a mesh that
/// has neither, the 8 nearest points. Vertices at the same position (float precision of the frame) share a node, so
/// that unwelded seams hold together. Deleted elements are skipped; the mesh is only read.
///
/// \throw fcd::Error no vertices, or a coordinate that is not finite
template <class MeshType>
fcd::SurfaceGraph BuildSurfaceGraph(const MeshType &m, const fcd::Progress &progress = {}) {
    using fcd::Index;
    using fcd::ParallelFor;
    const char *stage = "Reading the mesh";
    const std::size_t slotCount = m.vert.size(), grain = 1 << 16;
    fcd::SurfaceGraph s;
    progress(0, stage);

    // Bounding box of the live vertices.
    struct Part {
        Eigen::AlignedBox3d box;
        std::size_t live = 0, bad = std::size_t(-1);
    };
    std::vector<Part> part((slotCount + grain - 1) / grain);
    ParallelFor(progress.Slice(0, 0.05), stage, slotCount, grain, [&](std::size_t first, std::size_t last) {
        Part p;
        for (std::size_t i = first; i < last; ++i) {
            if (m.vert[i].IsD())
                continue;
            const Eigen::Vector3d x = PositionOf(m.vert[i]);
            if (!x.allFinite())
                p.bad = std::min(p.bad, i);
            p.box.extend(x);
            ++p.live;
        }
        part[first / grain] = p;
    });
    Part total;
    for (const Part &p : part) {
        total.box.extend(p.box);
        total.live += p.live;
        total.bad = std::min(total.bad, p.bad);
    }
    if (total.live == 0)
        throw fcd::Error("The mesh has no vertices.");
    if (total.bad != std::size_t(-1))
        throw fcd::Error("Vertex " + std::to_string(total.bad) +
                         " has a coordinate that is not a finite number; remove such vertices first.");
    const Eigen::Vector3d extent = total.box.max() * 0.5 - total.box.min() * 0.5; // half of it: no overflow
    const double halfDiagonal = extent.stableNorm();
    s.frame.origin = total.box.min() * 0.5 + total.box.max() * 0.5;
    s.frame.scale = halfDiagonal > 0 ? std::min(2 * halfDiagonal, std::numeric_limits<double>::max()) : 1;
    s.diagonal = halfDiagonal / s.frame.scale * 2;
    s.report.vertices = Index(total.live);

    // Morton order.
    std::unique_ptr<std::uint64_t[]> order = fcd::LargeArray<std::uint64_t>(slotCount);
    Eigen::Matrix3Xf bySlot(3, slotCount);
    fcd::PreferLargePages(bySlot.data(), slotCount * sizeof(Eigen::Vector3f));
    ParallelFor(progress.Slice(0.05, 0.1), stage, slotCount, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            std::uint64_t code = 0;
            if (!m.vert[i].IsD()) {
                bySlot.col(i) = s.frame.ToFrame(PositionOf(m.vert[i])).template cast<float>();
                bySlot.col(i).array() += 0.f; // no negative zero: equal positions have equal bits
                code = fcd::detail::MortonCode(bySlot(0, i), bySlot(1, i), bySlot(2, i));
            }
            order[i] = code << 32 | i;
        }
    });
    if (total.live < slotCount)
        std::remove_if(order.get(), order.get() + slotCount,
                       [&](std::uint64_t o) { return m.vert[std::uint32_t(o)].IsD(); });
    fcd::detail::RadixSortUpper30(order, total.live, progress.Slice(0.1, 0.2), stage);

    // Vertices at one position share a node. Such vertices have the same code, so ranges that end with a code are
    // independent.
    auto slotAt = [&](std::size_t i) { return std::uint32_t(order[i]); };
    auto codeEnd = [&](std::size_t i) { // the first position from i on where a code begins
        while (i > 0 && i < total.live && order[i] >> 32 == order[i - 1] >> 32)
            ++i;
        return std::min(i, total.live);
    };
    std::vector<std::size_t> rangeBegin;
    for (std::size_t i = 0; i < total.live; i = codeEnd(i + grain))
        rangeBegin.push_back(i);
    const std::size_t ranges = rangeBegin.size();
    rangeBegin.push_back(total.live);
    std::vector<Index> firstNode(ranges + 1, 0);
    Eigen::Matrix3Xf &x = s.graph.position;
    x.resize(3, total.live);
    fcd::PreferLargePages(x.data(), total.live * sizeof(Eigen::Vector3f));
    ParallelFor(progress.Slice(0.2, 0.3), stage, ranges, 1, [&](std::size_t range, std::size_t) {
        struct Item {
            float p[3];
            std::uint32_t slot;
            bool operator<(const Item &o) const {
                for (int d = 0; d < 3; ++d)
                    if (p[d] != o.p[d])
                        return p[d] < o.p[d];
                return slot < o.slot;
            }
        };
        std::vector<Item> sameCode;
        Index found = 0;
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i)
            x.col(i) = bySlot.col(slotAt(i));
        for (std::size_t i = rangeBegin[range], next; i < rangeBegin[range + 1]; i = next) {
            const std::uint64_t code = order[i] >> 32;
            for (next = i + 1; next < rangeBegin[range + 1] && order[next] >> 32 == code;)
                ++next;
            ++found;
            if (next - i == 1)
                continue;
            sameCode.clear();
            for (std::size_t j = i; j < next; ++j)
                sameCode.push_back({{x(0, j), x(1, j), x(2, j)}, slotAt(j)});
            fcd::detail::SortShort(sameCode.data(), sameCode.data() + sameCode.size());
            for (std::size_t j = i; j < next; ++j) {
                const Item &item = sameCode[j - i];
                x.col(j) << item.p[0], item.p[1], item.p[2];
                order[j] = code << 32 | item.slot;
                found += j > i && x.col(j) != x.col(j - 1);
            }
        }
        firstNode[range + 1] = found;
    });
    for (std::size_t range = 0; range < ranges; ++range)
        firstNode[range + 1] += firstNode[range];
    const Index nodes = firstNode[ranges];
    s.report.welded = Index(total.live) - nodes;
    fcd::AssignLarge(s.nodeOf, slotCount, Index(-1));
    bySlot.resize(3, 0); // first: Eigen's resize frees the old memory twice where it gets no new one
    if (s.report.welded)
        bySlot.resize(3, nodes);
    ParallelFor(progress.Slice(0.3, 0.4), stage, ranges, 1, [&](std::size_t range, std::size_t) {
        Index node = firstNode[range] - 1;
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i) {
            if (i == rangeBegin[range] || x.col(i) != x.col(i - 1)) {
                ++node;
                if (s.report.welded)
                    bySlot.col(node) = x.col(i);
            }
            s.nodeOf[slotAt(i)] = node;
        }
    });
    if (s.report.welded)
        x.swap(bySlot);
    order.reset();
    bySlot.resize(3, 0);

    // Faces and edge elements as corners; those that are deleted as three times the same.
    const std::size_t faces = m.face.size(), edges = m.edge.size();
    std::size_t triangles = faces + edges;
    std::unique_ptr<Index[]> corner = fcd::LargeArray<Index>(3 * triangles);
    std::vector<Index> degenerate((faces + grain - 1) / grain, 0);
    auto nodeAt = [&](const auto *vertex) { return s.nodeOf[vertex - &m.vert[0]]; };
    ParallelFor(progress.Slice(0.4, 0.5), stage, faces, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            Index *c = &corner[3 * f];
            c[0] = -1;
            if (!m.face[f].IsD())
                for (int j = 0; j < 3; ++j)
                    c[j] = nodeAt(m.face[f].cV(j));
            if (c[0] < 0 || c[1] < 0 || c[2] < 0) // a deleted face, or one of a deleted vertex
                c[0] = c[1] = c[2] = 0;
            else
                degenerate[first / grain] += c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
        }
    });
    for (std::size_t e = 0; e < edges; ++e) {
        Index *c = &corner[3 * (faces + e)];
        c[0] = m.edge[e].IsD() ? -1 : nodeAt(m.edge[e].cV(0));
        c[1] = c[2] = m.edge[e].IsD() ? -1 : nodeAt(m.edge[e].cV(1));
        if (c[0] < 0 || c[1] < 0)
            c[0] = c[1] = c[2] = 0;
    }
    for (Index d : degenerate)
        s.report.degenerateFaces += d;
    s.report.pointCloud = m.fn == 0 && m.en == 0;
    if (s.report.pointCloud)
        corner = fcd::detail::NearestNeighbourPairs(x, 8, triangles, progress.Slice(0.4, 0.5));
    fcd::detail::TriangleGraph connected =
        fcd::detail::ConnectTriangles(x, corner.get(), triangles, progress.Slice(0.5, 1));
    s.graph.adjacency = std::move(connected.adjacency);
    s.report.nonManifoldEdges = connected.nonManifoldEdges;
    const std::size_t items = s.graph.adjacency.item.size();
    s.averageEdge = items ? 2 * connected.edgeLengths / double(items) : 0;
    s.area = s.report.pointCloud ? std::sqrt(0.75) * s.averageEdge * s.averageEdge * nodes // as if evenly triangulated
                                 : connected.area;
    for (Index i = 0; i < nodes; ++i)
        s.report.isolated += s.graph.adjacency[i].size() == 0;
    progress(1, stage);
    return s;
}

} // namespace tri
} // namespace vcg

#endif
