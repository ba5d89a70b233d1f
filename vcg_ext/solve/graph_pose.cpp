// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/solve/graph_pose.h>

#include <Eigen/LU>
#include <cstdint>

namespace vcg {
namespace fcd {

void FitLinear(const DeformationGraph &graph, const std::vector<bool> &given, GraphPose &pose, double openness) {
    for (Index i = 0; i < graph.Size(); ++i) {
        if (given[i])
            continue;
        Eigen::Matrix3d rest = Eigen::Matrix3d::Zero(), posed = Eigen::Matrix3d::Zero();
        for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = graph.graph.adjacency.item[e];
            const Eigen::Vector3d way = (graph.graph.position.col(i) - graph.graph.position.col(j)).cast<double>();
            rest += graph.weight[e] * way * way.transpose();
            posed += graph.weight[e] * (pose.position.col(i) - pose.position.col(j)) * way.transpose();
        }
        const double weight = openness * rest.trace();
        rest.diagonal().array() += weight;
        posed += weight * pose.linear[i];
        const Eigen::Matrix3d fitted = posed * rest.inverse();
        if (fitted.allFinite())
            pose.linear[i] = fitted;
    }
}

} // namespace fcd
} // namespace vcg
