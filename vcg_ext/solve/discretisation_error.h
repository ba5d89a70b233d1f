// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DISCRETISATION_ERROR_H
#define VCG_FCD_DISCRETISATION_ERROR_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/node_constraints.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/solver_param.h>

#include <vector>

namespace vcg::fcd {

/// The error falls with the distance of the nodes to this power: with the square of it where the shape is smooth, and
/// with the distance itself beside borders and creases; half-way. Nodes lie on a surface, so that the distance goes
/// with the inverse root of their number.
constexpr double errorOrder = 1.5;

/// An estimate of how far a pose is from the one with a node at every vertex, because there are so few: a graph of a
/// quarter of the nodes (Coarsen) makes something else of the same motions, and the error that is left follows from
/// that difference and the order in which it falls (Richardson's extrapolation). \param area k values: of the patches,
/// frame units^2 \param given with the motions that \p pose was solved for \param pose of the graph; the coarse one
/// begins from it, and so bends the same way \return root mean square over the free surface, frame units; 0 where
/// nothing moves, NaN where it cannot be told
double DiscretisationError(const DeformationGraph &graph, const std::vector<double> &area, const NodeConstraints &given,
                           const GraphPose &pose, GraphWeights weights, const SolverParam &solver,
                           const ShapeConstants &shape = {}, const Progress &progress = {});

} // namespace vcg::fcd

#endif
