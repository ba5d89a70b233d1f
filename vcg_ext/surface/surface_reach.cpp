// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace vcg::fcd {

namespace {

/// The distance of v from a source, in the plane of the triangle. The source lies on the other side of the edge u w, \p
/// du from u and \p dw from w. Infinity if the straight path does not cross the edge.
double AcrossEdge(const Eigen::Vector3d &u, const Eigen::Vector3d &w, const Eigen::Vector3d &v, double du, double dw) {
    const double unknown = std::numeric_limits<double>::infinity(), length = (w - u).norm();
    if (!(length > 0))
        return unknown;
    const double along = (du * du - dw * dw + length * length) / (2 * length), square = du * du - along * along;
    if (!(square >= 0))
        return unknown;
    const double x = (v - u).dot(w - u) / length, behind = std::sqrt(square);
    const double y = std::sqrt(std::max(0.0, (v - u).squaredNorm() - x * x));
    const double crossing = along * y + x * behind; // times behind + y
    if (!(crossing >= 0 && crossing <= length * (behind + y)))
        return unknown;
    return std::sqrt((x - along) * (x - along) + (y + behind) * (y + behind));
}

} // namespace

std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius, Ways ways,
                               std::vector<double> *distances) {
    using Item = std::pair<double, Index>;
    std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
    const double unknown = std::numeric_limits<double>::infinity();
    std::vector<double> distanceOf(std::size_t(graph.Size()), unknown);
    std::vector<char> isDone(std::size_t(graph.Size()), 0);
    std::vector<Index> found;
    if (distances)
        distances->clear();
    for (const Index seed : seeds) {
        if (distanceOf[seed] == unknown)
            queue.emplace(0, seed);
        distanceOf[seed] = 0;
    }
    const auto placeOf = [&](Index u) { return Eigen::Vector3d(graph.position.col(u).cast<double>()); };
    const auto acrossBeside = [&](Index u, Index v) { // the way to v across triangles with u, from nodes that are done
        double least = unknown;
        const Csr::Row beside = graph.adjacency[v];
        for (const Index w : graph.adjacency[u])
            if (isDone[std::size_t(w)] && std::find(beside.begin(), beside.end(), w) != beside.end())
                least = std::min(least, AcrossEdge(placeOf(u), placeOf(w), placeOf(v), distanceOf[u], distanceOf[w]));
        return least;
    };
    while (!queue.empty()) {
        const auto [d, u] = queue.top();
        queue.pop();
        if (d > distanceOf[u])
            continue; // a shorter path was found since
        found.push_back(u);
        if (distances)
            distances->push_back(d);
        isDone[std::size_t(u)] = 1;
        for (Index v : graph.adjacency[u]) {
            double there = d + double((graph.position.col(v) - graph.position.col(u)).norm());
            if (ways == Ways::Surface && !isDone[std::size_t(v)])
                there = std::min(there, std::max(d, acrossBeside(u, v)));
            if (there <= radius && there < distanceOf[v]) {
                distanceOf[v] = there;
                queue.emplace(there, v);
            }
        }
    }
    return found;
}

} // namespace vcg::fcd
