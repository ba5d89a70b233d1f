// SPDX-License-Identifier: GPL-3.0-or-later
#include "../../meshes/benchmark_shapes.h"

#include <gtest/gtest.h>

TEST(BenchmarkShapes, TheArmsOfACactusAreAsLongAtAnySize) {
    constexpr double armRadius = 0.032, leftTop = 0.8, rightTop = 0.855;
    for (double count = 600; count < 20000; count *= 1.25) {
        benchmark::Cactus cactus;
        cactus.Resolve(std::int64_t(count));
        double left = 0, right = 0;
        cactus.ForEachPosition([&](const benchmark::Vector3d &p) {
            double &top = p.y() < 0.5 ? left : right;
            if (std::abs(p.y() - 0.5) > 0.18) // the trunk ends at .42 and .58
                top = std::max(top, p.z());
        });
        EXPECT_NEAR(left, leftTop, armRadius / 4) << count;
        EXPECT_NEAR(right, rightTop, armRadius / 4) << count;
    }
}
