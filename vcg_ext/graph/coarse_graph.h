// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_COARSE_GRAPH_H
#define VCG_FCD_COARSE_GRAPH_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>

#include <vector>

namespace vcg::fcd {

/// A deformation graph whose patches are groups of the patches of a finer graph of k nodes.
struct CoarseGraph {
    DeformationGraph graph;
    std::vector<Index> groupOf; ///< k, the coarse node that holds each node of the finer graph
    std::vector<Index> leader;  ///< of each coarse node, the node of the finer graph that the group grew from
};

/// Merges the free patches of a graph of k nodes, about four to one. Constrained nodes stay as they are. The flux
/// through a group's border is the sum over its patches' borders, so the surface is not read.
/// \param area k values, of the patches, frame units^2 \param constrained k flags; held nodes are constrained
CoarseGraph Coarsen(const DeformationGraph &fine, const std::vector<double> &area, const std::vector<bool> &constrained,
                    GraphWeights weights, const ShapeConstants &shape = {});

} // namespace vcg::fcd

#endif
