// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>
#include "test_support.h"

using namespace fcd_test;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using vcg::fcd::detail::FitRotation;
using vcg::fcd::detail::RotationOf;

static void ExpectBestRotation(const Matrix3d &s, std::mt19937 &random) {
    const Matrix3d r = FitRotation(s);
    ASSERT_TRUE(r.allFinite()) << s;
    EXPECT_TRUE((r * r.transpose()).isIdentity(1e-12)) << s;
    EXPECT_NEAR(r.determinant(), 1, 1e-12) << s;
    const double best = (r * s).trace();
    for (int i = 0; i < 300; ++i) {
        const double angle = std::pow(10.0, -(i % 4)); // near it and anywhere
        const Matrix3d other =
            i % 5 ? Matrix3d(Eigen::AngleAxisd(angle, RandomVector(random).normalized()) * r) : RandomRotation(random);
        ASSERT_GE(best, (other * s).trace() - 1e-12 * s.norm()) << s;
    }
}

TEST(FitRotation, MaximisesTheTrace) {
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
        Matrix3d s;
        for (int c = 0; c < 3; ++c)
            s.col(c) = RandomVector(random);
        ExpectBestRotation(s, random);
        ExpectBestRotation(1e-20 * s, random);
        ExpectBestRotation(1e20 * s, random);
        Matrix3d flat = s;
        flat.col(2) = s.col(0) + 2 * s.col(1); // rank 2
        ExpectBestRotation(flat, random);
        ExpectBestRotation(s.col(0) * s.col(1).transpose(), random); // rank 1
    }
}

TEST(FitRotation, OfSpecialMatrices) {
    std::mt19937 random(1);
    for (const Vector3d &d :
         {Vector3d(1, 1, 1), Vector3d(0, 0, 0), Vector3d(-1, 1, 1), Vector3d(-1, -1, -1), Vector3d(1, 1, 0),
          Vector3d(2, 2, -2), Vector3d(1, 0, 0), Vector3d(1, 1e-9, -1e-9), Vector3d(0, -3, 0)})
        for (int i = 0; i < 5; ++i) {
            const Matrix3d turn = i ? RandomRotation(random) : Matrix3d(Matrix3d::Identity());
            ExpectBestRotation(turn * d.asDiagonal(), random);
            ExpectBestRotation(turn * d.asDiagonal() * turn.transpose(), random);
        }
}

TEST(FitRotation, InvertsARotation) {
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
        const Matrix3d r = RandomRotation(random);
        EXPECT_TRUE(FitRotation(r.transpose()).isApprox(r, 1e-12));
        EXPECT_TRUE(RotationOf(r).isApprox(r, 1e-12));
        const Matrix3d stretch = r * Vector3d(3, 2, 0.5).asDiagonal() * r.transpose();
        const Matrix3d turn = RandomRotation(random);
        EXPECT_TRUE(RotationOf(turn * stretch).isApprox(turn, 1e-12));
    }
}
