// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GIVEN_NODES_H
#define VCG_FCD_GIVEN_NODES_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/surface_graph.h>

#include <vector>

namespace vcg::fcd {

namespace detail {

/// The nodes of \p surface nearest to \p centers (3 x k, mesh units), each once, without those that are held. Left out
/// are centres further from the mesh than centres are from each other: they belong elsewhere.
/// \param rest 3 x vertex slots \param tag one per vertex slot \param nodeTag n, 1 where free \param placed how many
/// centres are not left out \throw BadInput when these are less than half of them
std::vector<Index> NearestNodes(const PositionsRef &rest, const SurfaceGraph &surface, const std::vector<int> &tag,
                                const std::vector<Index> &nodeTag, const Eigen::Matrix3Xd &centers, Index &placed);

} // namespace detail
} // namespace vcg::fcd

#endif
