// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h>

#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace vcg::fcd {

std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius,
                               std::vector<double> *distances) {
    using Item = std::pair<double, Index>;
    std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
    const double unknown = std::numeric_limits<double>::infinity();
    std::vector<double> distanceOf(std::size_t(graph.Size()), unknown);
    std::vector<Index> found;
    if (distances)
        distances->clear();
    for (const Index seed : seeds) {
        if (distanceOf[seed] == unknown)
            queue.emplace(0, seed);
        distanceOf[seed] = 0;
    }
    while (!queue.empty()) {
        const auto [d, u] = queue.top();
        queue.pop();
        if (d > distanceOf[u])
            continue; // a shorter path was found since
        found.push_back(u);
        if (distances)
            distances->push_back(d);
        for (Index v : graph.adjacency[u]) {
            const double there = d + double((graph.position.col(v) - graph.position.col(u)).norm());
            if (there <= radius && there < distanceOf[v]) {
                distanceOf[v] = there;
                queue.emplace(there, v);
            }
        }
    }
    return found;
}

} // namespace vcg::fcd
