// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CONTRASTING_COLORS_H
#define FCD_CONTRASTING_COLORS_H

#include <vcg_ext/base/graph.h>

#include <vcg/space/color4.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

/// A colour for each node, different from its neighbours' (if there are at most eleven). \param edge pairs of nodes
inline std::vector<vcg::Color4b> contrastingColors(std::size_t nodes,
                                                   const std::vector<std::array<vcg::fcd::Index, 2>> &edge) {
    // The qualitative palette "Paired" of ColorBrewer, in an order in which consecutive colours differ clearly.
    static const unsigned char palette[12][3] = {{31, 120, 180},  {253, 191, 111}, {51, 160, 44},   {251, 154, 153},
                                                 {106, 61, 154},  {255, 255, 153}, {166, 206, 227}, {227, 26, 28},
                                                 {178, 223, 138}, {177, 89, 40},   {202, 178, 214}, {255, 127, 0}};
    std::vector<std::vector<std::size_t>> before(nodes); // neighbours with a smaller number
    for (const auto &ends : edge)
        before[std::size_t(std::max(ends[0], ends[1]))].push_back(std::size_t(std::min(ends[0], ends[1])));
    std::vector<std::size_t> chosen;
    std::vector<vcg::Color4b> color;
    for (std::size_t i = 0; i < nodes; ++i) {
        int used[12] = {};
        for (std::size_t j : before[i])
            ++used[chosen[j]];
        const std::size_t start = i * 5 % 12; // a walk through the palette, so that all of it is used
        std::size_t best = start;
        for (std::size_t c = 0; c < 12; ++c)
            if (used[(start + c) % 12] < used[best])
                best = (start + c) % 12;
        chosen.push_back(best);
        color.emplace_back(palette[best][0], palette[best][1], palette[best][2], 255);
    }
    return color;
}

#endif
