// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/memory.h>
#include <vcg_ext/surface/part_removal.h>
#include <vcg_ext/surface/triangle_graph.h>
#include <vcg_ext/surface/vertex_chunks.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

namespace vcg {
namespace fcd {

namespace {

/// Takes parts out of a surface, as RemoveParts tells.
class PartRemover {
  public:
    PartRemover(const SurfaceView &mesh, const std::vector<Index> &partOf, const Progress &progress,
                SurfaceGraph &surface)
        : mesh(mesh), partOf(partOf), progress(progress), s(surface) {}

    bool Remove() {
        // What is a hair from something is known of all that was read, and not of what is left.
        if (s.report.pointCloud || s.report.seams > 0 || s.report.gaps > 0 ||
            s.slots.size() != std::size_t(s.report.vertices))
            return false;
        const auto stays = [&](std::size_t i) { return s.nodeOf[i] >= 0 && partOf[i] < 0; };
        const detail::VertexChunks left = detail::FindVertices(mesh, stays, s.frame, progress.Slice(0, 0.2));
        if (left.Live() == 0)
            return false;
        Frame frame = s.frame;
        detail::SetFrame(mesh, left, stays, frame);
        if (frame.origin != s.frame.origin || frame.scale != s.frame.scale)
            return false;
        Number();
        RemoveFaces();
        RemoveNodes();
        RemoveVertices(Index(left.Live()));
        return true;
    }

  private:
    static constexpr std::size_t grain = 1 << 16;

    /// The numbers of nodes that stay.
    void Number() {
        const std::size_t n = std::size_t(s.graph.Size());
        AssignLarge(newIndex, n, Index(-1));
        ParallelFor(progress.Slice(0.2, 0.3), readingStage, s.slots.size(), grain,
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t at = first; at < last; ++at) { // those of a node follow each other
                            const Index node = s.nodeOf[s.slots[at]];
                            if (at == 0 || s.nodeOf[s.slots[at - 1]] != node)
                                newIndex[std::size_t(node)] = partOf[s.slots[at]] < 0 ? 0 : -1;
                        }
                    });
        for (Index &each : newIndex)
            if (each == 0)
                each = kept++;
    }

    /// Takes out faces, and what was told of them.
    void RemoveFaces() {
        const auto goes = [&](std::uint32_t face) { return partOf[mesh.corner[3 * std::size_t(face)]] >= 0; };
        SurfaceReport &report = s.report;
        if (report.degenerateFaces > 0 || report.nonManifoldEdges > 0 || report.repeatedFaces > 0) {
            std::vector<std::uint32_t> gone;
            std::copy_if(s.faces.begin(), s.faces.end(), std::back_inserter(gone), goes);
            const detail::TriangleList list = detail::ElementTriangles(
                mesh, &gone, s.nodeOf, [](Index) { return false; }, progress.Slice(0.3, 0.4));
            const detail::TriangleGraph connected =
                detail::ConnectTriangles(s.graph.position, list.corner.get(), list.count, progress.Slice(0.4, 0.6));
            report.degenerateFaces -= list.degenerateFaces;
            report.nonManifoldEdges -= connected.nonManifoldEdges;
            report.repeatedFaces -= connected.repeatedFaces;
        }
        s.faces.erase(std::remove_if(s.faces.begin(), s.faces.end(), goes), s.faces.end());
    }

    void RemoveNodes() {
        const Graph whole = std::move(s.graph);
        const std::vector<float> area = std::move(s.nodeArea);
        const std::vector<Index> tag = std::move(s.tag);
        s.graph.isCloud = whole.isCloud;
        s.graph.position.resize(3, kept);
        PreferLargePages(s.graph.position.data(), std::size_t(kept) * sizeof(Eigen::Vector3f));
        AssignLarge(s.nodeArea, std::size_t(kept), 0.f);
        AssignLarge(s.tag, std::size_t(kept), Index(1));
        Csr &adjacency = s.graph.adjacency;
        AssignLarge(adjacency.begin, std::size_t(kept) + 1, 0u);
        for (Index u = 0; u < whole.Size(); ++u)
            if (const Index to = newIndex[std::size_t(u)]; to >= 0)
                adjacency.begin[std::size_t(to) + 1] =
                    adjacency.begin[std::size_t(to)] + std::uint32_t(whole.adjacency[u].size());
        AssignLarge(adjacency.item, adjacency.begin.back(), Index(0));
        ParallelFor(progress.Slice(0.6, 0.8), readingStage, std::size_t(whole.Size()), grain,
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t u = first; u < last; ++u)
                            if (const Index to = newIndex[u]; to >= 0) {
                                s.graph.position.col(to) = whole.position.col(Index(u));
                                s.nodeArea[std::size_t(to)] = area[u];
                                s.tag[std::size_t(to)] = tag[u];
                                std::uint32_t at = adjacency.begin[std::size_t(to)];
                                for (Index v : whole.adjacency[Index(u)])
                                    adjacency.item[at++] = newIndex[std::size_t(v)];
                            }
                    });
        const double lengths = detail::SumOfEdges(s.graph.position, adjacency, progress.Slice(0.8, 0.9));
        s.averageEdge = adjacency.item.empty() ? 0 : 2 * lengths / double(adjacency.item.size());
        s.area = 0;
        s.report.isolated = 0;
        for (Index u = 0; u < kept; ++u) {
            s.area += s.nodeArea[std::size_t(u)];
            s.report.isolated += adjacency[u].size() == 0;
        }
    }

    void RemoveVertices(Index left) {
        ParallelFor(progress.Slice(0.9, 1), readingStage, s.nodeOf.size(), grain,
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t i = first; i < last; ++i)
                            if (s.nodeOf[i] >= 0)
                                s.nodeOf[i] = newIndex[std::size_t(s.nodeOf[i])];
                    });
        s.slots.erase(std::remove_if(s.slots.begin(), s.slots.end(), [&](std::uint32_t i) { return s.nodeOf[i] < 0; }),
                      s.slots.end());
        s.report.vertices = left;
        s.report.welded = left - kept;
    }

    const SurfaceView &mesh;
    const std::vector<Index> &partOf;
    const Progress &progress;
    SurfaceGraph &s;
    std::vector<Index> newIndex; // of each node, -1 for one that goes
    Index kept = 0;
};

} // namespace

bool RemoveParts(const SurfaceView &mesh, const std::vector<Index> &partOf, const Progress &progress,
                 SurfaceGraph &surface) {
    return PartRemover(mesh, partOf, progress, surface).Remove();
}

} // namespace fcd
} // namespace vcg
