// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SEAMS_H
#define VCG_FCD_SEAMS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Open borders of a surface of n nodes that run along each other.
struct Seams {
    std::vector<Index> into; ///< n, the smallest node that each is welded to, mostly itself; empty: no node is welded
    Index joined = 0;        ///< nodes that are welded to a smaller one
    Index gaps = 0;          ///< nodes not welded, though nearer to another border's node than a tenth of an edge
};

/// Finds the nodes on open borders to weld: those within \p distance of each other, if one of them is free or both are
/// held by one tag. (If held ones were not welded, a held region of unwelded triangles would have single nodes along
/// its border.) \param open n flags: nodes on open borders \param tag as of SurfaceGraph \param distance units of the
/// graph's positions, >= 0 \param beside n flags, or empty: nodes that are welded to free ones only
inline Seams FindSeams(const Graph &graph, const std::vector<char> &open, const std::vector<Index> &tag,
                       double distance, const Progress &progress = {}, const std::vector<char> &beside = {}) {
    Seams seams;
    // Sort the nodes along one of three oblique directions: the one in which they reach farthest, so that few of them
    // share a position along it.
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    float farthest = -1;
    for (const Eigen::Vector3f &each :
         {Eigen::Vector3f(0.5773f, 0.6144f, 0.5378f), Eigen::Vector3f(-0.7412f, 0.1317f, 0.6583f),
          Eigen::Vector3f(0.3171f, -0.7793f, 0.5403f)}) {
        Eigen::AlignedBox<float, 1> along;
        for (Index u = 0; u < graph.Size(); ++u)
            if (open[u])
                along.extend(Eigen::Matrix<float, 1, 1>(each.dot(graph.position.col(u))));
        if (const float reach = along.isEmpty() ? 0 : along.sizes()[0]; reach > 1.5f * farthest) { // mostly the first
            farthest = reach;
            direction = each.normalized();
        }
    }
    struct Place {
        float along, reach; // along: position in the direction; reach: a tenth of the shortest edge
        Index node, first;  // first: its first neighbour, or -1
        std::size_t others; // index of the next place with another first neighbour; skips the nodes of a long fan
        bool operator<(const Place &o) const { return along != o.along ? along < o.along : node < o.node; }
    };
    std::vector<Place> place;
    for (Index u = 0; u < graph.Size(); ++u)
        if (open[u]) {
            const Eigen::Vector3f p = graph.position.col(u);
            float shortest = std::numeric_limits<float>::infinity();
            const Csr::Row neighbours = graph.adjacency[u];
            for (Index v : neighbours)
                shortest = std::min(shortest, (graph.position.col(v) - p).norm());
            place.push_back({direction.dot(p), std::isinf(shortest) ? 0 : 0.1f * shortest, u,
                             neighbours.size() ? neighbours[0] : -1, 0});
        }
    std::sort(place.begin(), place.end());
    for (std::size_t i = place.size(); i-- > 0;)
        place[i].others = i + 1 < place.size() && place[i + 1].first == place[i].first ? place[i + 1].others : i + 1;

    const auto isFree = [&](Index u) { return tag.empty() || tag[u] == 1; };
    const auto isBeside = [&](Index u) { return !beside.empty() && beside[u]; };
    const auto areNeighbours = [&](Index u, Index v) { // or have a common neighbour
        if (graph.adjacency[u].size() > graph.adjacency[v].size())
            std::swap(u, v); // the centre of a fan has very many
        const Csr::Row few = graph.adjacency[u], many = graph.adjacency[v];
        return std::any_of(few.begin(), few.end(),
                           [&](Index w) { return w == v || std::binary_search(many.begin(), many.end(), w); });
    };
    struct Pair {
        Index u, v;
        bool same;
    };
    const std::vector<Pair> pairs =
        CollectInOrder<Pair>(progress, readingStage, Index(place.size()), [&](Index i, std::vector<Pair> &found) {
            const Place &a = place[i];
            const Eigen::Vector3f p = graph.position.col(a.node);
            const float hair = float(distance) + 2e-7f, reach = std::max(a.reach + 2e-7f, hair); // rounding
            for (std::size_t j = std::size_t(i) + 1; j < place.size() && place[j].along - a.along <= reach; ++j) {
                const Place &b = place[j];
                if (b.first == a.first && b.along - a.along > hair) { // a common neighbour: no gap
                    j = b.others - 1;
                    continue;
                }
                const bool areHeld = !isFree(a.node) && !isFree(b.node);
                if (areHeld && (tag[a.node] != tag[b.node] || isBeside(a.node) || isBeside(b.node)))
                    continue;
                const float d = (graph.position.col(b.node) - p).norm();
                const bool same = d <= distance;
                if (same || (!areHeld && d <= std::min(a.reach, b.reach) && !areNeighbours(a.node, b.node)))
                    found.push_back({std::min(a.node, b.node), std::max(a.node, b.node), same});
            }
        });
    if (pairs.empty())
        return seams;
    DisjointSets joined(graph.Size());
    for (const Pair &p : pairs)
        if (p.same)
            joined.Join(p.u, p.v);
    std::vector<Index> into = joined.TakeRoots();
    std::vector<char> gap(graph.Size(), 0);
    for (const Pair &p : pairs)
        if (!p.same && into[p.u] != into[p.v])
            gap[p.u] = gap[p.v] = 1;
    for (Index u = 0; u < graph.Size(); ++u) {
        seams.joined += into[u] != u;
        seams.gaps += gap[u] && into[u] == u;
    }
    if (seams.joined > 0)
        seams.into = std::move(into);
    return seams;
}

} // namespace vcg::fcd

#endif
