// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GIVEN_NODES_H
#define VCG_FCD_GIVEN_NODES_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/surface_graph.h>

#include <vector>

namespace vcg::fcd {

namespace detail {

/// The free nodes of \p surface nearest to \p centers (3 x k, mesh units), each once. Centres that are farther from the
/// mesh than a patch reaches lie elsewhere, and are left out.
/// \param rest 3 x vertex slots, mesh units \param tag one per vertex slot \param nodeTag of each node, 1: free
/// \param placed out: number of centres that are not left out
/// \throw BadInput less than half of the centres are on the mesh, or one is not finite
std::vector<Index> NearestNodes(const PositionsRef &rest, const SurfaceGraph &surface, const std::vector<int> &tag,
                                const std::vector<Index> &nodeTag, const Eigen::Matrix3Xd &centers, Index &placed);

} // namespace detail
} // namespace vcg::fcd

#endif
