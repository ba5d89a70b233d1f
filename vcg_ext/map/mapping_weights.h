// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_WEIGHTS_H
#define VCG_FCD_MAPPING_WEIGHTS_H

namespace vcg::fcd {

/// What a node of the deformation graph may influence.
enum class MappingWeights {
    Surface,  ///< what is connected to it over free surface inside the ball of its influence, by a way not much longer
              ///< than the straight one
    Euclidean ///< all nodes inside the ball, as in the paper
};

} // namespace vcg::fcd

#endif
