// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_GRAPH_H
#define VCG_FCD_SURFACE_GRAPH_H

#include "graph.h"
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

/// Adjacency of \p nodes nodes from triangles (3 corners each; a repeated corner adds nothing). Also counts the edges
/// that more than two triangles share.
///
/// Each node has a record of half a cache line for up to seven neighbours, filled in one pass over the triangles; what
/// does not fit goes to a list that is sorted in afterwards. A triangle gives each corner only the one that comes next:
/// around a node whose triangles form a closed, evenly oriented fan, that is every neighbour once. A checksum of next
/// minus previous corners tells the other nodes, and the edges between those are then entered at both ends.
inline Csr TriangleAdjacency(Index nodes, const Index *corner, std::size_t corners, Index &nonManifoldEdges,
                             const Progress &progress) {
    const char *stage = "Reading the mesh";
    const unsigned threads = progress.threads;
    constexpr std::uint32_t room = 7;
    constexpr Index once = 1 << 29,
                    mask = once - 1; // two spare bits count how often a corner came next: 0 to 3 or more
    if (nodes > mask)
        throw Error("The mesh has more than 500 million vertices; simplify it first.");
    struct Record {
        std::uint32_t head; // 29 bits of checksum, 3 bits: how many neighbours are here
        Index neighbour[room];
        std::uint32_t Size() const { return head & 7; }
        bool IsOpen() const { return head >> 3; }
    };
    struct Extra { // a neighbour for which the record has no room
        Index node, neighbour;
        bool operator<(const Extra &o) const {
            return node != o.node ? node < o.node : (neighbour & mask) < (o.neighbour & mask);
        }
        bool Same(const Extra &o) const { return node == o.node && (neighbour & mask) == (o.neighbour & mask); }
    };
    auto scramble = [](std::uint32_t v) {
        v *= 0x9E3779B1u;
        return (v ^ v >> 15) * 0x85EBCA77u;
    };
    const std::unique_ptr<Record[]> record(
        new Record[nodes]); // not touched before it is used: that would cost a pass over memory
    // Each part owns a range of nodes and reads all triangles: no two parts write to the same place.
    const std::size_t parts =
        std::min<std::size_t>(8, std::max<std::size_t>(1, threads ? threads : std::thread::hardware_concurrency()));
    auto partBegin = [&](std::size_t part) { return Index(std::uint64_t(nodes) * part / parts); };
    std::vector<std::vector<Extra>> extra(parts), reverse(parts);

    auto counted = [](Index entry, Index more) {
        return (entry & mask) | std::min(entry / once + more / once, 3) * once;
    };
    auto add = [&](Index v, Index neighbour, Index count, std::vector<Extra> &list) {
        Record &r = record[v];
        const std::uint32_t size = r.Size();
        for (std::uint32_t i = 0; i < size; ++i)
            if ((r.neighbour[i] & mask) == neighbour) {
                r.neighbour[i] = counted(r.neighbour[i], count);
                return;
            }
        if (size < room) {
            r.neighbour[size] = neighbour | count;
            ++r.head;
        } else
            list.push_back({v, neighbour | count});
    };
    auto sortExtra = [&counted](std::vector<Extra> &list) {
        std::sort(list.begin(), list.end());
        std::size_t kept = 0;
        for (const Extra &e : list) {
            if (kept == 0 || !list[kept - 1].Same(e))
                list[kept++] = e;
            else
                list[kept - 1].neighbour = counted(list[kept - 1].neighbour, e.neighbour);
        }
        list.resize(kept);
    };
    ParallelFor(threads, nodes, 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
            record[v].head = 0;
    });
    const std::size_t block = 3 << 21; // progress is reported between blocks
    for (std::size_t begin = 0; begin < corners; begin += block) {
        progress(0.6 * double(begin) / double(corners), stage);
        ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) {
            const std::uint32_t lo = partBegin(part), width = partBegin(part + 1) - lo;
            for (std::size_t t = begin; t < std::min(corners, begin + block); t += 3) {
                const Index c[5] = {corner[t], corner[t + 1], corner[t + 2], corner[t], corner[t + 1]};
                // Without area it is no face of the edge.
                const Index count = c[0] == c[1] || c[1] == c[2] || c[2] == c[0] ? 0 : once;
                for (int i = 0; i < 3; ++i) {
                    const Index v = c[i], next = c[i + 1], previous = c[i + 2];
                    if (std::uint32_t(v) - lo >= width)
                        continue;
                    record[v].head += (scramble(next) - scramble(previous)) << 3;
                    if (next != v)
                        add(v, next, count, extra[part]);
                }
            }
        });
    }
    progress(0.6, stage);
    ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) { sortExtra(extra[part]); });

    // How often v comes after u.
    auto count = [&](Index u, Index v) {
        const Record &r = record[u];
        for (std::uint32_t i = 0; i < r.Size(); ++i)
            if ((r.neighbour[i] & mask) == v)
                return r.neighbour[i] / once;
        if (r.Size() == room)
            for (std::size_t part = 0; part < parts; ++part)
                if (u < partBegin(part + 1)) {
                    const Extra wanted{u, v};
                    const auto at = std::lower_bound(extra[part].begin(), extra[part].end(), wanted);
                    return at != extra[part].end() && at->Same(wanted) ? at->neighbour / once : 0;
                }
        return 0;
    };
    std::vector<Index> nonManifold(parts, 0);
    ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) {
        auto visit = [&](Index u, Index entry) {
            const Index v = entry & mask, there = entry / once;
            if (!record[u].IsOpen() && there < 2)
                return;
            const Index back = count(v, u);
            if (back == 0)
                reverse[part].push_back({v, u});
            nonManifold[part] += there + back > 2 && (u < v || back == 0);
        };
        for (Index u = partBegin(part); u < partBegin(part + 1); ++u)
            for (std::uint32_t i = 0; i < record[u].Size(); ++i)
                visit(u, record[u].neighbour[i]);
        for (const Extra &e : extra[part])
            visit(e.node, e.neighbour);
    });
    progress(0.7, stage);
    for (Index n : nonManifold)
        nonManifoldEdges += n;

    Csr adjacency;
    adjacency.begin.assign(std::size_t(nodes) + 1, 0);
    ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) {
        for (const std::vector<Extra> &list : reverse)
            for (const Extra &e : list)
                if (e.node >= partBegin(part) && e.node < partBegin(part + 1))
                    add(e.node, e.neighbour, 0, extra[part]);
        sortExtra(extra[part]);
        for (const Extra &e : extra[part])
            ++adjacency.begin[e.node + 1];
        for (Index v = partBegin(part); v < partBegin(part + 1); ++v)
            adjacency.begin[v + 1] += record[v].Size();
    });
    std::uint64_t total = 0;
    for (Index v = 0; v < nodes; ++v) {
        total += adjacency.begin[v + 1];
        if (total > std::uint32_t(-1))
            throw Error("The mesh has more than two thousand million edges; simplify it first.");
        adjacency.begin[v + 1] = std::uint32_t(total);
    }
    progress(0.8, stage);
    adjacency.item.resize(total);
    ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) {
        const Extra *more = extra[part].data(), *moreEnd = more + extra[part].size();
        for (Index v = partBegin(part); v < partBegin(part + 1); ++v) {
            Index *row = adjacency.item.data() + adjacency.begin[v], *end = row;
            for (std::uint32_t i = 0; i < record[v].Size(); ++i) { // insertion sort
                const Index neighbour = record[v].neighbour[i] & mask;
                Index *at = end++;
                for (; at > row && at[-1] > neighbour; --at)
                    *at = at[-1];
                *at = neighbour;
            }
            Index *middle = end;
            for (; more < moreEnd && more->node == v; ++more)
                *end++ = more->neighbour & mask;
            if (end > middle)
                std::inplace_merge(row, middle, end);
        }
    });
    return adjacency;
}

/// Triangles with a repeated corner that join each point with its \p k nearest ones. \param corners their number, out
inline std::unique_ptr<Index[]> NearestNeighbourPairs(const Eigen::Matrix3Xf &position, int k, std::size_t &corners,
                                                      const Progress &progress) {
    const Index n = Index(position.cols());
    std::vector<vcg::Point3f> point(n);
    for (Index i = 0; i < n; ++i)
        point[i] = vcg::Point3f(position(0, i), position(1, i), position(2, i));
    vcg::ConstDataWrapper<vcg::Point3f> wrapper(point.data(), n);
    vcg::KdTree<float> tree(wrapper);
    const int wanted = std::min<int>(k, n - 1);
    corners = std::size_t(n) * wanted * 3;
    std::unique_ptr<Index[]> corner(new Index[corners]);
    const std::size_t block = 1 << 17; // progress is reported between blocks
    for (std::size_t start = 0; start < std::size_t(n); start += block) {
        progress(double(start) / n, "Finding neighbours");
        ParallelFor(progress.threads, std::min<std::size_t>(block, n - start), 1 << 12,
                    [&](std::size_t first, std::size_t last) {
                        vcg::KdTree<float>::PriorityQueue queue;
                        for (std::size_t i = start + first; i < start + last; ++i) {
                            tree.doQueryK(point[i], wanted + 1, queue);
                            std::vector<Index> found;
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
    }
    return corner;
}

/// Sum of \p term(i) over [0, n) in an order that does not depend on the number of threads.
template <class Term>
double OrderedSum(unsigned threads, std::size_t n, const Term &term) {
    const std::size_t grain = 1 << 14;
    std::vector<double> partial((n + grain - 1) / grain, 0);
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i)
            sum += term(i);
        partial[first / grain] = sum;
    });
    double sum = 0;
    for (double p : partial)
        sum += p;
    return sum;
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
    const unsigned threads = progress.threads;
    fcd::SurfaceGraph s;
    progress(0, stage);

    // Bounding box of the live vertices.
    struct Part {
        Eigen::AlignedBox3d box;
        std::size_t live = 0, bad = std::size_t(-1);
    };
    std::vector<Part> part((slotCount + grain - 1) / grain);
    ParallelFor(threads, slotCount, grain, [&](std::size_t first, std::size_t last) {
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
    int exponent = 0;
    if (halfDiagonal > 0)
        std::frexp(halfDiagonal, &exponent); // halfDiagonal in [0.5, 1) * 2^exponent
    s.frame.scale = halfDiagonal > 0 ? std::ldexp(1.0, exponent + 1) : 1;
    s.diagonal = halfDiagonal / s.frame.scale * 2;
    s.report.vertices = Index(total.live);

    // Morton order. (Arrays as large as the mesh are not initialised: that would cost a pass over memory each.)
    std::unique_ptr<std::uint64_t[]> order(new std::uint64_t[slotCount]);
    Eigen::Matrix3Xf bySlot(3, slotCount);
    ParallelFor(threads, slotCount, grain, [&](std::size_t first, std::size_t last) {
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
    progress(0.1, stage);
    fcd::detail::RadixSortUpper30(order, total.live, threads);
    progress(0.25, stage);

    // Vertices at one position share a node. Such vertices have the same code, so ranges that end with a code are
    // independent.
    auto slotAt = [&](std::size_t i) { return std::uint32_t(order[i]); };
    auto samePlace = [&](std::size_t i, std::size_t j) { return bySlot.col(slotAt(i)) == bySlot.col(slotAt(j)); };
    auto before = [&](std::uint64_t a, std::uint64_t b) {
        const std::uint32_t u = std::uint32_t(a), v = std::uint32_t(b);
        for (int d = 0; d < 3; ++d)
            if (bySlot(d, u) != bySlot(d, v))
                return bySlot(d, u) < bySlot(d, v);
        return u < v;
    };
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
    ParallelFor(threads, ranges, 1, [&](std::size_t range, std::size_t) {
        Index found = 0;
        for (std::size_t i = rangeBegin[range], next; i < rangeBegin[range + 1]; i = next) {
            for (next = i + 1; next < rangeBegin[range + 1] && order[next] >> 32 == order[i] >> 32;)
                ++next;
            if (next - i > 1)
                std::sort(order.get() + i, order.get() + next, before);
            ++found;
            for (std::size_t j = i + 1; j < next; ++j)
                found += !samePlace(j - 1, j);
        }
        firstNode[range + 1] = found;
    });
    for (std::size_t range = 0; range < ranges; ++range)
        firstNode[range + 1] += firstNode[range];
    const Index nodes = firstNode[ranges];
    s.report.welded = Index(total.live) - nodes;
    s.nodeOf.assign(slotCount, -1);
    s.graph.position.resize(3, nodes);
    ParallelFor(threads, ranges, 1, [&](std::size_t range, std::size_t) {
        Index node = firstNode[range] - 1;
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i) {
            if (i == rangeBegin[range] || !samePlace(i - 1, i))
                s.graph.position.col(++node) = bySlot.col(slotAt(i));
            s.nodeOf[slotAt(i)] = node;
        }
    });
    order.reset();
    bySlot.resize(3, 0);
    progress(0.4, stage);

    // Faces and edge elements as corners; those that are deleted as three times the same.
    const std::size_t faces = m.face.size(), edges = m.edge.size();
    std::size_t corners = (faces + edges) * 3;
    std::unique_ptr<Index[]> corner(new Index[corners]);
    std::vector<Index> degenerate((faces + grain - 1) / grain, 0);
    auto nodeAt = [&](const auto *vertex) { return s.nodeOf[vertex - &m.vert[0]]; };
    ParallelFor(threads, faces, grain, [&](std::size_t first, std::size_t last) {
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
        corner = fcd::detail::NearestNeighbourPairs(s.graph.position, 8, corners, progress.Slice(0.4, 0.5));
    Index nonManifold = 0;
    s.graph.adjacency =
        fcd::detail::TriangleAdjacency(nodes, corner.get(), corners, nonManifold, progress.Slice(0.5, 0.9));
    s.report.nonManifoldEdges = s.report.pointCloud ? 0 : nonManifold;
    progress(0.9, stage);

    // Measures.
    const Eigen::Matrix3Xf &x = s.graph.position;
    const fcd::Csr &adjacency = s.graph.adjacency;
    const double lengths = fcd::detail::OrderedSum(threads, nodes, [&](std::size_t u) {
        double sum = 0;
        for (Index v : adjacency[Index(u)])
            sum += (x.col(v) - x.col(u)).norm();
        return sum;
    });
    s.averageEdge = adjacency.item.empty() ? 0 : lengths / double(adjacency.item.size());
    s.area = s.report.pointCloud ? std::sqrt(0.75) * s.averageEdge * s.averageEdge * nodes // as if evenly triangulated
                                 : fcd::detail::OrderedSum(threads, faces, [&](std::size_t f) {
                                       const Eigen::Vector3f a = x.col(corner[3 * f]), b = x.col(corner[3 * f + 1]),
                                                             c = x.col(corner[3 * f + 2]);
                                       return 0.5 * double((b - a).cross(c - a).norm());
                                   });
    for (Index i = 0; i < nodes; ++i)
        s.report.isolated += adjacency[i].size() == 0;
    progress(1, stage);
    return s;
}

} // namespace tri
} // namespace vcg

#endif
