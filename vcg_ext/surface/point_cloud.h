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

namespace vcg {
namespace fcd {
namespace detail {

/// What Progress calls the time in which the points of a cloud are joined.
constexpr const char *findingNeighbours = "Finding neighbours";

/// The neighbours of a cloud's points.
struct CloudPairs {
    std::unique_ptr<Index[]> neighbour;        ///< of each point, ascending; the point itself fills up
    int each = 0;                              ///< neighbours a point, those that fill up included
    std::vector<float> area;                   ///< that each point stands for
    std::vector<std::pair<Index, Index>> same; ///< at one place, the smaller first
    std::size_t inClumps = 0;                  ///< points that are much nearer to others than these to the next ones
};

/// \pre points that are near have numbers that are close (Morton order), for speed \param hair units of positions
/// \param clumps as CloudNeighbourhood finds them are at one place, of any number of points
inline CloudPairs PairNeighbours(const Eigen::Matrix3Xf &position, float hair, bool clumps, const Progress &progress) {
    const auto n = std::size_t(position.cols());
    const auto at = [&](std::size_t i) { return Eigen::Vector3f(position.col(Eigen::Index(i))); };
    const std::unique_ptr<PointTree<float>> tree = TreeOf(position);
    const std::size_t wanted = std::min<std::size_t>(cloudNeighbours, n - 1), grain = 1 << 12;
    CloudPairs pairs;
    pairs.each = int(wanted);
    pairs.neighbour = LargeArray<Index>(n * wanted);
    AssignLarge(pairs.area, n, 0.f);
    std::vector<std::vector<std::pair<Index, Index>>> same((n + grain - 1) / grain);
    std::vector<std::size_t> inClumps(same.size(), 0);
    ParallelFor(progress, findingNeighbours, n, grain, [&](std::size_t first, std::size_t last) {
        CloudNeighbourhood<float> found(*tree, n);
        for (std::size_t i = first; i < last; ++i) {
            found.Look(i, at);
            const std::vector<Index> &neighbours = found.Neighbours(clumps);
            Index *to = pairs.neighbour.get() + i * wanted;
            std::fill(std::copy(neighbours.begin(), neighbours.end(), to), to + wanted, Index(i));
            pairs.area[i] = float(found.area);
            inClumps[first / grain] += found.here > 0;
            const double reach = std::max(double(hair), clumps ? found.here : 0);
            for (Index j : found.around) { // the nearest first
                if (!((at(std::size_t(j)) - at(i)).cast<double>().norm() <= reach))
                    break;
                same[first / grain].emplace_back(std::minmax(Index(i), j));
            }
        }
    });
    pairs.inClumps = std::accumulate(inClumps.begin(), inClumps.end(), std::size_t(0));
    for (const auto &each : same)
        pairs.same.insert(pairs.same.end(), each.begin(), each.end());
    return pairs;
}

/// Joins each point with its neighbours, and with those that it is a neighbour of. \param edgeLengths sum, out
inline Csr ConnectPoints(const Eigen::Matrix3Xf &position, const CloudPairs &pairs, double &edgeLengths,
                         const Progress &progress) {
    const Index n = Index(position.cols());
    const std::size_t grain = 1 << 14, chunks = (std::size_t(n) + grain - 1) / grain;
    const auto row = [&](Index u) {
        const Index *first = pairs.neighbour.get() + std::size_t(u) * std::size_t(pairs.each);
        return Csr::Row{first, first + pairs.each};
    };
    // Those that a point is a neighbour of, where it is not the same the other way round.
    std::vector<std::vector<std::pair<Index, Index>>> oneWay(chunks);
    const std::unique_ptr<std::atomic<std::uint32_t>[]> count(new std::atomic<std::uint32_t>[std::size_t(n)]);
    ParallelFor(progress.threads, std::size_t(n), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t u = first; u < last; ++u)
            count[u].store(0, std::memory_order_relaxed);
    });
    ParallelFor(progress.Slice(0, 0.4), findingNeighbours, std::size_t(n), grain,
                [&](std::size_t first, std::size_t last) {
                    auto &list = oneWay[first / grain];
                    list.reserve(2 * (last - first));
                    for (Index u = Index(first); u < Index(last); ++u)
                        for (Index v : row(u)) {
                            if (v == u)
                                continue;
                            count[u].fetch_add(1, std::memory_order_relaxed);
                            const Csr::Row others = row(v);
                            if (std::find(others.begin(), others.end(), u) == others.end()) {
                                count[v].fetch_add(1, std::memory_order_relaxed);
                                list.emplace_back(v, u);
                            }
                        }
                });
    Csr graph;
    AssignLarge(graph.begin, std::size_t(n) + 1, 0u);
    std::size_t items = 0;
    for (Index u = 0; u < n; ++u) {
        items += count[u].load(std::memory_order_relaxed);
        graph.begin[u + 1] = std::uint32_t(items);
    }
    CheckEdges(items);
    AssignLarge(graph.item, items, 0);
    const auto put = [&](Index u, Index v) { // in any order, which is mended below
        graph.item[graph.begin[u] + count[u].fetch_sub(1, std::memory_order_relaxed) - 1] = v;
    };
    ParallelFor(progress.Slice(0.4, 0.7), findingNeighbours, std::size_t(n), grain,
                [&](std::size_t first, std::size_t last) {
                    for (Index u = Index(first); u < Index(last); ++u)
                        for (Index v : row(u))
                            if (v != u)
                                put(u, v);
                    for (const auto &each : oneWay[first / grain])
                        put(each.first, each.second);
                });
    std::vector<double> lengths(chunks, 0);
    ParallelFor(
        progress.Slice(0.7, 1), findingNeighbours, std::size_t(n), grain, [&](std::size_t first, std::size_t last) {
            for (Index u = Index(first); u < Index(last); ++u) {
                Index *begin = graph.item.data() + graph.begin[u], *end = graph.item.data() + graph.begin[u + 1];
                SortShort(begin, end);
                for (const Index *v = begin; v < end; ++v)
                    if (u < *v)
                        lengths[first / grain] += (position.col(*v) - position.col(u)).norm();
            }
        });
    edgeLengths = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    return graph;
}

/// Where most of a cloud's points are in clumps, each without a neighbour outside of it and much smaller than the way
/// to the next one, the points of these as pairs at one place; else none: parts of a cloud that lie apart are no
/// clumps.
inline std::vector<std::pair<Index, Index>> ClumpsOf(const Eigen::Matrix3Xf &position, const Csr &adjacency,
                                                     const Progress &progress) {
    const Index n = Index(position.cols());
    std::vector<Index> first(n), componentOf(n); // the first point of its component
    std::vector<Index> firstOf(ConnectedComponents(adjacency, componentOf, progress, findingNeighbours), -1);
    if (firstOf.size() < 2)
        return {};
    for (Index u = 0; u < n; ++u) {
        Index &begins = firstOf[componentOf[u]];
        begins = begins < 0 ? u : begins;
        first[u] = begins;
    }
    const auto root = [&](Index u) {
        while (first[u] != u)
            u = first[u] = first[first[u]];
        return u;
    };
    std::vector<std::pair<Index, Index>> same;
    std::vector<Eigen::AlignedBox3f> box;
    std::vector<Index> alone; // the first node of each component
    for (bool isNew = true; isNew;) {
        alone.clear();
        box.assign(n, Eigen::AlignedBox3f());
        for (Index u = 0; u < n; ++u) {
            if (root(u) == u)
                alone.push_back(u);
            box[root(u)].extend(Eigen::Vector3f(position.col(u)));
        }
        if (alone.size() < 2)
            return same;
        progress(0, findingNeighbours);
        const std::unique_ptr<PointTree<float>> tree = TreeOf(position, alone);
        std::vector<PointTree<float>::Found> nearest;
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
                if (std::sqrt(double(each.square)) <= sizes && root(u) != root(v)) { // two halves of one
                    first[std::max(root(u), root(v))] = std::min(root(u), root(v));
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
        if (const Index a = root(u); a != u && box[a].isEmpty())
            same.emplace_back(a, u);
    if (2 * same.size() < std::size_t(n))
        same.clear();
    return same;
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
