// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vcg_ext/base/graph.h>

#include <array>
#include <vector>

namespace vcg::fcd {

using Rgba = std::array<unsigned char, 4>; ///< red, green, blue, opacity

/// A colour for each node, different from its neighbours' (as far as a node with more than eleven of them allows).
std::vector<Rgba> ContrastingColors(const Csr &adjacency);

} // namespace vcg::fcd
