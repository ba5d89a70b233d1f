// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/memory.h>
#include <vcg_ext/surface/candidates_beside.h>
#include <vcg_ext/surface/point_cloud.h>
#include <vcg_ext/surface/seams.h>
#include <vcg_ext/surface/surface_graph.h>
#include <vcg_ext/surface/triangle_graph.h>
#include <vcg_ext/surface/vertex_chunks.h>
#include <vcg_ext/surface/vertex_welding.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace vcg::fcd {
namespace detail {

/// The tag of a node whose vertices have two: held if one of them is, by the smaller tag.
inline Index TagOfBoth(Index a, Index b) { return a == 1 ? b : b == 1 ? a : std::min(a, b); }

/// Does BuildSurfaceGraph.
class SurfaceReader {
  public:
    SurfaceReader(const SurfaceView &mesh, const Region *region, const std::vector<int> &tag,
                  const Eigen::Matrix3d &metric, const Progress &progress, double weldDistance)
        : mesh(mesh), region(region), tag(tag), progress(progress), weldDistance(weldDistance),
          slots(mesh.vertexSlots) {
        s.frame.SetMetric(metric);
        s.report.pointCloud = s.graph.isCloud = mesh.isCloud;
        hasSeams = !s.report.pointCloud && weldDistance > 0;
    }

    /// Call it once.
    SurfaceGraph Read() {
        progress(0, readingStage);
        const auto isPart = [this](std::size_t i) { return IsPart(i); };
        chunks = FindVertices(mesh, isPart, s.frame, progress.Slice(0, 0.05));
        if (Live() == 0 && !region)
            throw BadInput("The mesh has no vertices.");
        s.report.vertices = Index(Live());
        AssignLarge(s.nodeOf, slots, Index(-1));
        if (Live() > 0) {
            SetFrame(mesh, chunks, isPart, s.frame);
            FindBeside();
            MakeNodes();
            Connect();
            progress(1, readingStage);
        }
        return std::move(s);
    }

  private:
    static constexpr std::size_t grain = VertexChunks::grain;

    bool IsPart(std::size_t i) const { return region ? region->flag[i] == Region::part : !mesh.IsDeleted(i); }
    bool IsBeside(std::size_t i) const { return !beside.empty() && beside[i]; }
    std::size_t Live() const { return chunks.Live(); }

    /// Draws stray points nearer in each coordinate, so that squares of areas are still floats. It keeps their order,
    /// so that vertices stay apart.
    Eigen::Vector3f InFrame(const Eigen::Vector3d &world) const {
        const double most = 1e8, finite = 1e300;
        Eigen::Vector3d x = s.frame.FromWorld(world);
        for (int k = 0; k < 3; ++k)
            if (const double far = std::min(std::abs(x[k]), finite); far > most) {
                int doublings = 0;
                const double part = std::frexp(far / most, &doublings); // [0.5, 1)
                x[k] = std::copysign(most * (1 + (doublings + 2 * part - 2) / 1024), x[k]);
            }
        return x.cast<float>().array() + 0.f; // no negative zero: equal positions have equal bits
    }
    Eigen::Vector3f InFrame(std::size_t i) const { return InFrame(s.frame.ToWorld(mesh.At(i))); }

    /// Finds the held vertices that may be at the position of a vertex of the region, or a hair from it: `beside`.
    void FindBeside() {
        if (!region)
            return;
        const auto candidates = std::size_t(std::count(region->flag.begin(), region->flag.end(), Region::candidate));
        if (candidates == 0)
            return;
        const float hair = hasSeams ? float(1.5 * weldDistance) : 0.f;
        const std::vector<std::uint32_t> found = CandidatesBeside(
            *region, Live(), candidates, [&](std::size_t i) { return InFrame(i); },
            [&](const Eigen::Vector3d &p) { return InFrame(s.frame.ToWorld(p)); },
            {InFrame(chunks.box.min()), InFrame(chunks.box.max())}, hair, progress.Slice(0.05, 0.06));
        if (found.empty()) // in most meshes
            return;
        beside.assign(slots, 0);
        for (std::uint32_t i : found)
            beside[i] = 1;
        for (std::size_t c = 0; c < chunks.begin.size(); ++c)
            chunks.begin[c] += std::size_t(std::lower_bound(found.begin(), found.end(), c * grain) - found.begin());
    }

    void MakeNodes() {
        VertexWelder welder(Live(), slots);
        ParallelFor(progress.Slice(0.07, 0.1), readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
            std::size_t at = chunks.begin[first / grain];
            for (std::size_t i = first; i < last; ++i)
                if (IsPart(i) || IsBeside(i))
                    welder.Put(at++, i, InFrame(i));
        });
        welder.Sort(progress.Slice(0.1, 0.2));
        // With seams, FindSeams decides which vertices of `beside` stay.
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
        double edgeLengths = 0;
        if (s.report.pointCloud) {
            edgeLengths = ConnectCloud();
        } else {
            TriangleList list = ElementTriangles(
                mesh, region ? &region->faces : nullptr, s.nodeOf, [&](Index u) { return s.IsHeld(u); },
                progress.Slice(0.4, 0.5));
            s.report.degenerateFaces = list.degenerateFaces;
            TriangleGraph connected = ConnectTriangles(x, list.corner.get(), list.count, progress.Slice(0.5, 0.9));
            s.graph.adjacency = std::move(connected.adjacency);
            if (hasSeams && JoinSeams(connected.open, list)) {
                connected = ConnectTriangles(x, list.corner.get(), list.count, progress.Slice(0.92, 0.98));
                s.graph.adjacency = std::move(connected.adjacency);
            }
            if (hasSeams)
                s.report.gaps = CountGaps(s.graph, connected.open, s.tag, progress.Slice(0.98, 1));
            s.nodeArea = std::move(connected.area);
            s.report.nonManifoldEdges = connected.nonManifoldEdges;
            s.report.repeatedFaces = connected.repeatedFaces;
            edgeLengths = connected.edgeLengths;
        }
        const std::size_t items = s.graph.adjacency.item.size();
        s.averageEdge = items ? 2 * edgeLengths / double(items) : 0;
        for (Index u = 0; u < s.graph.Size(); ++u) {
            s.area += s.nodeArea[u];
            s.report.isolated += s.graph.adjacency[u].size() == 0;
        }
    }

    /// Flags of nodes with vertices of `beside` alone: such a node stays only if a seam welds it to another one. Empty:
    /// none. Leaves their vertices out of the count of welded ones.
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

    /// Welds nodes on open borders a hair apart, and drops nodes of `beside` that are welded to no other one.
    /// \param open flags as in TriangleGraph
    /// \param list renumbered as the nodes; triangles with held nodes only become points
    /// \return whether nodes were dropped: then the triangles have to be connected again
    bool JoinSeams(std::vector<char> &open, TriangleList &list) {
        const std::vector<char> near = NodesBeside();
        for (std::size_t u = 0; u < near.size(); ++u)
            open[u] |= near[u];
        Seams seams = FindSeams(s.graph, open, s.tag, weldDistance, progress.Slice(0.9, 0.92), near);
        s.report.seams = seams.joined;
        if (seams.joined == 0 && std::find(near.begin(), near.end(), 1) == near.end())
            return false;
        JoinNodes(std::move(seams.into), near);
        for (Index *c = list.corner.get(); c < list.corner.get() + 3 * list.count; c += 3) {
            for (int j = 0; j < 3; ++j)
                c[j] = newIndex[c[j]];
            if (s.IsHeld(c[0]) && s.IsHeld(c[1]) && s.IsHeld(c[2]))
                c[1] = c[2] = c[0];
        }
        return true;
    }

    /// Welds points of a cloud that are a hair apart, then connects neighbours. Held points get no area, since not all
    /// of their neighbours are read. \return sum of the edges' lengths
    double ConnectCloud() {
        bool clumps = false;
        for (;;) { // welding can bring more points to weld into reach
            const Eigen::Matrix3Xf &x = s.graph.position;
            CloudPairs pairs = PairNeighbours(x, float(weldDistance), clumps, progress.Slice(0.4, 0.8));
            if (!clumps && 100 * pairs.inClumps > std::size_t(x.cols())) { // ten times what chance makes
                clumps = true;
                continue;
            }
            if (pairs.same.empty()) {
                s.graph.adjacency = ConnectPoints(
                    x, pairs, [&](Index u) { return s.IsHeld(u); }, progress.Slice(0.8, 0.95));
                std::vector<Index> componentOf;
                const Index components =
                    ConnectedComponents(s.graph.adjacency, componentOf, progress.Slice(0.95, 0.96), findingNeighbours);
                pairs.same = ClumpsOf(x, componentOf, components, progress.Slice(0.96, 1));
                if (pairs.same.empty()) {
                    s.report.oneSided = Index(pairs.oneSided);
                    s.nodeArea = std::move(pairs.area);
                    for (Index u = 0; u < s.graph.Size(); ++u)
                        s.nodeArea[u] = s.IsHeld(u) ? 0 : s.nodeArea[u];
                    LeaveOutHeldApart();
                    return EdgeLengths(s.graph, progress.threads);
                }
            }
            DisjointSets joined(Index(s.graph.position.cols()));
            for (const auto &each : pairs.same)
                joined.Join(each.first, each.second);
            std::vector<Index> into = joined.TakeRoots();
            for (Index u = 0; u < Index(into.size()); ++u)
                s.report.welded += into[u] != u;
            JoinNodes(std::move(into), {});
        }
    }

    /// Drops the held nodes of a cloud that have no free neighbour and no free vertex. They were read to find the free
    /// points' neighbours; nothing that is free depends on them.
    void LeaveOutHeldApart() {
        Csr &adjacency = s.graph.adjacency;
        const Index n = s.graph.Size();
        std::vector<char> isApart(n, 0);
        for (Index u = 0; u < n; ++u)
            isApart[u] = s.IsHeld(u) &&
                         std::all_of(adjacency[u].begin(), adjacency[u].end(), [&](Index v) { return s.IsHeld(v); });
        if (std::find(isApart.begin(), isApart.end(), 1) == isApart.end())
            return;
        for (std::uint32_t slot : s.slots)
            if (tag[slot] == 1 && s.nodeOf[slot] >= 0)
                isApart[s.nodeOf[slot]] = 0;
        JoinNodes({}, isApart);
        std::uint32_t first = 0, kept = 0; // items
        for (Index u = 0; u < n; ++u) {
            const std::uint32_t last = adjacency.begin[u + 1];
            if (const Index now = newIndex[u]; now >= 0) {
                for (std::uint32_t i = first; i < last; ++i)
                    if (const Index v = newIndex[adjacency.item[i]]; v >= 0)
                        adjacency.item[kept++] = v;
                adjacency.begin[now + 1] = kept;
                s.nodeArea[now] = s.nodeArea[u];
            }
            first = last;
        }
        const auto nodes = std::size_t(s.graph.position.cols());
        adjacency.begin.resize(nodes + 1);
        adjacency.item.resize(kept);
        s.nodeArea.resize(nodes);
    }

    /// Welds nodes; sets newIndex. \param into as in Seams \param leftOut flags of nodes, or empty: nodes that are
    /// dropped unless another node is welded to them
    void JoinNodes(std::vector<Index> into, const std::vector<char> &leftOut) {
        Eigen::Matrix3Xf &x = s.graph.position;
        const Index n = Index(x.cols());
        if (into.empty()) {
            into.resize(n);
            std::iota(into.begin(), into.end(), 0);
        }
        newIndex.assign(n, -1);
        for (Index u = 0; u < n; ++u)
            if (leftOut.empty() || !leftOut[u])
                newIndex[into[u]] = 0;
        Index kept = 0;
        for (Index u = 0; u < n; ++u)
            if (newIndex[u] >= 0) {
                newIndex[u] = kept;
                x.col(kept++) = Eigen::Vector3f(x.col(u));
            }
        for (Index u = 0; u < n; ++u)
            newIndex[u] = newIndex[into[u]];
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
    }

    const SurfaceView &mesh;
    const Region *region; // nullptr: all of the mesh
    const std::vector<int> &tag;
    const Progress &progress;
    const double weldDistance;
    const std::size_t slots;
    bool hasSeams;
    VertexChunks chunks;               // of the parts, and of the vertices beside
    std::vector<unsigned char> beside; // flags of the slots of FindBeside; empty: none
    std::vector<Index> newIndex;       // of each node before the last JoinNodes; -1: dropped
    SurfaceGraph s;
};

} // namespace detail

SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Region *region, const std::vector<int> &tag,
                               const Eigen::Matrix3d &metric, const Progress &progress, double weldDistance) {
    assert(!region || tag.size() == mesh.vertexSlots);
    return detail::SurfaceReader(mesh, region, tag, metric, progress, weldDistance).Read();
}

SurfaceGraph BuildSurfaceGraph(const SurfaceView &mesh, const Progress &progress) {
    return BuildSurfaceGraph(mesh, nullptr, {}, Eigen::Matrix3d::Identity(), progress);
}

} // namespace vcg::fcd
