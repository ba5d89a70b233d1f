// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/distance_colors.h"

#include <algorithm>
#include <cmath>

vcg::Color4b colorOfDistance(double part) {
    const double stops[][3] = {{40, 80, 220}, {40, 190, 160}, {110, 200, 60}, {250, 220, 50}, {215, 35, 35}};
    const double at = 4 * std::clamp(part, 0.0, 1.0);
    const int first = std::min(3, int(at));
    const auto mixed = [&](int i) {
        return (unsigned char)std::lround(stops[first][i] + (at - first) * (stops[first + 1][i] - stops[first][i]));
    };
    return vcg::Color4b(mixed(0), mixed(1), mixed(2), 255);
}

vcg::Color4b colorOfNoCounterpart() { return vcg::Color4b(150, 150, 150, 255); }
