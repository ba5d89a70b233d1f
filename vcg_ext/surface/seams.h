// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SEAMS_H
#define VCG_FCD_SEAMS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

namespace detail {

constexpr float alongRounding = 2e-7f; // of positions on a line

/// The nodes on open borders along a line: position on it and node, ascending. The line has one of three oblique
/// directions: the one in which the nodes spread farthest, so that few share a position.
inline std::vector<std::pair<float, Index>> BordersAlongLine(const Graph &graph, const std::vector<char> &open) {
    std::vector<std::pair<float, Index>> border;
    for (Index u = 0; u < graph.Size(); ++u)
        if (open[u])
            border.emplace_back(0.f, u);
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float farthest = -1;
    for (const Eigen::Vector3f &each :
         {Eigen::Vector3f(0.5773f, 0.6144f, 0.5378f), Eigen::Vector3f(-0.7412f, 0.1317f, 0.6583f),
          Eigen::Vector3f(0.3171f, -0.7793f, 0.5403f)}) {
        Eigen::AlignedBox<float, 1> along;
        for (const auto &[at, u] : border)
            along.extend(Eigen::Matrix<float, 1, 1>(each.dot(graph.position.col(u))));
        if (const float reach = along.isEmpty() ? 0 : along.sizes()[0]; reach > 1.5f * farthest) { // mostly the first
            farthest = reach;
            direction = each.normalized();
        }
    }
    for (auto &[at, u] : border)
        at = direction.dot(graph.position.col(u));
    std::sort(border.begin(), border.end());
    return border;
}

} // namespace detail

/// Nodes of a surface to weld, as open borders run along each other.
struct Seams {
    std::vector<Index> into; ///< per node, the smallest one that it is welded to, mostly itself; empty: none is welded
    Index joined = 0;        ///< nodes that are welded to a smaller one
};

/// Finds the nodes on open borders to weld: those within \p distance of each other, if one of them is free or both are
/// held by one tag. (If held ones were not welded, a held region of unwelded triangles would have single nodes along
/// its border.) \param open flag of each node: it is on an open border \param tag as in SurfaceGraph \param distance
/// units of the graph's positions, >= 0 \param beside flag of each node, or empty: it is welded to free ones only
inline Seams FindSeams(const Graph &graph, const std::vector<char> &open, const std::vector<Index> &tag,
                       double distance, const Progress &progress = {}, const std::vector<char> &beside = {}) {
    const auto place = detail::BordersAlongLine(graph, open);
    const auto isFree = [&](Index u) { return tag.empty() || tag[u] == 1; };
    const auto isBeside = [&](Index u) { return !beside.empty() && beside[u]; };
    const float reach = float(distance) + detail::alongRounding;
    const auto pairs = CollectInOrder<std::pair<Index, Index>>(
        progress, readingStage, place.size(), [&](std::size_t i, std::vector<std::pair<Index, Index>> &found) {
            const auto [along, u] = place[i];
            for (std::size_t j = i + 1; j < place.size() && place[j].first - along <= reach; ++j) {
                const Index v = place[j].second;
                const bool areHeld = !isFree(u) && !isFree(v);
                if (areHeld && (tag[u] != tag[v] || isBeside(u) || isBeside(v)))
                    continue;
                if ((graph.position.col(v) - graph.position.col(u)).norm() <= distance)
                    found.emplace_back(u, v);
            }
        });
    Seams seams;
    if (pairs.empty())
        return seams;
    DisjointSets joined(graph.Size());
    for (const auto &[u, v] : pairs)
        joined.Join(u, v);
    seams.into = joined.TakeRoots();
    for (Index u = 0; u < graph.Size(); ++u)
        seams.joined += seams.into[u] != u;
    return seams;
}

/// Counts the nodes on open borders that are nearer to another border's node than a tenth of the shortest edge of
/// both, after seams are welded. One of the two is free. (Before, a corner of a long triangle would have long edges
/// alone, and many nodes within a tenth of these.) \param open, tag as in FindSeams
inline Index CountGaps(const Graph &graph, const std::vector<char> &open, const std::vector<Index> &tag,
                       const Progress &progress = {}) {
    struct Place {
        float along, reach; // along: position on the line; reach: a tenth of the shortest edge
        Index node, first;  // first: its first neighbour, or -1
        std::size_t others; // index of the next place with another first neighbour; skips the nodes of a long fan
    };
    std::vector<Place> place;
    for (const auto &[along, u] : detail::BordersAlongLine(graph, open)) {
        const Eigen::Vector3f p = graph.position.col(u);
        float shortest = std::numeric_limits<float>::infinity();
        const Csr::Row neighbours = graph.adjacency[u];
        for (Index v : neighbours)
            shortest = std::min(shortest, (graph.position.col(v) - p).norm());
        place.push_back(
            {along, std::isinf(shortest) ? 0 : 0.1f * shortest, u, neighbours.size() ? neighbours[0] : -1, 0});
    }
    for (std::size_t i = place.size(); i-- > 0;)
        place[i].others = i + 1 < place.size() && place[i + 1].first == place[i].first ? place[i + 1].others : i + 1;

    const auto isFree = [&](Index u) { return tag.empty() || tag[u] == 1; };
    const auto areNeighbours = [&](Index u, Index v) { // or have a common neighbour
        if (graph.adjacency[u].size() > graph.adjacency[v].size())
            std::swap(u, v); // the centre of a fan has very many
        const Csr::Row few = graph.adjacency[u], many = graph.adjacency[v];
        return std::any_of(few.begin(), few.end(),
                           [&](Index w) { return w == v || std::binary_search(many.begin(), many.end(), w); });
    };
    const std::unique_ptr<std::atomic<bool>[]> isAtGap(new std::atomic<bool>[place.size()]());
    ParallelFor(progress, readingStage, place.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Place &a = place[i];
            const float reach = a.reach + detail::alongRounding;
            for (std::size_t j = i + 1; j < place.size() && place[j].along - a.along <= reach; ++j) {
                const Place &b = place[j];
                if (b.first == a.first) { // a common neighbour: no gap
                    j = b.others - 1;
                    continue;
                }
                if ((isAtGap[i] && isAtGap[j]) || (!isFree(a.node) && !isFree(b.node)))
                    continue;
                const float d = (graph.position.col(b.node) - graph.position.col(a.node)).norm();
                if (d <= std::min(a.reach, b.reach) && !areNeighbours(a.node, b.node))
                    isAtGap[i] = isAtGap[j] = true;
            }
        }
    });
    return Index(std::count(isAtGap.get(), isAtGap.get() + place.size(), true));
}

} // namespace vcg::fcd

#endif
