// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph/contrasting_colors.h>

namespace vcg::fcd {

std::vector<Rgba> ContrastingColors(const Csr &adjacency) {
    // Twelve hues that stay apart from each other, the qualitative palette "Paired" of ColorBrewer in an order in which
    // consecutive entries differ clearly.
    static const unsigned char palette[12][3] = {{31, 120, 180},  {253, 191, 111}, {51, 160, 44},   {251, 154, 153},
                                                 {106, 61, 154},  {255, 255, 153}, {166, 206, 227}, {227, 26, 28},
                                                 {178, 223, 138}, {177, 89, 40},   {202, 178, 214}, {255, 127, 0}};
    std::vector<int> chosen(adjacency.Size(), -1);
    std::vector<Rgba> color(adjacency.Size());
    for (Index i = 0; i < adjacency.Size(); ++i) {
        int used[12] = {};
        for (Index j : adjacency[i])
            if (chosen[j] >= 0)
                ++used[chosen[j]];
        const int start = int(i * 5u % 12); // a walk through the palette, so that all of it is used
        int best = start;
        for (int c = 0; c < 12; ++c)
            if (used[(start + c) % 12] < used[best])
                best = (start + c) % 12;
        chosen[i] = best;
        color[i] = {palette[best][0], palette[best][1], palette[best][2], 255};
    }
    return color;
}

} // namespace vcg::fcd
