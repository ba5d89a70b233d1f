// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_REACH_H
#define VCG_FCD_SURFACE_REACH_H

#include <vcg_ext/base/graph.h>

#include <vector>

namespace vcg::fcd {

/// The nodes that are at most \p radius from one of \p seeds along the edges of the graph (Dijkstra 1959), these
/// included, nearest first. Costs as much as the nodes it finds, and room for a number for each node.
/// \param radius in units of graph.position, >= 0 \param distances gets how far each of them is, same units; may be
/// null
std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius,
                               std::vector<double> *distances = nullptr);

} // namespace vcg::fcd

#endif
