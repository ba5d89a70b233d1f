// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_GRAPH_H
#define VCG_FCD_SURFACE_GRAPH_H

#include "candidates_beside.h"
#include "frame.h"
#include "free_region.h"
#include "graph.h"
#include "memory.h"
#include "point_cloud.h"
#include "progress.h"
#include "seams.h"
#include "triangle_graph.h"
#include "vertex_welding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg {
namespace fcd {

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

/// The tag of a place where vertices have two: held where one is, by the smaller one.
inline Index TagOfBoth(Index a, Index b) { return a == 1 ? b : b == 1 ? a : std::min(a, b); }

/// Reads a mesh, or a region of it, as BuildSurfaceGraph tells.
template <class MeshType>
class SurfaceReader {
  public:
    SurfaceReader(const MeshType &m, const tri::Region *region, const std::vector<int> &tag,
                  const Eigen::Matrix3d &metric, const Progress &progress, double weldDistance,
                  const Eigen::Matrix3Xd *known)
        : m(m), region(region), tag(tag), progress(progress), weldDistance(weldDistance), known(known),
          slots(m.vert.size()) {
        s.frame.SetMetric(metric);
        s.report.pointCloud = s.graph.isCloud = m.fn == 0 && m.en == 0;
        hasSeams = !s.report.pointCloud && weldDistance > 0;
    }

    /// Once.
    SurfaceGraph Read() {
        progress(0, readingStage);
        const Eigen::AlignedBox3d box = Measure();
        AssignLarge(s.nodeOf, slots, Index(-1));
        if (Live() > 0) {
            SetFrame(box);
            FindBeside(box);
            MakeNodes();
            Connect();
            progress(1, readingStage);
        }
        return std::move(s);
    }

  private:
    static constexpr std::size_t grain = 1 << 16;

    bool IsPart(std::size_t i) const { return region ? region->flag[i] == tri::Region::part : !m.vert[i].IsD(); }
    bool IsBeside(std::size_t i) const { return !beside.empty() && beside[i]; }
    std::size_t Live() const { return begin.back(); }

    Eigen::Vector3f InFrame(const Eigen::Vector3d &world) const {
        const double most = 1e15; // squares of it are floats
        const Eigen::Vector3f x = s.frame.FromWorld(world).cwiseMin(most).cwiseMax(-most).template cast<float>();
        return x.array() + 0.f; // no negative zero: equal positions have equal bits
    }
    Eigen::Vector3d InWorld(std::size_t i) const { return s.frame.ToWorld(tri::PositionOf(m, i, known)); }
    Eigen::Vector3f InFrame(std::size_t i) const { return InFrame(InWorld(i)); }

    /// Counts vertices. \return their box, world units \throw Error as BuildSurfaceGraph
    Eigen::AlignedBox3d Measure() {
        struct Chunk {
            Eigen::AlignedBox3d box;
            std::size_t live = 0, bad = std::size_t(-1), candidates = 0;
        };
        std::vector<Chunk> chunks((slots + grain - 1) / grain);
        ParallelFor(progress.Slice(0, 0.05), readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            Chunk c;
            for (std::size_t i = first; i < last; ++i) {
                c.candidates += region && region->flag[i] == tri::Region::candidate;
                if (!IsPart(i))
                    continue;
                const Eigen::Vector3d x = InWorld(i);
                if (!x.allFinite())
                    c.bad = std::min(c.bad, i);
                c.box.extend(x);
                ++c.live;
            }
            chunks[first / grain] = c;
        });
        Eigen::AlignedBox3d box;
        std::size_t bad = std::size_t(-1);
        begin.assign(1, 0);
        for (const Chunk &c : chunks) {
            box.extend(c.box);
            begin.push_back(begin.back() + c.live);
            candidates += c.candidates;
            bad = std::min(bad, c.bad);
        }
        if (Live() == 0 && !region)
            throw Error("The mesh has no vertices.");
        if (bad != std::size_t(-1))
            throw NotFinite(bad);
        s.report.vertices = Index(Live());
        return box;
    }

    void SetFrame(const Eigen::AlignedBox3d &ofAll) {
        const Eigen::AlignedBox3d box = WithoutStrays(ofAll, Live(), [&](std::size_t k) {
            std::size_t c = std::size_t(std::upper_bound(begin.begin(), begin.end(), k) - begin.begin()) - 1;
            for (std::size_t i = c * grain, at = begin[c];; ++i)
                if (IsPart(i) && at++ == k)
                    return InWorld(i);
        });
        const Eigen::Vector3d extent = box.max() * 0.5 - box.min() * 0.5; // half of it: no overflow
        const double halfDiagonal = extent.stableNorm();
        s.frame.origin = box.min() * 0.5 + box.max() * 0.5;
        s.frame.scale = halfDiagonal > 0 ? std::min(2 * halfDiagonal, std::numeric_limits<double>::max()) : 1;
        s.diagonal = halfDiagonal / s.frame.scale * 2;
    }

    /// Takes in candidates that may be at a part, or a hair from it. \param box of the parts, world units
    void FindBeside(const Eigen::AlignedBox3d &box) {
        if (!candidates)
            return;
        const float hair = hasSeams ? float(1.5 * weldDistance) : 0.f;
        const std::vector<std::uint32_t> found = CandidatesBeside(
            *region, Live(), candidates, [&](std::size_t i) { return InFrame(i); },
            [&](const Eigen::Vector3d &p) { return InFrame(s.frame.ToWorld(p)); },
            {InFrame(box.min()), InFrame(box.max())}, hair, progress.Slice(0.05, 0.06));
        if (found.empty()) // as mostly
            return;
        beside.assign(slots, 0);
        for (std::uint32_t i : found)
            beside[i] = 1;
        for (std::size_t c = 0; c < begin.size(); ++c)
            begin[c] += std::size_t(std::lower_bound(found.begin(), found.end(), c * grain) - found.begin());
    }

    void MakeNodes() {
        VertexWelder welder(Live(), slots);
        ParallelFor(progress.Slice(0.07, 0.1), readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            std::size_t at = begin[first / grain];
            for (std::size_t i = first; i < last; ++i)
                if (IsPart(i) || IsBeside(i))
                    welder.Put(at++, i, InFrame(i));
        });
        welder.Sort(progress.Slice(0.1, 0.2));
        // With seams, it is known after them which of those beside stay.
        welder.FindNodes([&](std::size_t i) { return !hasSeams && IsBeside(i); }, progress.Slice(0.2, 0.3));
        s.report.welded = Index(welder.Kept()) - welder.Nodes();
        AssignLarge(s.slots, welder.Kept(), std::uint32_t(0));
        if (region)
            AssignLarge(s.tag, welder.Nodes(), Index(1));
        s.graph.position = welder.ForEach(
            [&](Index node, std::uint32_t slot, std::size_t at) {
                s.nodeOf[slot] = node;
                s.slots[at] = slot;
                if (region && tag[slot] != 1)
                    s.tag[node] = TagOfBoth(s.tag[node], std::max(tag[slot], 0));
            },
            progress.Slice(0.3, 0.4));
    }

    void Connect() {
        const Eigen::Matrix3Xf &x = s.graph.position;
        TriangleList list = ElementTriangles(
            m, region ? &region->faces : nullptr, s.nodeOf, [&](Index u) { return s.IsHeld(u); },
            progress.Slice(0.4, 0.5));
        s.report.degenerateFaces = list.degenerateFaces;
        if (s.report.pointCloud)
            list = NearestNeighbourPairs(x, progress.Slice(0.4, 0.5));
        TriangleGraph connected = ConnectTriangles(x, list.corner.get(), list.count, progress.Slice(0.5, 0.9));
        s.graph.adjacency = std::move(connected.adjacency);
        if (hasSeams && JoinSeams(connected.open, list)) {
            connected = ConnectTriangles(x, list.corner.get(), list.count, progress.Slice(0.92, 1));
            s.graph.adjacency = std::move(connected.adjacency);
        }
        s.nodeArea = std::move(connected.area);
        s.report.nonManifoldEdges = connected.nonManifoldEdges;
        const std::size_t items = s.graph.adjacency.item.size();
        s.averageEdge = items ? 2 * connected.edgeLengths / double(items) : 0;
        if (s.report.pointCloud)
            CloudAreas(s.graph, s.tag, progress.threads, s.nodeArea);
        for (Index u = 0; u < s.graph.Size(); ++u) {
            s.area += s.nodeArea[u];
            s.report.isolated += s.graph.adjacency[u].size() == 0;
        }
    }

    /// Flags of nodes of vertices beside alone, which only a seam makes part of it; empty for none. Does not count
    /// their vertices as welded.
    std::vector<char> NodesBeside() {
        std::vector<char> near;
        if (beside.empty())
            return near;
        near.assign(s.graph.Size(), 1);
        for (std::size_t i = 0; i < slots; ++i)
            if (s.nodeOf[i] >= 0 && !beside[i])
                near[s.nodeOf[i]] = 0;
        s.report.welded = 0;
        for (std::size_t i = 0; i < slots; ++i)
            s.report.welded += s.nodeOf[i] >= 0 && !near[s.nodeOf[i]];
        for (char isNear : near)
            s.report.welded -= !isNear;
        return near;
    }

    /// Makes nodes on open borders a hair apart one, and leaves out those beside that are joined with none.
    /// \param open flags as of TriangleGraph
    /// \param list renumbered like the nodes; triangles between held nodes alone become points
    /// \return whether a node went: then the triangles have to be connected again
    bool JoinSeams(std::vector<char> &open, TriangleList &list) {
        const std::vector<char> near = NodesBeside();
        for (std::size_t u = 0; u < near.size(); ++u)
            open[u] |= near[u];
        Seams seams = FindSeams(s.graph, open, s.tag, weldDistance, progress.Slice(0.9, 0.92));
        s.report.seams = seams.joined;
        s.report.gaps = seams.gaps;
        if (seams.joined == 0 && std::find(near.begin(), near.end(), 1) == near.end())
            return false;
        Eigen::Matrix3Xf &x = s.graph.position;
        const Index n = s.graph.Size();
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
            std::vector<Index> joined(kept, 1);
            for (Index u = 0; u < n; ++u)
                if (newIndex[u] >= 0)
                    joined[newIndex[u]] = TagOfBoth(joined[newIndex[u]], s.tag[u]);
            s.tag = std::move(joined);
        }
        for (Index *c = list.corner.get(); c < list.corner.get() + 3 * list.count; c += 3) {
            for (int j = 0; j < 3; ++j)
                c[j] = newIndex[c[j]];
            if (s.IsHeld(c[0]) && s.IsHeld(c[1]) && s.IsHeld(c[2]))
                c[1] = c[2] = c[0];
        }
        return true;
    }

    const MeshType &m;
    const tri::Region *region; // nullptr: all of the mesh
    const std::vector<int> &tag;
    const Progress &progress;
    const double weldDistance;
    const Eigen::Matrix3Xd *known;
    const std::size_t slots;
    bool hasSeams;
    std::size_t candidates = 0;
    std::vector<std::size_t> begin;    // of each chunk's vertices in the list of all of them
    std::vector<unsigned char> beside; // flags of slots; empty for none
    SurfaceGraph s;
};

} // namespace detail
} // namespace fcd

namespace tri {

/// Reads the connectivity of a mesh, or of a region of it. Neighbours are the vertices that share a face or an edge
/// element; in a mesh that has neither, the 12 nearest points. Vertices at the same position (float precision of the
/// frame) share a node, and so do those on open borders a hair apart, so that seams hold together; it is held where one
/// of them is. Deleted elements are skipped; the mesh is only read. What is not in the region changes no bit of the
/// result.
///
/// \param region nullptr for all of the mesh \param tag one per vertex slot, read where there is a region
/// \param metric as of Frame \param weldDistance a hair, frame units, [0, 1e-3] \param known as of PositionOf
/// \throw fcd::Error no vertices, or a coordinate that is not finite
template <class MeshType>
fcd::SurfaceGraph BuildSurfaceGraph(const MeshType &m, const Region *region, const std::vector<int> &tag,
                                    const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                                    const fcd::Progress &progress = {}, double weldDistance = fcd::defaultWeldDistance,
                                    const Eigen::Matrix3Xd *known = nullptr) {
    return fcd::detail::SurfaceReader<MeshType>(m, region, tag, metric, progress, weldDistance, known).Read();
}

/// All of the mesh.
template <class MeshType>
fcd::SurfaceGraph BuildSurfaceGraph(const MeshType &m, const fcd::Progress &progress = {}) {
    return BuildSurfaceGraph(m, nullptr, {}, Eigen::Matrix3d::Identity(), progress);
}

} // namespace tri
} // namespace vcg

#endif
