// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FALLOFF_H
#define VCG_FCD_FALLOFF_H

#include <vcg_ext/graph/deformation_graph.h>

#include <vector>

namespace vcg::fcd {

/// How the motion of a handle fades towards what else is held: where the free surface between them bends, twists and
/// stretches.
enum class Falloff {
    Smooth,  ///< evenly, all the way
    Linear,  ///< near both ends; between them, it stays straight
    Sharp,   ///< near the handle: a peak
    Constant ///< far from the handle: the surface around the handle goes along, a plateau
};

/// Multiplies the weights of \p graph's edges, so that the surface is softer where \p falloff bends it, and stiffer
/// elsewhere. The place of a node is t = a / (a + b): a is its way along the graph to the nearest handle, b to the
/// nearest constrained part but that handle.
/// \param tag of each node: 0 fixed, 1 free, others: handles, each by a number of its own
void WeighFalloff(DeformationGraph &graph, const std::vector<Index> &tag, Falloff falloff);

} // namespace vcg::fcd

#endif
