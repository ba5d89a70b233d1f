// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/symmetric_eigen.h>

#include <Eigen/Eigenvalues>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace elementary_test {

using namespace vcg::fcd::detail;

double Units(double value, double is) {
    return std::abs(value - is) / (std::abs(is) * std::numeric_limits<double>::epsilon());
}

TEST(Elementary, IsAsGoodAsTheLibrary) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    const double epsilon = std::numeric_limits<double>::epsilon();
    for (int i = 0; i < 100000; ++i) {
        const double x = any(random), y = any(random), angle = 10 * x, wide = std::exp(300 * y);
        EXPECT_NEAR(Sine(angle), std::sin(angle), 4 * epsilon) << angle;
        EXPECT_NEAR(Cosine(angle), std::cos(angle), 4 * epsilon) << angle;
        EXPECT_LE(Units(ArcTangent(y, x), std::atan2(y, x)), 4) << y << " " << x;
        EXPECT_LE(Units(ArcTangent(y, x * wide), std::atan2(y, x * wide)), 4) << y << " " << x * wide;
        EXPECT_LE(std::abs(ArcCosine(x) - std::acos(x)), 4 * epsilon) << x;
        EXPECT_LE(Units(Exponential(700 * x), std::exp(700 * x)), 4) << x;
        EXPECT_LE(Units(Logarithm(wide), std::log(wide)), 4) << wide;
        EXPECT_LE(Units(Logarithm(1 + 0.1 * x), std::log(1 + 0.1 * x)), 4) << x;
        EXPECT_LE(Units(BinaryLogarithm(wide), std::log2(wide)), 4) << wide;
        EXPECT_LE(Units(Power(2 + x, 3 * y), std::pow(2 + x, 3 * y)), 16) << x << " " << y;
    }
}

TEST(Elementary, IsExactWhereItCanBe) {
    EXPECT_EQ(Sine(0), 0);
    EXPECT_EQ(Cosine(0), 1);
    EXPECT_EQ(Sine(pi / 2), 1);
    EXPECT_EQ(Cosine(pi), -1);
    EXPECT_NEAR(Cosine(pi / 2), std::cos(pi / 2), 1e-30);
    EXPECT_EQ(ArcTangent(0, 0), 0);
    EXPECT_EQ(ArcTangent(0, -2), pi);
    EXPECT_EQ(ArcTangent(-3, 0), -pi / 2);
    EXPECT_EQ(ArcCosine(1), 0);
    EXPECT_EQ(ArcCosine(-1), pi);
    EXPECT_EQ(Exponential(0), 1);
    EXPECT_EQ(Exponential(-1e9), 0);
    EXPECT_EQ(Exponential(1e9), std::numeric_limits<double>::infinity());
    EXPECT_EQ(Logarithm(1), 0);
    EXPECT_EQ(BinaryLogarithm(1. / 1024), -10);
    EXPECT_EQ(Power(1, 0.3), 1);
}

/// The bits must be the same for any processor, system and compiler.
TEST(Elementary, HasTheSameBitsEverywhere) {
    std::uint64_t sum = 0;
    const auto add = [&](double value) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        sum = (sum ^ bits) * 0x100000001b3; // FNV
    };
    for (int i = 1; i < 1000; ++i) {
        const double x = i / 128.;
        for (double each :
             {Sine(x), Cosine(x), ArcTangent(x, 3), Exponential(-x), Logarithm(x), BinaryLogarithm(x), Power(x, 0.7)})
            add(each);
        const Eigen::Matrix3d turn = RotationBy(x, Eigen::Vector3d(0.36, 0.48, 0.8));
        const SymmetricEigen eigen(turn.transpose() * Eigen::Vector3d(1, x, 3).asDiagonal() * turn);
        for (int k = 0; k < 9; ++k)
            add(eigen.Vectors()(k) + turn(k));
    }
    EXPECT_EQ(sum, 12727340453857574067u);
}

TEST(Elementary, Rotations) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d axis = Eigen::Vector3d(any(random), any(random), any(random)).normalized();
        const double angle = 3.1 * std::abs(any(random));
        const Eigen::Matrix3d m = RotationBy(angle, axis);
        EXPECT_LE((m - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 1e-14);
        const Turn turn(m);
        EXPECT_NEAR(turn.angle, angle, 1e-13);
        EXPECT_LE((turn.angle * turn.axis - angle * axis).norm(), 1e-13);
    }
    EXPECT_EQ(Turn(Eigen::Matrix3d::Identity()).angle, 0);
    for (const double length : {1e-300, 1e200, 1e300}) // their squares overflow or underflow
        EXPECT_TRUE((RotationBy(Eigen::Vector3d(0, -length, length)).transpose() *
                     RotationBy(Eigen::Vector3d(0, -length, length)))
                        .isIdentity(1e-12));
}

TEST(Elementary, EigenvaluesOfThreeRows) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Matrix3d turn =
            RotationBy(3 * any(random), Eigen::Vector3d(any(random), any(random), 1).normalized());
        Eigen::Vector3d values(any(random), any(random), any(random));
        if (i % 4 == 1) // two equal or nearly equal ones
            values[1] = values[0] + (i % 8 == 1 ? 0 : 1e-10);
        if (i % 40 == 2)
            values.setConstant(values[0]);
        if (i % 40 == 3)
            values *= 1e-200;
        const Eigen::Matrix3d m = turn * values.asDiagonal() * turn.transpose();
        const SymmetricEigen eigen(m);
        std::sort(values.data(), values.data() + 3);
        const double size = values.cwiseAbs().maxCoeff();
        EXPECT_LE((eigen.values - values).norm(), 1e-7 * size); // a double root has half of the digits
        const Eigen::Matrix3d v = eigen.Vectors();
        EXPECT_LE((v.transpose() * v - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_LE((v.transpose() * m * v - Eigen::Matrix3d(values.asDiagonal())).norm(), 1e-7 * size);
    }
    EXPECT_EQ(SymmetricEigen(Eigen::Matrix3d::Zero()).values, Eigen::Vector3d::Zero());
}

} // namespace elementary_test
