// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_POSE_H
#define VCG_FCD_GRAPH_POSE_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>

#include <Eigen/Core>
#include <vector>

namespace vcg::fcd {

/// A pose of a deformation graph of k nodes, frame units. Node j maps x to linear[j] * (x - p_j) + position[j].
struct GraphPose {
    Eigen::Matrix3Xd position; ///< 3 x k, p'_j
    std::vector<Eigen::Matrix3d>
        linear;                     ///< k: R_j, or a linear map (FitLinear, affine); of its motion if that is given
    bool affine = false;            ///< the maps are affine: the rigidity is below 1
    double energy = 0;              ///< Eq. 2, frame units^2
    std::vector<double> nodeEnergy; ///< k, each node's share of the energy
    std::vector<char> rests;        ///< k flags: free nodes of parts at rest; empty: not known
    int iterations = 0;
    bool converged = true;
    bool moves = false;    ///< whether anything moved since rest; after a full turn, motions may not tell
    bool followed = true;  ///< with SolverParam::follow: whether it came to rest near where it began
    bool unstable = false; ///< with SolverParam::follow: whether it is a saddle, and would buckle
};

/// Replaces the rotations of \p pose by linear maps, so that the surface stretches evenly, as the graph does. They fit
/// the posed edges of the graph best (least squares). The edges leave the direction across the surface open: there, the
/// map is the rotation.
/// \param isGiven k flags: nodes whose rotation is given; they are not changed
/// \param openness as in ShapeConstants
void FitLinear(const DeformationGraph &graph, const std::vector<bool> &isGiven, GraphPose &pose,
               double openness = ShapeConstants().openness);

/// Sets energy and nodeEnergy of \p pose by Eq. 2, without the anchors of compliant nodes. \param smooth alpha A, frame
/// units^2
void MeasureEnergy(const DeformationGraph &graph, double smooth, GraphPose &pose);

} // namespace vcg::fcd

#endif
