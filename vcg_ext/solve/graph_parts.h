// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_PARTS_H
#define VCG_FCD_GRAPH_PARTS_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/node_constraints.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/solver_param.h>

#include <memory>
#include <vector>

namespace vcg::fcd {

/// The parts of \p graph that its held nodes separate, as the ascending nodes of each. A held node is in every part
/// beside it. Parts without a constrained node are left out.
std::vector<std::vector<Index>> SeparateParts(const DeformationGraph &graph, const std::vector<bool> &constrained);

/// The subgraph of \p nodes, ascending.
DeformationGraph PartOf(const DeformationGraph &graph, const std::vector<Index> &nodes);

/// Deforms each part of a graph by itself (SeparateParts; GraphDeformer or AffineDeformer). Prepared once; owns copies
/// of what it needs of the graph.
class PartsDeformer {
  public:
    /// \param area k values: of each node's patch, frame units^2; A of a part is their sum
    /// \param constraints motions are not read \param solver its rigidity and smoothness are those of all poses
    /// \throw Unsolvable when a system cannot be factorised, or takes too long \throw Cancelled
    PartsDeformer(const DeformationGraph &graph, const std::vector<double> &area, const NodeConstraints &constraints,
                  double heldDepth = ShapeConstants().heldDepth, const Progress &progress = {},
                  const SolverParam &solver = {});
    ~PartsDeformer();
    PartsDeformer(const PartsDeformer &) = delete;
    PartsDeformer &operator=(const PartsDeformer &) = delete;

    /// Poses the graph. A part without a moving constraint stays at rest.
    /// \param constraints as at construction, with the motions \param last, lastMotion as in GraphDeformer::Solve
    GraphPose Solve(const NodeConstraints &constraints, const SolverParam &param, const Progress &progress = {},
                    const GraphPose *last = nullptr, const std::vector<Eigen::Affine3d> &lastMotion = {}) const;

    /// GraphDeformer::Spread of each part by itself. \pre rigidity 1
    Eigen::VectorXd Spread(const Eigen::VectorXd &pressure) const;

  private:
    struct Part;
    Eigen::Matrix3Xd rest; // 3 x k
    std::vector<bool> isHeld;
    std::vector<std::unique_ptr<Part>> parts;
};

} // namespace vcg::fcd

#endif
