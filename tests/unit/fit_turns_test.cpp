// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to lay a surface onto a target that lies turned.
#include "test_support.h"
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_turns.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vcg::fcd {
namespace {

using Eigen::Vector3d;
using namespace fcd_test;

/// An egg with bumps, a third of the diagonal long, with a hole at each end.
Shape Egg(int around) {
    Shape egg;
    const int rings = around / 2;
    for (int k = 0; k < rings; ++k)
        for (int i = 0; i < around; ++i) {
            const double a = 2 * detail::pi * i / around, b = detail::pi * (k + 0.5) / rings;
            const Vector3d p(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b));
            egg.position.push_back(
                (0.2 + 0.03 * std::sin(4 * p[0] + 3 * p[1]) + 0.03 * std::sin(5 * p[1] - 3 * p[2] + 1)) *
                Vector3d(1.2 * p[0], p[1], 0.9 * p[2]));
            const int here = k * around + i, beside = k * around + (i + 1) % around;
            if (k + 1 < rings) {
                egg.face.push_back({here, here + around, beside});
                egg.face.push_back({beside, here + around, beside + around});
            }
        }
    return egg;
}

/// The faces whose corners all have more than \p least of a coordinate.
Shape Above(Shape shape, double least, int coordinate) {
    std::vector<std::array<int, 3>> kept;
    for (const std::array<int, 3> &face : shape.face)
        if (std::all_of(face.begin(), face.end(), [&](int i) { return shape.position[i][coordinate] > least; }))
            kept.push_back(face);
    shape.face = kept;
    return shape;
}

/// How far the vertices of \p shape are from where they belong after the best way onto \p target, rms.
double Off(const Shape &shape, const Shape &target, const Eigen::Affine3d &away, double scale = 1) {
    const MeshD to(Moved(target, away));
    const Arrays arrays = Read(to);
    const FitTarget prepared(arrays.View(), {}, Eigen::Affine3d::Identity());
    const FitTurns turns(shape.position, {}, prepared);
    const std::vector<Alignment> alignments = turns.Best(scale, {}, 1);
    EXPECT_FALSE(alignments.empty());
    double squares = 0;
    for (const Vector3d &p : shape.position)
        squares += (alignments.front().motion * p - away * p).squaredNorm();
    for (const Alignment &alignment : alignments)
        EXPECT_LE(alignments.front().misfit, alignment.misfit);
    if (scale == 1)
        EXPECT_LT(alignments.front().misfit, 0.5 * turns.Misfit(Eigen::Affine3d::Identity()));
    return std::sqrt(squares / double(shape.position.size()));
}

} // namespace

TEST(FitTurns, LayASurfaceOntoATargetHoweverItIsTurned) {
    const Shape egg = Egg(40), other = Egg(47);
    for (const double degrees : {90., 180.})
        for (const Vector3d &axis : {Vector3d(1, 2, -1), Vector3d(-3, 1, 1)}) {
            const Eigen::Affine3d away =
                Eigen::Translation3d(0.1, 0, -0.05) * Eigen::AngleAxisd(degrees * detail::pi / 180, axis.normalized());
            EXPECT_LT(Off(egg, other, away), 0.01) << degrees << " about " << axis.transpose();
        }
}

// The middle of a part lies elsewhere, and its axes are others.
TEST(FitTurns, LayASurfaceOntoAPartOfIt) {
    const Shape egg = Egg(40);
    const Eigen::Affine3d away(Eigen::AngleAxisd(2.2, Vector3d(1, 2, -1).normalized()));
    for (int coordinate = 0; coordinate < 3; coordinate += 2)
        EXPECT_LT(Off(egg, Above(Egg(47), -0.03, coordinate), away), 0.01) << coordinate;
}

// Each has what the other lacks.
TEST(FitTurns, LayAPartOntoAnotherPart) {
    const Shape egg = Above(Egg(40), -0.1, 0);
    for (const double radians : {1.6, 2.2, 2.8}) {
        const Eigen::Affine3d away(Eigen::AngleAxisd(radians, Vector3d(1, 2, -1).normalized()));
        EXPECT_LT(Off(egg, Above(Egg(47), -0.08, 1), away), 0.01) << radians;
    }
}

TEST(FitTurns, LayAScaledSurface) {
    const Eigen::Affine3d away(Eigen::Scaling(1.4) * Eigen::AngleAxisd(2.2, Vector3d(1, 2, -1).normalized()));
    EXPECT_LT(Off(Egg(40), Egg(47), away, 1.4), 0.014);
}

} // namespace vcg::fcd
