// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CONTRASTING_COLORS_H
#define VCG_FCD_CONTRASTING_COLORS_H

#include <vcg_ext/base/graph.h>

#include <array>
#include <vector>

namespace vcg {
namespace fcd {

using Rgba = std::array<unsigned char, 4>; ///< red, green, blue, opacity

/// A colour for each node, different from its neighbours' (as far as a node with more than eleven of them allows).
std::vector<Rgba> ContrastingColors(const Csr &adjacency);

} // namespace fcd
} // namespace vcg

#endif
