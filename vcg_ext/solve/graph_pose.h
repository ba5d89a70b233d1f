// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_POSE_H
#define VCG_FCD_GRAPH_POSE_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>

#include <Eigen/Core>
#include <vector>

namespace vcg::fcd {

/// Where each node of a deformation graph went: x -> linear * (x - rest) + position.
struct GraphPose {
    Eigen::Matrix3Xd position;           ///< 3 x k, c'_j
    std::vector<Eigen::Matrix3d> linear; ///< k, R_j (see FitLinear), or A_j; of a constrained node that of its motion
    bool affine = false;                 ///< the maps are affine by themselves (rigidity below 1)
    double energy = 0;                   ///< Eq. 2, frame units^2
    std::vector<double> nodeEnergy;      ///< k, each node's share of it
    std::vector<char> rests;             ///< k flags: free nodes of parts that nothing moves; empty: not known
    int iterations = 0;
    bool converged = true;
    bool moves = false;    ///< whether anything was moved since rest; with full turns it may be that no motion tells
    bool followed = true;  ///< with SolverParam::follow: whether it came to rest near where it began
    bool unstable = false; ///< with SolverParam::follow: whether it would give way, left to itself
};

/// Replaces the rotations of \p pose by the linear maps that fit the edges of the graph best, in the least-squares
/// sense; what the edges leave open (across the surface) stays as the rotation has it. The surface then stretches as
/// the graph does instead of in steps from node to node. Rotations that are given stay.
/// \param given k flags: nodes whose rotation is given
/// \param openness as in ShapeConstants
void FitLinear(const DeformationGraph &graph, const std::vector<bool> &given, GraphPose &pose,
               double openness = ShapeConstants().openness);

/// Sets energy and nodeEnergy of \p pose to Eq. 2 at its positions and rotations. The anchors of compliant nodes
/// (SolverParam) do not count. \param smooth alpha A, frame units^2
void MeasureEnergy(const DeformationGraph &graph, double smooth, GraphPose &pose);

} // namespace vcg::fcd

#endif
