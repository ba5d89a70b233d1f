// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h>

#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace vcg::fcd {

std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius,
                               std::vector<double> *distances) {
    using Item = std::pair<double, Index>;
    std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
    std::unordered_map<Index, double> distance;
    std::vector<Index> found;
    if (distances)
        distances->clear();
    for (const Index seed : seeds)
        if (distance.emplace(seed, 0).second)
            queue.emplace(0, seed);
    while (!queue.empty()) {
        const auto [d, u] = queue.top();
        queue.pop();
        if (d > distance[u])
            continue; // reached by a shorter way since
        found.push_back(u);
        if (distances)
            distances->push_back(d);
        for (Index v : graph.adjacency[u]) {
            const double there = d + double((graph.position.col(v) - graph.position.col(u)).norm());
            if (!(there <= radius))
                continue;
            const auto at = distance.emplace(v, there);
            if (at.second || there < at.first->second) {
                at.first->second = there;
                queue.emplace(there, v);
            }
        }
    }
    return found;
}

} // namespace vcg::fcd
