// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FALLOFF_H
#define VCG_FCD_FALLOFF_H

#include <vcg_ext/graph/deformation_graph.h>

#include <vector>

namespace vcg::fcd {

/// How the motion of a handle fades towards what else is held: where the free surface between them bends, twists and
/// stretches.
enum class Falloff {
    Smooth,  ///< evenly between the two
    Linear,  ///< near both ends, and straight between them
    Sharp,   ///< near the handle: a peak
    Constant ///< far from the handle, whose surroundings go along: a plateau
};

/// Multiplies the weights of the edges, so that the surface is softer where \p falloff bends it, and stiffer elsewhere.
/// The factor of an edge depends on t = a / (a + b) at its middle: a is the distance along the graph to the nearest
/// handle, b to the nearest other constrained part.
/// \param tag of each node: 0 fixed, 1 free, any other number: the handle of that number
void WeighFalloff(DeformationGraph &graph, const std::vector<Index> &tag, Falloff falloff);

} // namespace vcg::fcd

#endif
