// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_PLAIN_SAMPLING_H
#define FCD_PLAIN_SAMPLING_H

#include <vcg_ext/patches/lloyd.h>

#include <queue>
#include <tuple>

namespace fcd_test {

struct PlainPatches {
    std::vector<vcg::fcd::Index> patchOf, center;
    double cost = 0;
    int iterations = 0;
};

/// The patches as the paper makes them: in every iteration all of them are grown from their centres by a priority queue
/// of the distance, until the cost stops falling by \p param.tolerance and no patch reaches beyond D. Every node counts
/// the same. Seeds and tolerance are those of SamplePatches, nothing else is shared with it.
inline PlainPatches SamplePlainly(const vcg::fcd::Graph &g, const vcg::fcd::PatchParam &param) {
    using vcg::fcd::Index;
    PlainPatches p;
    p.center = vcg::fcd::detail::RandomSample(std::vector<float>(g.Size(), 1), param.initialPatches, param.randomSeed);
    for (double previous = std::numeric_limits<double>::infinity();; previous = p.cost) {
        p.patchOf.assign(g.Size(), -1);
        using Item = std::tuple<double, Index, Index>;
        std::priority_queue<Item, std::vector<Item>, std::greater<Item>> queue;
        struct Patch {
            double radius = 0, size = 0;
            Index farthest;
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        };
        std::vector<Patch> patch;
        p.cost = 0;
        auto grow = [&] {
            for (Index j = Index(patch.size()); j < Index(p.center.size()); ++j) {
                patch.emplace_back();
                patch[j].farthest = p.center[j];
                queue.emplace(0, p.center[j], j);
            }
            while (!queue.empty()) {
                const auto [d, u, j] = queue.top();
                queue.pop();
                if (p.patchOf[u] >= 0)
                    continue;
                p.patchOf[u] = j;
                p.cost += d * d;
                ++patch[j].size;
                patch[j].sum += g.position.col(u).cast<double>();
                if (d > patch[j].radius) {
                    patch[j].radius = d;
                    patch[j].farthest = u;
                }
                for (Index v : g.adjacency[u])
                    if (p.patchOf[v] < 0)
                        queue.emplace((g.position.col(v) - g.position.col(p.center[j])).cast<double>().norm(), v, j);
            }
        };
        grow();
        for (Index u = 0; u < g.Size(); ++u)
            if (p.patchOf[u] < 0) { // a component without a seed
                p.center.push_back(u);
                grow();
            }
        ++p.iterations;
        std::vector<Index> added;
        for (const Patch &q : patch)
            if (q.radius > param.targetRadius)
                added.push_back(q.farthest);
        if (added.empty() && previous - p.cost <= param.tolerance * previous && p.iterations > 1)
            return p;
        std::vector<double> nearest(patch.size(), std::numeric_limits<double>::infinity());
        for (Index u = 0; u < g.Size(); ++u) {
            const Index j = p.patchOf[u];
            const double d = (g.position.col(u).cast<double>() - patch[j].sum / patch[j].size).norm();
            if (d < nearest[j]) {
                nearest[j] = d;
                p.center[j] = u;
            }
        }
        p.center.insert(p.center.end(), added.begin(), added.end());
    }
}

} // namespace fcd_test

#endif
