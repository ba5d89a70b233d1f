// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/triangle_stretch.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Vector3d;

namespace {

/// A triangle in the plane of z, its edges from one corner.
struct Edges {
    Vector3d a, b;
};

Edges RandomEdges(std::mt19937 &random) {
    Edges edges;
    do {
        edges = {RandomVector(random), RandomVector(random)};
        edges.a[2] = edges.b[2] = 0;
    } while (edges.a.cross(edges.b).norm() < 0.1);
    return edges;
}

TriangleStretch Stretched(const Edges &rest, const Eigen::Matrix3d &before, const Eigen::Matrix3d &map) {
    return StretchOf(before * rest.a, before * rest.b, map * rest.a, map * rest.b);
}

} // namespace

TEST(TriangleStretch, FindsTheTwoFactors) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> exponent(-3, 3);
    for (int i = 0; i < 200; ++i) {
        const Edges rest = RandomEdges(random);
        const double p = std::exp2(exponent(random)), q = std::exp2(exponent(random));
        // Stretched along two directions of its plane, and turned, before and after.
        const Eigen::Matrix3d inPlane = Eigen::AngleAxisd(exponent(random), Vector3d::UnitZ()).matrix();
        const Eigen::Matrix3d map = RandomRotation(random) * Vector3d(p, q, 5).asDiagonal() * inPlane;
        const TriangleStretch stretch = Stretched(rest, RandomRotation(random), map);
        EXPECT_NEAR(stretch.largest, std::max(p, q), 1e-9 * std::max(p, q));
        EXPECT_NEAR(stretch.smallest, std::min(p, q), 1e-9 * std::max(p, q));
        EXPECT_NEAR(stretch.area, rest.a.cross(rest.b).norm() / 2, 1e-12);
        const double farther = std::max(p, q) >= 1 / std::min(p, q) ? std::max(p, q) : std::min(p, q);
        EXPECT_NEAR(stretch.Exponent(), std::log2(farther), 1e-6);
    }
}

TEST(TriangleStretch, IsOneWhereNothingStretches) {
    std::mt19937 random(2);
    for (int i = 0; i < 50; ++i) {
        const Edges rest = RandomEdges(random);
        const TriangleStretch turned = Stretched(rest, Eigen::Matrix3d::Identity(), RandomRotation(random));
        EXPECT_NEAR(turned.largest, 1, 1e-12);
        EXPECT_NEAR(turned.smallest, 1, 1e-12);
        EXPECT_NEAR(turned.Exponent(), 0, 1e-11);
    }
}

TEST(TriangleStretch, DoesNotDependOnTheCorner) {
    std::mt19937 random(3);
    for (int i = 0; i < 50; ++i) {
        const Edges rest = RandomEdges(random), now{RandomVector(random), RandomVector(random)};
        const TriangleStretch one = StretchOf(rest.a, rest.b, now.a, now.b);
        const TriangleStretch other = StretchOf(rest.b - rest.a, -rest.a, now.b - now.a, -now.a);
        EXPECT_NEAR(one.largest, other.largest, 1e-9 * one.largest);
        EXPECT_NEAR(one.smallest, other.smallest, 1e-9 * one.largest);
        EXPECT_NEAR(one.area, other.area, 1e-9);
    }
}

TEST(TriangleStretch, CopesWithTrianglesThatAreNone) {
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), zero = Vector3d::Zero();
    EXPECT_EQ(StretchOf(x, 2 * x, x, y).area, 0) << "a line at rest";
    EXPECT_EQ(StretchOf(zero, zero, x, y).area, 0);
    EXPECT_EQ(StretchOf(zero, zero, x, y).Exponent(), 0);
    EXPECT_EQ(StretchOf(x, y, x, y * std::nan("")).area, 0);

    const TriangleStretch line = StretchOf(x, y, x, x);
    EXPECT_NEAR(line.largest, std::sqrt(2), 1e-12);
    EXPECT_EQ(line.smallest, 0);
    EXPECT_EQ(line.Exponent(), -16);
    const TriangleStretch point = StretchOf(x, y, zero, zero);
    EXPECT_EQ(point.largest, 0);
    EXPECT_EQ(point.smallest, 0);
    EXPECT_EQ(point.area, 0.5);
    EXPECT_EQ(point.Exponent(), -16);
    EXPECT_EQ(StretchOf(x, y, 1e9 * x, 1e9 * y).Exponent(), 16);
    EXPECT_EQ(StretchOf(x, y, 2 * x, y / 2).Exponent(), 1) << "as much longer as shorter: longer";
}
