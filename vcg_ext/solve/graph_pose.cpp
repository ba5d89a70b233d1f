// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/solve/graph_pose.h>

#include <Eigen/LU>
#include <cstdint>

namespace vcg::fcd {

void FitLinear(const DeformationGraph &graph, const std::vector<bool> &isGiven, GraphPose &pose, double openness) {
    for (Index i = 0; i < graph.Size(); ++i) {
        if (isGiven[i])
            continue;
        Eigen::Matrix3d rest = Eigen::Matrix3d::Zero(), posed = Eigen::Matrix3d::Zero();
        for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = graph.graph.adjacency.item[e];
            const Eigen::Vector3d edge = (graph.graph.position.col(i) - graph.graph.position.col(j)).cast<double>();
            rest += graph.weight[e] * edge * edge.transpose();
            posed += graph.weight[e] * (pose.position.col(i) - pose.position.col(j)) * edge.transpose();
        }
        const double weight = openness * rest.trace();
        rest.diagonal().array() += weight;
        posed += weight * pose.linear[i];
        const Eigen::Matrix3d fitted = posed * rest.inverse();
        if (fitted.allFinite())
            pose.linear[i] = fitted;
    }
}

void MeasureEnergy(const DeformationGraph &graph, double smooth, GraphPose &pose) {
    const auto rest = [&](Index i) { return Eigen::Vector3d(graph.graph.position.col(i).cast<double>()); };
    // The posed end of an edge: the node or, if it is held, the border of its patch, moved as the patch.
    const auto placeOf = [&](Index i, const Eigen::Vector3d &border) -> Eigen::Vector3d {
        const Eigen::Vector3d node = pose.position.col(i);
        return graph.IsHeld(i) ? Eigen::Vector3d(node + pose.linear[i] * (border - rest(i))) : node;
    };
    pose.energy = 0;
    pose.nodeEnergy.assign(std::size_t(graph.Size()), 0);
    for (Index i = 0; i < graph.Size(); ++i) {
        for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = graph.graph.adjacency.item[e];
            const Eigen::Vector3d edge = graph.edge.col(e).cast<double>(),
                                  posedEdge = placeOf(i, rest(j) + edge) - placeOf(j, rest(i) - edge);
            pose.nodeEnergy[i] += graph.weight[e] * ((posedEdge - pose.linear[i] * edge).squaredNorm() +
                                                     0.5 * smooth * (pose.linear[i] - pose.linear[j]).squaredNorm());
        }
        pose.energy += pose.nodeEnergy[i];
    }
}

} // namespace vcg::fcd
