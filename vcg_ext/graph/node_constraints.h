// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NODE_CONSTRAINTS_H
#define VCG_FCD_NODE_CONSTRAINTS_H

#include <Eigen/Geometry>
#include <vector>

namespace vcg::fcd {

/// What holds the nodes of a deformation graph of k nodes, and how they move.
struct NodeConstraints {
    std::vector<bool> constrained;       ///< k flags: the position is given
    std::vector<bool> compliant;         ///< k flags: of constrained nodes whose rotation is not given
    std::vector<double> heldArea;        ///< k, as GraphDeformer takes it
    std::vector<Eigen::Affine3d> motion; ///< k, of constrained nodes, frame units
};

} // namespace vcg::fcd

#endif
