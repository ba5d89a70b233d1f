// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ANGLE_H
#define VCG_FCD_ANGLE_H

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

/// The angle in (0, pi) radians of a cotangent, to 1e-7: atan by M. Abramowitz, I. A. Stegun, Handbook of Mathematical
/// Functions, 4.4.49. Without branches, so that compilers vectorise it.
inline float AngleOfCotangent(float cotangent) {
    constexpr float right = 1.57079633f;
    const float size = std::fabs(cotangent), t = std::min(size, 1 / size), s = t * t;
    float sum = 0.0028662257f;
    for (float next : {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f, -0.1420889944f, 0.1999355085f,
                       -0.3333314528f, 1.f})
        sum = sum * s + next;
    const float acute = sum * t, angle = size > 1 ? right - acute : acute;
    return right - std::copysign(angle, cotangent);
}

} // namespace vcg::fcd

#endif
