// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_GRAPH_H
#define VCG_FCD_SURFACE_GRAPH_H

#include "graph.h"
#include "memory.h"
#include "morton.h"
#include "progress.h"
#include "seams.h"

#include <Eigen/Geometry>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <string>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace fcd {

/// The unit frame in which everything is computed: origin at the centre of the bounding box of what is read, the box's
/// diagonal 1. A few points far outside of all others do not widen the box.
struct Frame {
    /// From mesh units to world units: the linear part of a layer's matrix. Lengths are measured in the world, so that
    /// a mesh bends as it would with the matrix applied to it.
    Eigen::Matrix3d metric = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d inverseMetric = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< in world units, without the matrix's translation
    double scale = 1;                                 ///< world units per frame unit

    /// \throw Error where \p linear has no inverse
    void SetMetric(const Eigen::Matrix3d &linear) {
        metric = linear;
        inverseMetric = linear.inverse();
        if (!linear.allFinite() || !inverseMetric.allFinite())
            throw Error("The matrix of the layer flattens it or is not finite; apply or reset the matrix first.");
    }
    Eigen::Vector3d ToWorld(const Eigen::Vector3d &p) const { return metric.isIdentity(0) ? p : metric * p; }
    Eigen::Vector3d ToFrame(const Eigen::Vector3d &p) const { return (ToWorld(p) - origin) / scale; }
    Eigen::Vector3d FromFrame(const Eigen::Vector3d &p) const {
        const Eigen::Vector3d world = p * scale + origin;
        return metric.isIdentity(0) ? world : inverseMetric * world;
    }

    /// An affine motion in mesh units (4 x 4), expressed in the frame.
    Eigen::Affine3d ToFrame(const Eigen::Matrix4d &motion) const {
        Eigen::Affine3d m(motion);
        m.linear() = metric * m.linear() * inverseMetric;
        m.translation() = (m.linear() * origin + metric * m.translation() - origin) / scale;
        return m;
    }
    /// The way back.
    Eigen::Matrix4d FromFrame(const Eigen::Affine3d &motion) const {
        Eigen::Affine3d m(motion);
        m.translation() = inverseMetric * (motion.translation() * scale + origin - motion.linear() * origin);
        m.linear() = inverseMetric * motion.linear() * metric;
        return m.matrix();
    }
};

/// Vertices on open borders at most so far apart are one, frame units: what rounding to single precision moves by (1e-7
/// of the coordinates), some times over, and a hundredth of what lies between the vertices of the largest scans.
constexpr double defaultWeldDistance = 1e-6;

/// What was met in the part of a mesh that was read.
struct SurfaceReport {
    Index vertices = 0;         ///< live vertices
    Index welded = 0;           ///< vertices that share the position of another one and hence its node
    Index isolated = 0;         ///< nodes without a neighbour
    Index components = 0;       ///< connected components, isolated nodes included
    Index nonManifoldEdges = 0; ///< edges of more than two faces
    Index degenerateFaces = 0;  ///< faces with a repeated position
    Index seams = 0;            ///< nodes on open borders that are joined with one of another, a hair apart
    Index gaps = 0;             ///< nodes on open borders nearer to another than a tenth of their edges, not joined
    bool pointCloud = false;    ///< no faces, no edges: neighbours are the nearest points
};

/// The connectivity of a mesh, or of its free part and the held vertices beside that: a node per position, in Morton
/// order, so that what is near on the surface is near in memory.
struct SurfaceGraph {
    Graph graph;                      ///< n nodes, positions in the frame
    Frame frame;                      ///< from mesh units
    std::vector<Index> nodeOf;        ///< node of each vertex slot, -1 for one that is deleted or not part of it
    std::vector<std::uint32_t> slots; ///< the slots that have a node (some may have lost it), in an order in which
                                      ///< neighbours are close
    std::vector<std::uint32_t> faces; ///< of the mesh: those with a free vertex; empty where no tags were given
    std::vector<std::array<std::uint32_t, 2>> apart; ///< slots at the ends of edges that join vertices held otherwise
    std::vector<Index> tag;      ///< n: 0 fixed or outside, 1 free, from 2 handles; empty where no tags were given
    std::vector<float> nodeArea; ///< n, of the surface around each node, frame units^2
    double area = 0;             ///< sum of nodeArea
    double averageEdge = 0;      ///< mean length of the graph's edges, frame units
    double diagonal = 0;         ///< of the bounding box, frame units; 0 for a single position
    SurfaceReport report;        ///< components is left 0

    bool IsHeld(Index u) const { return !tag.empty() && tag[u] != 1; }
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
    double edgeLengths = 0;  ///< sum over all edges
    std::vector<float> area; ///< of each node: a third of its triangles
    std::vector<char> open;  ///< of each node: whether one of its edges has a single face
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
        double edgeLengths = 0;
    };
    std::vector<Block> done(blocks);
    TriangleGraph result;
    AssignLarge(result.area, std::size_t(nodes), 0.f);
    result.open.assign(std::size_t(nodes), 0);
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
                result.open[u] |= n.checksum && faces == 1;
                block.item.push_back(v);
                if (u < v)
                    block.edgeLengths += (position.col(v) - x).norm();
            }
            result.adjacency.begin[u + 1] = std::uint32_t(block.item.size() - size);
        }
        for (const Triangle *t = begin; t < end; ++t) {
            const Eigen::Vector3f x = position.col(t->corner[0]);
            const Eigen::Vector3f e = position.col(t->corner[1]) - x, f = position.col(t->corner[2]) - x;
            const float third = e.cross(f).norm() / 6;
            for (Index u : t->corner)
                if (u >= first && u < last)
                    result.area[u] += third;
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

/// How many of the nearest points are a point's neighbours: twice a triangulation's six, so that those of the Delaunay
/// triangulation are among them where one direction is sampled two or three times as densely as the other.
constexpr int cloudNeighbours = 12;

/// The area that each point of a cloud stands for: that of a point of an evenly random set of the density around it,
/// where the k-th nearest of the others is at k / (pi density) squared on average. Held points, of whose neighbours
/// only those beside free ones are known, have none. \param tag as of SurfaceGraph
inline void CloudAreas(const Graph &graph, const std::vector<Index> &tag, unsigned threads, std::vector<float> &area) {
    ParallelFor(threads, graph.Size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        std::vector<float> squares;
        for (std::size_t u = first; u < last; ++u) {
            squares.clear();
            if (!tag.empty() && tag[u] != 1) {
                area[u] = 0;
                continue;
            }
            for (Index v : graph.adjacency[Index(u)])
                squares.push_back((graph.position.col(v) - graph.position.col(u)).squaredNorm());
            std::sort(squares.begin(), squares.end());
            squares.resize(std::min<std::size_t>(squares.size(), cloudNeighbours));
            const std::size_t k = squares.size();
            const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
            area[u] = k ? float(sum * 2 * EIGEN_PI / double(k * (k + 1))) : 0.f;
        }
    });
}

/// A box without a few points far outside of it: the box of a sample's middle 80 %, eight times as large, where that is
/// smaller. (Eight: what is a surface and not a stray point stays inside; the frame's floats lose no more than three
/// bits by what is kept.) \param at position of each of \p count points
template <class At>
Eigen::AlignedBox3d WithoutStrays(const Eigen::AlignedBox3d &box, std::size_t count, const At &at) {
    const std::size_t wanted = std::min<std::size_t>(count, 256);
    std::vector<double> sample[3];
    for (std::size_t i = 0; i < wanted; ++i) {
        const Eigen::Vector3d p = at(count * i / wanted);
        for (int d = 0; d < 3; ++d)
            sample[d].push_back(p[d]);
    }
    Eigen::AlignedBox3d middle;
    for (int low : {1, 9}) {
        Eigen::Vector3d p;
        for (int d = 0; d < 3; ++d) {
            std::sort(sample[d].begin(), sample[d].end());
            p[d] = sample[d][std::min(wanted - 1, wanted * low / 10)];
        }
        middle.extend(p);
    }
    const double reach = 4 * (middle.max() - middle.min()).stableNorm();
    if (!(reach > 0))
        return box;
    const Eigen::Vector3d center = middle.min() * 0.5 + middle.max() * 0.5, half = Eigen::Vector3d::Constant(reach);
    return box.intersection(Eigen::AlignedBox3d(center - half, center + half));
}

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

/// The tag of a place where vertices have two: held where one is, by the smaller one.
inline Index TagOfBoth(Index a, Index b) { return a == 1 ? b : b == 1 ? a : std::min(a, b); }

/// Makes nodes on open borders a hair apart one, and leaves out those that are \p near but joined with none.
/// \param open n flags as of TriangleGraph \param near n flags, or empty for none
/// \param corner of the triangles, renumbered like the nodes; those between held nodes alone become points
/// \return whether a node went: then the triangles have to be connected again
inline bool JoinSeams(SurfaceGraph &s, const std::vector<char> &open, const std::vector<char> &near,
                      double weldDistance, Index *corner, std::size_t triangles, const Progress &progress) {
    Seams seams = FindSeams(s.graph, open, s.tag, weldDistance, progress);
    s.report.seams = seams.joined;
    s.report.gaps = seams.gaps;
    if (seams.joined == 0 && std::find(near.begin(), near.end(), 1) == near.end())
        return false;
    Eigen::Matrix3Xf &x = s.graph.position;
    const Index n = Index(x.cols());
    if (seams.into.empty()) {
        seams.into.resize(n);
        std::iota(seams.into.begin(), seams.into.end(), 0);
    }
    std::vector<Index> newIndex(n, -1);
    for (Index u = 0; u < n; ++u)
        if (near.empty() || !near[u])
            newIndex[seams.into[u]] = 0;
    Index kept = 0;
    for (Index u = 0; u < n; ++u)
        if (newIndex[u] >= 0) {
            newIndex[u] = kept;
            x.col(kept++) = Eigen::Vector3f(x.col(u));
        }
    for (Index u = 0; u < n; ++u)
        newIndex[u] = newIndex[seams.into[u]];
    Eigen::Matrix3Xf left = x.leftCols(kept);
    x.swap(left);
    for (Index &node : s.nodeOf)
        if (node >= 0)
            node = newIndex[node];
    if (!s.tag.empty()) {
        std::vector<Index> tag(kept, 1);
        for (Index u = 0; u < n; ++u)
            if (newIndex[u] >= 0)
                tag[newIndex[u]] = TagOfBoth(tag[newIndex[u]], s.tag[u]);
        s.tag = std::move(tag);
    }
    for (std::size_t t = 0; t < triangles; ++t) {
        Index *c = corner + 3 * t;
        for (int j = 0; j < 3; ++j)
            c[j] = newIndex[c[j]];
        if (s.IsHeld(c[0]) && s.IsHeld(c[1]) && s.IsHeld(c[2]))
            c[1] = c[2] = c[0];
    }
    return true;
}

inline Error NotFinite(std::size_t vertex) {
    return Error("Vertex " + std::to_string(vertex) +
                 " has a coordinate that is not a finite number; remove such vertices first.");
}

} // namespace detail
} // namespace fcd

namespace tri {

template <class VertexType>
Eigen::Vector3d PositionOf(const VertexType &v) {
    return Eigen::Vector3d(v.cP()[0], v.cP()[1], v.cP()[2]);
}

/// Which vertex slots of a mesh deform, and what holds them.
struct Region {
    static constexpr unsigned char none = 0, part = 1, candidate = 2;
    std::vector<unsigned char> flag;  ///< part: free, or held and joined to a free one; candidate: held, and part of it
                                      ///< where one that is part has the same position
    std::vector<std::uint32_t> faces; ///< as of SurfaceGraph
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as of SurfaceGraph
};

/// The free vertices (\p tag 1) that have a neighbour, and the held ones beside them; \p excluded ones (flags, or
/// empty) are left out. \throw fcd::Error a coordinate of any vertex is not finite
template <class MeshType>
Region FreeRegion(const MeshType &m, const std::vector<int> &tag, const std::vector<char> &excluded,
                  const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(), const fcd::Progress &progress = {}) {
    using fcd::ParallelFor;
    const char *stage = "Reading the mesh";
    const std::size_t slots = m.vert.size(), grain = 1 << 16;
    // A byte a vertex: what it is, whether a free neighbour or itself being one makes it part of the region, and, so
    // that few tags have to be looked up, its tag.
    constexpr unsigned char live = 1, free = 2, reached = 4, few = 8, many = 31, all = 255;
    Region region;
    std::unique_ptr<std::atomic<unsigned char>[]> state(new std::atomic<unsigned char>[slots]);
    std::vector<std::size_t> bad((slots + grain - 1) / grain, slots);
    ParallelFor(progress.Slice(0, 0.1), stage, slots, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const bool takesPart = !m.vert[i].IsD() && (excluded.empty() || !excluded[i]);
            if (takesPart && !PositionOf(m.vert[i]).allFinite())
                bad[first / grain] = std::min(bad[first / grain], i);
            const int held = std::min(int(many), std::max(0, tag[i])) * few;
            state[i].store((unsigned char)(held | (takesPart ? tag[i] == 1 ? live | free : live : 0)),
                           std::memory_order_relaxed);
        }
    });
    for (std::size_t i : bad)
        if (i < slots)
            throw fcd::detail::NotFinite(i);
    const auto is = [&](std::size_t i, unsigned char what) {
        return (unsigned char)(state[i].load(std::memory_order_relaxed) & what);
    };
    const auto reach = [&](std::size_t i) {
        if (!is(i, reached))
            state[i].fetch_or(reached, std::memory_order_relaxed);
    };
    if (m.fn == 0 && m.en == 0) {
        std::vector<std::size_t> slotOf;
        std::vector<vcg::Point3d> point;
        for (std::size_t i = 0; i < slots; ++i)
            if (is(i, live)) {
                slotOf.push_back(i);
                const Eigen::Vector3d p = metric * PositionOf(m.vert[i]);
                point.emplace_back(p[0], p[1], p[2]);
            }
        if (point.size() > 1) {
            vcg::ConstDataWrapper<vcg::Point3d> wrapper(point.data(), point.size());
            vcg::KdTree<double> tree(wrapper);
            const int wanted = int(std::min<std::size_t>(fcd::detail::cloudNeighbours + 1, point.size()));
            ParallelFor(progress.Slice(0.1, 0.9), "Finding neighbours", point.size(), 1 << 12,
                        [&](std::size_t first, std::size_t last) {
                            vcg::KdTree<double>::PriorityQueue queue;
                            for (std::size_t k = first; k < last; ++k) {
                                if (!is(slotOf[k], free))
                                    continue;
                                reach(slotOf[k]); // among more points at its place it need not be found
                                tree.doQueryK(point[k], wanted, queue);
                                for (int j = 0; j < queue.getNofElements(); ++j)
                                    reach(slotOf[queue.getIndex(j)]);
                            }
                        });
        }
    } else {
        const auto join = [&](const std::size_t *slot, const unsigned char *s, int corners) {
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
        };
        struct Found {
            std::vector<std::uint32_t> faces;
            std::vector<std::array<std::uint32_t, 2>> apart;
        };
        std::vector<Found> found((m.face.size() + grain - 1) / grain);
        ParallelFor(progress.Slice(0.1, 0.9), stage, m.face.size(), grain, [&](std::size_t first, std::size_t last) {
            Found here;
            for (std::size_t f = first; f < last; ++f) {
                const auto &face = m.face[f];
                if (face.IsD())
                    continue;
                std::size_t slot[3];
                unsigned char s[3];
                for (int j = 0; j < 3; ++j) {
                    slot[j] = std::size_t(face.cV(j) - &m.vert[0]);
                    s[j] = is(slot[j], all);
                }
                if (join(slot, s, 3))
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
                const unsigned char s[2] = {is(slot[0], all), is(slot[1], all)};
                join(slot, s, 2);
            }
    }
    fcd::AssignLarge(region.flag, slots, Region::none);
    ParallelFor(progress.Slice(0.9, 1), stage, slots, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            region.flag[i] = is(i, reached)                ? Region::part
                             : is(i, live) && !is(i, free) ? Region::candidate
                                                           : Region::none;
    });
    return region;
}

/// Reads the connectivity of a mesh, or of a region of it. Neighbours are the vertices that share a face or an edge
/// element; in a mesh that has neither, the 12 nearest points. Vertices at the same position (float precision of the
/// frame) share a node, and so do those on open borders a hair apart, so that seams hold together; it is held where one
/// of them is. Deleted elements are skipped; the mesh is only read. What is not in the region changes no bit of the
/// result.
///
/// \param region nullptr for all of the mesh \param tag one per vertex slot, read where there is a region
/// \param metric as of Frame \param weldDistance a hair, frame units, [0, 1e-3]
/// \throw fcd::Error no vertices, or a coordinate that is not finite
template <class MeshType>
fcd::SurfaceGraph BuildSurfaceGraph(const MeshType &m, const Region *region, const std::vector<int> &tag,
                                    const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                                    const fcd::Progress &progress = {},
                                    double weldDistance = fcd::defaultWeldDistance) {
    using fcd::Index;
    using fcd::ParallelFor;
    const char *stage = "Reading the mesh";
    const std::size_t slotCount = m.vert.size(), grain = 1 << 16, chunks = (slotCount + grain - 1) / grain;
    fcd::SurfaceGraph s;
    s.frame.SetMetric(metric);
    s.report.pointCloud = s.graph.isCloud = m.fn == 0 && m.en == 0;
    const bool hasSeams = !s.report.pointCloud && weldDistance > 0;
    progress(0, stage);
    std::vector<unsigned char> beside; // candidates that may be at a part, or a hair from it
    const auto isPart = [&](std::size_t i) { return region ? region->flag[i] == Region::part : !m.vert[i].IsD(); };

    // Bounding box.
    struct Part {
        Eigen::AlignedBox3d box;
        std::size_t live = 0, bad = std::size_t(-1), candidates = 0;
    };
    std::vector<Part> part(chunks);
    ParallelFor(progress.Slice(0, 0.05), stage, slotCount, grain, [&](std::size_t first, std::size_t last) {
        Part p;
        for (std::size_t i = first; i < last; ++i) {
            p.candidates += region && region->flag[i] == Region::candidate;
            if (!isPart(i))
                continue;
            const Eigen::Vector3d x = s.frame.ToWorld(PositionOf(m.vert[i]));
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
        total.candidates += p.candidates;
        total.bad = std::min(total.bad, p.bad);
    }
    if (total.live == 0 && !region)
        throw fcd::Error("The mesh has no vertices.");
    if (total.bad != std::size_t(-1))
        throw fcd::detail::NotFinite(total.bad);
    fcd::AssignLarge(s.nodeOf, slotCount, Index(-1));
    if (total.live == 0)
        return s;
    std::vector<std::size_t> begin(chunks + 1, 0); // of each chunk's vertices in the list of all of them
    for (std::size_t c = 0; c < chunks; ++c)
        begin[c + 1] = begin[c] + part[c].live;
    total.box = fcd::detail::WithoutStrays(total.box, total.live, [&](std::size_t k) {
        std::size_t c = std::size_t(std::upper_bound(begin.begin(), begin.end(), k) - begin.begin()) - 1;
        for (std::size_t i = c * grain, at = begin[c];; ++i)
            if (isPart(i) && at++ == k)
                return s.frame.ToWorld(PositionOf(m.vert[i]));
    });
    const Eigen::Vector3d extent = total.box.max() * 0.5 - total.box.min() * 0.5; // half of it: no overflow
    const double halfDiagonal = extent.stableNorm();
    s.frame.origin = total.box.min() * 0.5 + total.box.max() * 0.5;
    s.frame.scale = halfDiagonal > 0 ? std::min(2 * halfDiagonal, std::numeric_limits<double>::max()) : 1;
    s.diagonal = halfDiagonal / s.frame.scale * 2;
    s.report.vertices = Index(total.live);
    const auto inFrame = [&](std::size_t i) {
        const double most = 1e15; // squares of it are floats
        const Eigen::Vector3f x =
            s.frame.ToFrame(PositionOf(m.vert[i])).cwiseMin(most).cwiseMax(-most).template cast<float>();
        return Eigen::Vector3f(x.array() + 0.f); // no negative zero: equal positions have equal bits
    };

    // Held vertices at one that is part, or a hair from it: a bit for each cell of a grid with such a place, some of
    // them shared. The cells are wide enough for most hairs to lie in one, and narrow enough for few others.
    if (total.candidates) {
        const float hair = hasSeams ? float(1.5 * weldDistance) : 0.f, cells = hair > 0 ? 0.05f / hair : 1e6f;
        const auto forCells = [&](std::size_t i, bool ofPart, const auto &body) {
            fcd::detail::ForCells(inFrame(i), cells, ofPart ? hair : 0, body);
        };
        // Of the smaller side, parts or candidates, all cells; then those of the other that are in one of them, and the
        // same back.
        const bool partsFirst = total.live <= total.candidates;
        const auto isOn = [&](std::size_t i, bool ofPart) {
            return region->flag[i] == (ofPart ? Region::part : Region::candidate);
        };
        fcd::detail::CellSet first(std::min(total.live, total.candidates));
        ParallelFor(progress.Slice(0.05, 0.055), stage, slotCount, grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                if (isOn(i, partsFirst))
                    forCells(i, partsFirst, [&](std::uint64_t cell) { first.Insert(cell); });
        });
        const auto thoseIn = [&](const fcd::detail::CellSet &set, bool ofPart) {
            return fcd::CollectInOrder<std::uint32_t>(
                progress.Slice(0.055, 0.06), stage, Index(slotCount), [&](Index i, std::vector<std::uint32_t> &found) {
                    bool isIn = false;
                    if (isOn(std::size_t(i), ofPart))
                        forCells(std::size_t(i), ofPart,
                                 [&](std::uint64_t cell) { isIn = isIn || set.Contains(cell); });
                    if (isIn)
                        found.push_back(std::uint32_t(i));
                });
        };
        std::vector<std::uint32_t> parts = thoseIn(first, !partsFirst), candidates;
        fcd::detail::CellSet second(parts.size());
        for (std::uint32_t i : parts)
            forCells(i, !partsFirst, [&](std::uint64_t cell) { second.Insert(cell); });
        candidates = thoseIn(second, partsFirst);
        if (partsFirst)
            parts.swap(candidates);
        std::vector<std::uint64_t> cell;
        for (std::uint32_t i : parts)
            forCells(i, true, [&](std::uint64_t c) { cell.push_back(c); });
        std::sort(cell.begin(), cell.end());
        beside.assign(slotCount, 0);
        for (std::uint32_t i : candidates)
            forCells(i, false, [&](std::uint64_t c) {
                beside[i] = std::binary_search(cell.begin(), cell.end(), c);
                part[i / grain].live += beside[i];
            });
        const std::size_t onlyParts = total.live;
        total.live = 0;
        for (std::size_t c = 0; c < chunks; ++c) {
            begin[c] = total.live;
            total.live += part[c].live;
        }
        if (total.live == onlyParts) // none, as mostly
            beside = {};
    }
    const auto isBeside = [&](std::size_t i) { return !beside.empty() && beside[i]; };

    // Morton order.
    std::unique_ptr<std::uint64_t[]> order = fcd::LargeArray<std::uint64_t>(total.live);
    Eigen::Matrix3Xf bySlot(3, slotCount);
    fcd::PreferLargePages(bySlot.data(), slotCount * sizeof(Eigen::Vector3f));
    ParallelFor(progress.Slice(0.07, 0.1), stage, slotCount, grain, [&](std::size_t first, std::size_t last) {
        std::size_t at = begin[first / grain];
        for (std::size_t i = first; i < last; ++i)
            if (isPart(i) || isBeside(i)) {
                bySlot.col(i) = inFrame(i);
                order[at++] =
                    std::uint64_t(fcd::detail::MortonCode(bySlot(0, i), bySlot(1, i), bySlot(2, i))) << 32 | i;
            }
    });
    fcd::detail::RadixSortUpper30(order, total.live, progress.Slice(0.1, 0.2), stage);

    // Vertices at one position share a node. Such vertices have the same code, so ranges that end with a code are
    // independent.
    constexpr std::uint32_t dropped = std::uint32_t(-1); // held, and at no part after all
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
    std::vector<std::size_t> firstSlot(ranges + 1, 0);
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
            bool SamePlace(const Item &o) const { return p[0] == o.p[0] && p[1] == o.p[1] && p[2] == o.p[2]; }
        };
        std::vector<Item> sameCode;
        Index found = 0;
        std::size_t keptHere = 0;
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i)
            x.col(i) = bySlot.col(slotAt(i));
        for (std::size_t i = rangeBegin[range], next; i < rangeBegin[range + 1]; i = next) {
            const std::uint64_t code = order[i] >> 32;
            for (next = i + 1; next < rangeBegin[range + 1] && order[next] >> 32 == code;)
                ++next;
            if (next - i == 1) {
                if (isBeside(slotAt(i)) && !hasSeams)
                    order[i] = code << 32 | dropped;
                else
                    ++found, ++keptHere;
                continue;
            }
            sameCode.clear();
            for (std::size_t j = i; j < next; ++j)
                sameCode.push_back({{x(0, j), x(1, j), x(2, j)}, slotAt(j)});
            fcd::detail::SortShort(sameCode.data(), sameCode.data() + sameCode.size());
            for (std::size_t a = 0, b; a < sameCode.size(); a = b) {
                bool isNode = hasSeams;
                for (b = a; b < sameCode.size() && sameCode[b].SamePlace(sameCode[a]); ++b)
                    isNode |= !isBeside(sameCode[b].slot);
                for (std::size_t j = a; j < b; ++j) {
                    x.col(i + j) << sameCode[j].p[0], sameCode[j].p[1], sameCode[j].p[2];
                    order[i + j] = code << 32 | (isNode ? sameCode[j].slot : dropped);
                }
                found += isNode;
                keptHere += isNode ? b - a : 0;
            }
        }
        firstNode[range + 1] = found;
        firstSlot[range + 1] = keptHere;
    });
    for (std::size_t range = 0; range < ranges; ++range) {
        firstNode[range + 1] += firstNode[range];
        firstSlot[range + 1] += firstSlot[range];
    }
    Index nodes = firstNode[ranges];
    s.report.welded = Index(firstSlot[ranges]) - nodes;
    fcd::AssignLarge(s.slots, firstSlot[ranges], std::uint32_t(0));
    const bool shifted = std::size_t(nodes) < total.live;
    if (region)
        fcd::AssignLarge(s.tag, nodes, Index(1));
    bySlot.resize(3, 0); // first: Eigen's resize frees the old memory twice where it gets no new one
    if (shifted)
        bySlot.resize(3, nodes);
    ParallelFor(progress.Slice(0.3, 0.4), stage, ranges, 1, [&](std::size_t range, std::size_t) {
        Index node = firstNode[range] - 1;
        std::size_t at = firstSlot[range];
        for (std::size_t i = rangeBegin[range]; i < rangeBegin[range + 1]; ++i) {
            if (slotAt(i) == dropped)
                continue;
            if (i == rangeBegin[range] || x.col(i) != x.col(i - 1)) {
                ++node;
                if (shifted)
                    bySlot.col(node) = x.col(i);
            }
            s.nodeOf[slotAt(i)] = node;
            s.slots[at++] = slotAt(i);
            if (region && tag[slotAt(i)] != 1)
                s.tag[node] = fcd::detail::TagOfBoth(s.tag[node], std::max(tag[slotAt(i)], 0));
        }
    });
    if (shifted)
        x.swap(bySlot);
    order.reset();
    bySlot.resize(3, 0);

    // Faces and edge elements as corners; those that do not count as three times the same.
    const std::size_t faces = region ? region->faces.size() : m.face.size();
    std::unique_ptr<Index[]> corner = fcd::LargeArray<Index>(3 * (faces + m.edge.size()));
    std::size_t triangles = 0;
    struct Count {
        std::size_t triangles = 0;
        Index degenerate = 0;
    };
    std::vector<Count> counts((faces + grain - 1) / grain);
    // Adds what is not between held nodes alone to the list at \p to.
    auto add = [&](const auto &element, int corners, Index *to) {
        for (int j = 0; j < 3; ++j) {
            to[j] = s.nodeOf[element.cV(std::min(j, corners - 1)) - &m.vert[0]];
            if (to[j] < 0)
                return false;
        }
        return !(s.IsHeld(to[0]) && s.IsHeld(to[1]) && s.IsHeld(to[2]));
    };
    ParallelFor(progress.Slice(0.4, 0.5), stage, faces, grain, [&](std::size_t first, std::size_t last) {
        Index *to = &corner[3 * first];
        Count count;
        for (std::size_t f = first; f < last; ++f)
            if (const auto &face = m.face[region ? region->faces[f] : f]; !face.IsD() && add(face, 3, to)) {
                count.degenerate += to[0] == to[1] || to[1] == to[2] || to[2] == to[0];
                ++count.triangles;
                to += 3;
            }
        counts[first / grain] = count;
    });
    for (std::size_t c = 0; c < counts.size(); ++c) { // close the gaps between the lists
        const Index *from = &corner[3 * c * grain];
        if (triangles != c * grain)
            std::copy(from, from + 3 * counts[c].triangles, &corner[3 * triangles]);
        triangles += counts[c].triangles;
        s.report.degenerateFaces += counts[c].degenerate;
    }
    for (const auto &e : m.edge)
        triangles += !e.IsD() && add(e, 2, &corner[3 * triangles]);
    if (s.report.pointCloud)
        corner =
            fcd::detail::NearestNeighbourPairs(x, fcd::detail::cloudNeighbours, triangles, progress.Slice(0.4, 0.5));
    fcd::detail::TriangleGraph connected =
        fcd::detail::ConnectTriangles(x, corner.get(), triangles, progress.Slice(0.5, 0.9));
    s.graph.adjacency = std::move(connected.adjacency);

    if (hasSeams) {
        std::vector<char> near; // nodes of candidates alone, which only a seam makes part of it
        if (!beside.empty()) {
            near.assign(nodes, 1);
            for (std::size_t i = 0; i < slotCount; ++i)
                if (s.nodeOf[i] >= 0 && !beside[i])
                    near[s.nodeOf[i]] = 0;
            s.report.welded = 0;
            for (std::size_t i = 0; i < slotCount; ++i)
                s.report.welded += s.nodeOf[i] >= 0 && !near[s.nodeOf[i]];
            for (Index u = 0; u < nodes; ++u) {
                s.report.welded -= !near[u];
                connected.open[u] |= near[u];
            }
        }
        if (fcd::detail::JoinSeams(s, connected.open, near, weldDistance, corner.get(), triangles,
                                   progress.Slice(0.9, 0.92))) {
            nodes = Index(x.cols());
            connected = fcd::detail::ConnectTriangles(x, corner.get(), triangles, progress.Slice(0.92, 1));
            s.graph.adjacency = std::move(connected.adjacency);
        }
    }
    s.nodeArea = std::move(connected.area);
    s.report.nonManifoldEdges = connected.nonManifoldEdges;
    const std::size_t items = s.graph.adjacency.item.size();
    s.averageEdge = items ? 2 * connected.edgeLengths / double(items) : 0;
    if (s.report.pointCloud)
        fcd::detail::CloudAreas(s.graph, s.tag, progress.threads, s.nodeArea);
    for (Index i = 0; i < nodes; ++i) {
        s.area += s.nodeArea[i];
        s.report.isolated += s.graph.adjacency[i].size() == 0;
    }
    progress(1, stage);
    return s;
}

/// All of the mesh.
template <class MeshType>
fcd::SurfaceGraph BuildSurfaceGraph(const MeshType &m, const fcd::Progress &progress = {}) {
    return BuildSurfaceGraph(m, nullptr, {}, Eigen::Matrix3d::Identity(), progress);
}

} // namespace tri
} // namespace vcg

#endif
