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

/// The error falls with the distance of the nodes to this power: half-way between 2, where the shape is smooth, and 1,
/// beside borders and creases. Nodes lie on a surface, so their distance falls with the square root of their number.
constexpr double errorOrder = 1.5;

/// Estimates how far \p pose is from the pose with a node at every vertex. A graph of a quarter of the nodes (Coarsen)
/// is posed for the same motions; the difference and its order give the error that is left (Richardson's
/// extrapolation).
/// \param area k values: of the patches, frame units^2 \param constraints with the motions that \p pose was solved for
/// \param pose of \p graph; the coarse graph begins from it, so that it bends to the same side
/// \return root mean square over the free surface, frame units; 0 if nothing moves, NaN if it is unknown
double DiscretisationError(const DeformationGraph &graph, const std::vector<double> &area,
                           const NodeConstraints &constraints, const GraphPose &pose, GraphWeights weights,
                           const SolverParam &solver, const ShapeConstants &shape = {}, const Progress &progress = {});

} // namespace vcg::fcd

#endif
