// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_COARSE_GRAPH_H
#define VCG_FCD_COARSE_GRAPH_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>

#include <vector>

namespace vcg::fcd {

/// A deformation graph whose patches are groups of those of a finer one.
struct CoarseGraph {
    DeformationGraph graph;
    std::vector<Index> groupOf; ///< k, which of its nodes each node of the finer graph is in
    std::vector<Index> leader;  ///< of each of its nodes, the node of the finer graph that the group grew from
};

/// Joins the free patches of a graph of k nodes, about four to one, as if the surface had been divided into those: each
/// with what has no such neighbour yet. Constrained ones stay as they are. What flows over the borders of the groups is
/// what flows over those of their patches, so that nothing of the surface is read.
/// \param area k values, of the patches \param constrained k flags; held nodes are
CoarseGraph Coarsen(const DeformationGraph &fine, const std::vector<double> &area, const std::vector<bool> &constrained,
                    GraphWeights weights, const ShapeConstants &shape = {});

} // namespace vcg::fcd

#endif
