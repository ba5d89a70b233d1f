// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_REACH_H
#define VCG_FCD_SURFACE_REACH_H

#include <vcg_ext/base/graph.h>

#include <functional>
#include <vector>

namespace vcg::fcd {

/// The ways that distances are measured on.
enum class Ways {
    Edges, ///< along edges of the graph (Dijkstra 1959): up to 1.4 times as long as on the surface, by how it is meshed
    Surface, ///< also straight across triangles, unfolded into a plane (Novotni, Klein 2002): some hundredths longer
};

/// The nodes within \p radius of one of \p seeds, nearest first; seeds are among them.
/// \param radius units of graph.position, >= 0 \param distances out: of each of them; may be null
/// \param goesOn called with each of them and its distance; the search ends when it returns false. Null: always true
std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius, Ways ways,
                               std::vector<double> *distances = nullptr,
                               const std::function<bool(Index, double)> &goesOn = nullptr);

} // namespace vcg::fcd

#endif
