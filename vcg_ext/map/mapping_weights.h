// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_WEIGHTS_H
#define VCG_FCD_MAPPING_WEIGHTS_H

namespace vcg::fcd {

/// What a node of the deformation graph influences.
enum class MappingWeights {
    Surface,  ///< free surface in the ball of its influence that is connected to it in the ball, by a path not much
              ///< longer than the straight line
    Euclidean ///< all free surface in the ball, as in the paper
};

} // namespace vcg::fcd

#endif
