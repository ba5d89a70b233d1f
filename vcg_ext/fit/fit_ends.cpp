// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/fit/fit_ends.h>
#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace vcg::fcd {

namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();
// Each point has so many of the nearest ones as neighbours: more would join fingers that lie side by side. Points on
// the other side of something thin are none: the cosine between their normals is below `turned`.
constexpr std::size_t joinedTo = 8;
constexpr double turned = -0.5;
// Remoteness is measured from so many points, all over the surface.
constexpr std::size_t sources = 32;
// Within `around` (of the diagonal), an end is the remotest point: three spacings of 6000 points, so that the tips of
// two fingers that touch are two ends. And it is standsOut times as remote as the mean; on a ball, all points are
// within 2 %.
constexpr double around = 0.03, standsOut = 1.05;
// Ends farther apart than this (of the diagonal) do not belong together: more than half of an arm.
constexpr double apartAtMost = 0.35;
// Weight of a difference of remoteness over a distance: limbs turn by far more than they stretch.
constexpr double unlike = 2;

/// The graph of points and their neighbours. \param normal of each point
Graph Joined(const std::vector<Eigen::Vector3d> &place, const std::vector<Eigen::Vector3d> &normal) {
    const PointTree<double> tree(place);
    std::vector<std::vector<Index>> list(place.size());
    std::vector<PointTree<double>::Neighbour> nearest;
    Graph graph;
    graph.position.resize(3, Eigen::Index(place.size()));
    for (std::size_t i = 0; i < place.size(); ++i) {
        graph.position.col(Eigen::Index(i)) = place[i].cast<float>();
        tree.Nearest(place[i], 1 + 2 * joinedTo, nearest); // itself, and as many that may lie on the other side
        std::size_t joined = 0;
        for (const auto &other : nearest)
            if (const std::size_t j = std::size_t(other.point);
                j != i && normal[i].dot(normal[j]) >= turned && joined++ < joinedTo) {
                list[i].push_back(Index(j));
                list[j].push_back(Index(i));
            }
    }
    for (std::vector<Index> &each : list) {
        SortUnique(each);
        graph.adjacency.item.insert(graph.adjacency.item.end(), each.begin(), each.end());
        graph.adjacency.begin.push_back(std::uint32_t(graph.adjacency.item.size()));
    }
    return graph;
}

/// The distance of each point from one of them, along the surface; infinite in other parts.
std::vector<double> FarFrom(Index place, const Graph &graph) {
    std::vector<double> far, of(std::size_t(graph.Size()), unreached);
    const std::vector<Index> found = NodesWithin(graph, {place}, unreached, Ways::Edges, &far);
    for (std::size_t i = 0; i < found.size(); ++i)
        of[std::size_t(found[i])] = far[i];
    return of;
}

/// The index of the largest finite value.
Index Largest(const std::vector<double> &values) {
    Index largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isinf(values[i]) && (std::isinf(values[largest]) || values[i] > values[largest]))
            largest = Index(i);
    return largest;
}

/// Assigns a column to each row, no column twice, with the least sum of costs (Kuhn 1955, with Munkres' potentials).
/// \param cost no more rows than columns
std::vector<std::size_t> Assigned(const Eigen::MatrixXd &cost) {
    const std::size_t n = std::size_t(cost.rows()), m = std::size_t(cost.cols()), none = n;
    std::vector<std::size_t> rowOf(m + 1, none), before(m + 1), columnOf(n);
    std::vector<double> u(n + 1, 0), v(m + 1, 0);
    for (std::size_t row = 0; row < n; ++row) {
        std::vector<double> least(m, unreached);
        std::vector<char> used(m + 1, 0);
        std::size_t at = m; // an extra column without costs, to begin in
        rowOf[m] = row;
        while (rowOf[at] != none) {
            used[at] = 1;
            std::size_t next = m;
            double step = unreached;
            for (std::size_t j = 0; j < m; ++j) {
                if (used[j])
                    continue;
                const std::size_t i = rowOf[at];
                if (const double to = cost(Eigen::Index(i), Eigen::Index(j)) - u[i] - v[j]; to < least[j]) {
                    least[j] = to;
                    before[j] = at;
                }
                if (least[j] < step) {
                    step = least[j];
                    next = j;
                }
            }
            for (std::size_t j = 0; j <= m; ++j)
                if (used[j]) {
                    u[rowOf[j]] += step;
                    v[j] -= step;
                } else if (j < m) {
                    least[j] -= step;
                }
            at = next;
        }
        for (; at != m; at = before[at])
            rowOf[at] = rowOf[before[at]];
        rowOf[m] = none;
    }
    for (std::size_t j = 0; j < m; ++j)
        if (rowOf[j] != none)
            columnOf[rowOf[j]] = j;
    return columnOf;
}

} // namespace

std::vector<LimbEnd> EndsOfLimbs(const std::vector<Eigen::Vector3d> &place,
                                 const std::vector<Eigen::Vector3d> &normal) {
    if (place.empty()) // a surface without an area
        return {};
    const Graph graph = Joined(place, normal);
    // Evenly spread sources: farthest points (Gonzalez 1985), from an end of the part with the middle point on.
    std::vector<double> mean(place.size(), 0), least(place.size(), unreached);
    Index source = Largest(FarFrom(Index(place.size() / 2), graph));
    for (std::size_t k = 0; k < sources; ++k) {
        const std::vector<double> far = FarFrom(source, graph);
        for (std::size_t i = 0; i < place.size(); ++i) {
            mean[i] += far[i] / double(sources);
            least[i] = std::min(least[i], far[i]);
        }
        source = Largest(least);
    }
    double all = 0;
    std::size_t count = 0;
    for (const double each : mean)
        if (!std::isinf(each)) {
            all += each;
            ++count;
        }
    std::vector<LimbEnd> ends;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (std::isinf(mean[i]) || mean[i] * double(count) < standsOut * all)
            continue;
        const std::vector<Index> beside = NodesWithin(graph, {Index(i)}, around, Ways::Edges);
        if (std::all_of(beside.begin(), beside.end(),
                        [&](Index j) { return std::make_pair(mean[j], j) <= std::make_pair(mean[i], Index(i)); }))
            ends.push_back({i, place[i], mean[i]});
    }
    return ends;
}

std::vector<std::pair<std::size_t, std::size_t>> MatchEnds(const std::vector<LimbEnd> &a,
                                                           const std::vector<LimbEnd> &b) {
    // An extra column for each row: no counterpart.
    Eigen::MatrixXd cost =
        Eigen::MatrixXd::Constant(Eigen::Index(a.size()), Eigen::Index(b.size() + a.size()), apartAtMost * apartAtMost);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            const double off = unlike * (a[i].remote - b[j].remote);
            cost(Eigen::Index(i), Eigen::Index(j)) = (a[i].at - b[j].at).squaredNorm() + off * off;
        }
    const std::vector<std::size_t> columnOf = Assigned(cost);
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (columnOf[i] < b.size())
            pairs.emplace_back(i, columnOf[i]);
    return pairs;
}

} // namespace vcg::fcd
