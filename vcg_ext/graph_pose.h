// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_POSE_H
#define VCG_FCD_GRAPH_POSE_H

#include "deformation_graph.h"
#include "shape_constants.h"

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

namespace vcg {
namespace fcd {

/// Where each node of a deformation graph went: x -> linear * (x - rest) + position.
struct GraphPose {
    Eigen::Matrix3Xd position;           ///< 3 x k, c'_j
    std::vector<Eigen::Matrix3d> linear; ///< k, R_j (see FitLinear); of a constrained node that of its motion
    double energy = 0;                   ///< Eq. 2, frame units^2
    std::vector<double> nodeEnergy;      ///< k, each node's share of it
    std::vector<char> rests;             ///< k flags: free nodes of parts that nothing moves; empty: not known
    int iterations = 0;
    bool converged = true;
};

/// Replaces the rotations of \p pose by the linear maps that fit the edges of the graph best, in the least-squares
/// sense; what the edges leave open (across the surface) stays as the rotation has it. The surface then stretches as
/// the graph does instead of in steps from node to node. Rotations that are given stay.
/// \param given k flags: nodes whose rotation is given
/// \param openness as in ShapeConstants
inline void FitLinear(const DeformationGraph &graph, const std::vector<bool> &given, GraphPose &pose,
                      double openness = ShapeConstants().openness) {
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

#endif
