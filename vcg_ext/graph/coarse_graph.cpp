// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph/border_weights.h>
#include <vcg_ext/graph/coarse_graph.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>

namespace vcg::fcd {

namespace {

/// Groups the nodes: leaders are not neighbours of each other, and every other node joins the nearest leader beside it.
/// Each constrained node is a group by itself. \return the leader of each group
std::vector<Index> GroupNodes(const Graph &graph, const std::vector<bool> &constrained, std::vector<Index> &groupOf) {
    std::vector<Index> leader, joined;
    groupOf.assign(std::size_t(graph.Size()), -1);
    for (Index i = 0; i < graph.Size(); ++i) {
        const Csr::Row row = graph.adjacency[i];
        const auto leads = [&](Index j) { return !constrained[j] && groupOf[j] >= 0; };
        if (!constrained[i] && std::any_of(row.begin(), row.end(), leads)) {
            joined.push_back(i);
            continue;
        }
        groupOf[i] = Index(leader.size());
        leader.push_back(i);
    }
    for (Index i : joined) {
        float least = std::numeric_limits<float>::infinity();
        for (Index j : graph.adjacency[i]) {
            const float d2 = (graph.position.col(j) - graph.position.col(i)).squaredNorm();
            if (!constrained[j] && groupOf[j] >= 0 && leader[groupOf[j]] == j && d2 < least) {
                least = d2;
                groupOf[i] = groupOf[j];
            }
        }
    }
    return leader;
}

} // namespace

CoarseGraph Coarsen(const DeformationGraph &fine, const std::vector<double> &area, const std::vector<bool> &constrained,
                    GraphWeights weights, const ShapeConstants &shape) {
    CoarseGraph coarse;
    coarse.leader = GroupNodes(fine.graph, constrained, coarse.groupOf);
    const auto k = Index(coarse.leader.size());
    const Csr &adjacency = fine.graph.adjacency;
    const auto at = [&](Index i) { return Eigen::Vector3d(fine.graph.position.col(i).cast<double>()); };
    const auto dual =
        QuotientGraph<detail::Flux>(adjacency, coarse.groupOf, k, [&](Index u, Index v, detail::Flux &flux) {
            const Csr::Row row = adjacency[u];
            const auto e =
                adjacency.begin[u] + std::uint32_t(std::lower_bound(row.begin(), row.end(), v) - row.begin());
            const Eigen::Vector3d offset = -fine.edge.col(e).cast<double>();
            const Eigen::Vector3d x = fine.IsHeld(u) ? Eigen::Vector3d(at(v) - offset) : at(u), y = x + offset;
            flux.Add(fine.weight[e], x, y, fine.IsHeld(u), fine.IsHeld(v));
            return true;
        });
    coarse.graph.radius.assign(std::size_t(k), 0);
    coarse.graph.graph.position.resize(3, k);
    Eigen::Matrix4Xd sum = Eigen::Matrix4Xd::Zero(4, k);
    for (Index i = 0; i < fine.Size(); ++i)
        sum.col(coarse.groupOf[i]) += area[i] * at(i).homogeneous();
    for (Index g = 0; g < k; ++g) {
        const Index leader = coarse.leader[g];
        coarse.graph.held.push_back(fine.IsHeld(leader));
        coarse.graph.graph.position.col(g) = sum(3, g) > 0 && !constrained[leader]
                                                 ? Eigen::Vector3f((sum.col(g).head<3>() / sum(3, g)).cast<float>())
                                                 : Eigen::Vector3f(fine.graph.position.col(leader));
    }
    for (Index i = 0; i < fine.Size(); ++i) {
        const Index g = coarse.groupOf[i];
        coarse.graph.radius[g] =
            std::max(coarse.graph.radius[g],
                     fine.radius[i] + (fine.graph.position.col(i) - coarse.graph.graph.position.col(g)).norm());
    }
    detail::WeighBorders(dual, weights, shape, coarse.graph);
    return coarse;
}

} // namespace vcg::fcd
