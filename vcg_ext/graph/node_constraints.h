// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NODE_CONSTRAINTS_H
#define VCG_FCD_NODE_CONSTRAINTS_H

#include <Eigen/Geometry>
#include <vector>

namespace vcg::fcd {

/// Which nodes of a deformation graph of k nodes are constrained, and how they move.
struct NodeConstraints {
    std::vector<bool> constrained;       ///< k flags: the position is given
    std::vector<bool> compliant;         ///< k flags: constrained, but the rotation is free
    std::vector<double> heldArea;        ///< k, frame units^2: held area behind a compliant node, see GraphDeformer
    std::vector<Eigen::Affine3d> motion; ///< k, of constrained nodes, frame units
};

} // namespace vcg::fcd

#endif
