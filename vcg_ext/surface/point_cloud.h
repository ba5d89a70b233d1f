// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POINT_CLOUD_H
#define VCG_FCD_POINT_CLOUD_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/sort_short.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>
#include <vcg_ext/surface/triangle_graph.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// The name of the stage, for Progress.
constexpr const char *findingNeighbours = "Finding neighbours";

/// The neighbours of a cloud's n points.
struct CloudPairs {
    std::unique_ptr<Index[]> neighbour;        ///< n x each, ascending for each point
    std::size_t each = 0;                      ///< neighbours a point
    std::vector<float> area;                   ///< n: that each point stands for
    std::vector<std::pair<Index, Index>> same; ///< points to weld, the smaller number first
    std::size_t inClumps = 0;                  ///< points in clumps (CloudNeighbourhood::apart)
    std::size_t oneSided = 0;                  ///< points whose surroundings all lie along a line

    const Index *Row(Index u) const { return neighbour.get() + std::size_t(u) * each; }
    bool Has(Index u, Index v) const {
        const Index *row = Row(u);
        bool has = false;
        if (each == cloudNeighbours) // a fixed number is compared at once
            for (int k = 0; k < cloudNeighbours; ++k)
                has |= row[k] == v;
        else
            has = std::find(row, row + each, v) != row + each;
        return has;
    }
};

/// Finds the neighbours of all points, and those to weld.
/// \param position in Morton order, for speed \param hair points within it are welded, units of positions
/// \param clumps points of a clump are welded, too
inline CloudPairs PairNeighbours(const Eigen::Matrix3Xf &position, float hair, bool clumps, const Progress &progress) {
    const PointTree<float> points(position, progress.threads);
    const std::size_t n = points.Size(), grain = 1 << 8;
    CloudPairs pairs;
    pairs.each = std::min<std::size_t>(cloudNeighbours, n - 1);
    pairs.neighbour = LargeArray<Index>(n * pairs.each);
    AssignLarge(pairs.area, n, 0.f);
    struct Part {
        std::vector<std::pair<Index, Index>> same;
        std::size_t inClumps = 0, oneSided = 0;
    };
    std::vector<Part> parts((points.Blocks() + grain - 1) / grain);
    ParallelFor(progress, findingNeighbours, points.Blocks(), grain, [&](std::size_t first, std::size_t last) {
        CloudNeighbourhood<float> found(points);
        Part part;
        for (std::size_t at = points.Begin(first); at < points.Begin(last); ++at) {
            const Index i = points.Number(at);
            found.Look(at);
            const std::vector<Index> &neighbours = found.Neighbours(clumps);
            std::copy(neighbours.begin(), neighbours.end(), pairs.neighbour.get() + std::size_t(i) * pairs.each);
            pairs.area[i] = float(found.area);
            part.inClumps += found.here > 0;
            part.oneSided += found.isOneSided;
            found.ForEachWithin(std::max(double(hair), clumps ? found.here : 0),
                                [&](Index j) { part.same.emplace_back(std::minmax(i, j)); });
        }
        parts[first / grain] = std::move(part);
    });
    for (const Part &part : parts) {
        pairs.inClumps += part.inClumps;
        pairs.oneSided += part.oneSided;
    }
    pairs.same = Together(parts, &Part::same);
    return pairs;
}

/// The graph with an edge between two points if either is a neighbour of the other. The neighbours of a held point
/// depend on how many points around it are read. So between a free and a held point, only the free one's neighbours
/// count.
/// \param isHeld isHeld(point) \throw BadInput more edges than indices can number
template <class IsHeld>
Csr ConnectPoints(const Eigen::Matrix3Xf &position, const CloudPairs &pairs, const IsHeld &isHeld,
                  const Progress &progress) {
    const Index n = Index(position.cols());
    const std::size_t grain = 1 << 14, chunks = (std::size_t(n) + grain - 1) / grain;
    const auto counts = [&](Index u, Index v) { return !isHeld(u) || isHeld(v); }; // that v is a neighbour of u
    // Neighbours in one direction only: v, and the point u that has v as its neighbour.
    std::vector<std::vector<std::pair<Index, Index>>> oneWay(chunks);
    const std::unique_ptr<std::atomic<std::uint32_t>[]> more(new std::atomic<std::uint32_t>[n]);
    ParallelForEach(progress.threads, std::size_t(n), grain,
                    [&](std::size_t u) { more[u].store(0, std::memory_order_relaxed); });
    ParallelFor(progress.Slice(0, 0.4), findingNeighbours, std::size_t(n), grain,
                [&](std::size_t first, std::size_t last) {
                    auto &list = oneWay[first / grain];
                    list.reserve(2 * (last - first));
                    for (Index u = Index(first); u < Index(last); ++u)
                        for (const Index *v = pairs.Row(u); v < pairs.Row(u) + pairs.each; ++v)
                            if (counts(u, *v) && !(pairs.Has(*v, u) && counts(*v, u))) {
                                more[*v].fetch_add(1, std::memory_order_relaxed);
                                list.emplace_back(*v, u);
                            }
                });
    Csr graph;
    AssignLarge(graph.begin, std::size_t(n) + 1, 0u);
    std::size_t items = 0;
    for (Index u = 0; u < n; ++u) {
        items +=
            std::size_t(std::count_if(pairs.Row(u), pairs.Row(u) + pairs.each, [&](Index v) { return counts(u, v); }));
        items += more[u].load(std::memory_order_relaxed);
        graph.begin[u + 1] = std::uint32_t(items);
    }
    CheckEdges(items);
    AssignLarge(graph.item, items, 0);
    ParallelFor(progress.Slice(0.4, 0.7), findingNeighbours, std::size_t(n), grain,
                [&](std::size_t first, std::size_t last) {
                    for (Index u = Index(first); u < Index(last); ++u)
                        std::copy_if(pairs.Row(u), pairs.Row(u) + pairs.each, graph.item.data() + graph.begin[u],
                                     [&](Index v) { return counts(u, v); });
                    for (const auto &[v, u] : oneWay[first / grain]) // in any order; sorted below
                        graph.item[graph.begin[v + 1] - more[v].fetch_sub(1, std::memory_order_relaxed)] = u;
                });
    ParallelForEach(progress.Slice(0.7, 1), findingNeighbours, std::size_t(n), grain, [&](std::size_t u) {
        SortShort(graph.item.data() + graph.begin[u], graph.item.data() + graph.begin[u + 1]);
    });
    return graph;
}

/// The sum of the lengths of a graph's edges.
inline double EdgeLengths(const Graph &graph, unsigned threads) {
    const auto n = std::size_t(graph.Size()), grain = std::size_t(1) << 14;
    std::vector<double> lengths((n + grain - 1) / grain, 0);
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        for (Index u = Index(first); u < Index(last); ++u)
            for (Index v : graph.adjacency[u])
                if (u < v)
                    lengths[first / grain] += (graph.position.col(v) - graph.position.col(u)).norm();
    });
    return std::accumulate(lengths.begin(), lengths.end(), 0.0);
}

/// Finds clumps of so many points that all neighbours are inside of them: components of the graph that are much smaller
/// than their distance to the next one.
/// \param componentOf, components as in ConnectedComponents
/// \return pairs of points to weld; none unless most of the cloud's points are in clumps, since parts of a cloud that
/// lie far apart are no clumps
inline std::vector<std::pair<Index, Index>> ClumpsOf(const Eigen::Matrix3Xf &position,
                                                     const std::vector<Index> &componentOf, Index components,
                                                     const Progress &progress) {
    const Index n = Index(position.cols());
    std::vector<Index> firstOf(components, -1); // the first point of its component
    if (firstOf.size() < 2)
        return {};
    DisjointSets joined(n);
    for (Index u = 0; u < n; ++u) {
        Index &begins = firstOf[componentOf[u]];
        begins = begins < 0 ? u : begins;
        joined.Join(begins, u);
    }
    std::vector<std::pair<Index, Index>> same;
    std::vector<Eigen::AlignedBox3f> box;
    std::vector<Index> alone; // the first node of each component
    for (bool isNew = true; isNew;) {
        alone.clear();
        box.assign(n, Eigen::AlignedBox3f());
        for (Index u = 0; u < n; ++u) {
            if (joined.Root(u) == u)
                alone.push_back(u);
            box[joined.Root(u)].extend(Eigen::Vector3f(position.col(u)));
        }
        if (alone.size() < 2)
            return same;
        progress(0, findingNeighbours);
        const std::unique_ptr<PointTree<float>> tree = TreeOf(position, alone);
        std::vector<PointTree<float>::Neighbour> nearest;
        isNew = false;
        std::vector<char> isClump(n, 0);
        for (Index u : alone) {
            tree->Nearest(position.col(u), 2, nearest);
            for (const auto &each : nearest) {
                const Index v = alone[std::size_t(each.point)];
                if (v == u)
                    continue;
                const double sizes = double(box[u].diagonal().norm()) + double(box[v].diagonal().norm());
                isClump[u] = sizes * CloudNeighbourhood<float>::apart <= std::sqrt(double(each.square));
                if (std::sqrt(double(each.square)) <= sizes && joined.Root(u) != joined.Root(v)) { // halves of a clump
                    joined.Join(u, v);
                    isNew = true;
                }
            }
        }
        if (!isNew)
            for (Index u : alone)
                if (isClump[u])
                    box[u].setEmpty();
    }
    for (Index u = 0; u < n; ++u)
        if (const Index a = joined.Root(u); a != u && box[a].isEmpty())
            same.emplace_back(a, u);
    if (2 * same.size() < std::size_t(n))
        same.clear();
    return same;
}

} // namespace vcg::fcd::detail

#endif
