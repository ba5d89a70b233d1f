// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_field.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A map of space that turns in proportion to z.
struct Twist {
    double rate = 0.3;

    Vector3d operator()(const Vector3d &p) const {
        return Eigen::AngleAxisd(rate * p[2], Vector3d::UnitZ()) * p + Vector3d(0, 0, 2);
    }
    Eigen::Matrix3d Gradient(const Vector3d &p) const {
        Eigen::Matrix3d g = Eigen::AngleAxisd(rate * p[2], Vector3d::UnitZ()).toRotationMatrix();
        const Vector3d moved = g * p;
        g.col(2) += rate * Vector3d(-moved[1], moved[0], 0);
        return g;
    }
};

template <class Map>
static FieldSamples SamplesOf(const Shape &shape, const Map &map) {
    FieldSamples samples;
    samples.position.resize(3, shape.Size());
    samples.displacement.resize(3, shape.Size());
    for (int i = 0; i < shape.Size(); ++i) {
        const Vector3d p = shape.position[std::size_t(i)];
        samples.position.col(i) = p;
        samples.displacement.col(i) = map(p) - p;
        samples.gradient.emplace_back((map.Gradient(p) - Eigen::Matrix3d::Identity()).template cast<float>());
    }
    for (const auto &face : shape.face)
        samples.triangle.push_back({face[0], face[1], face[2]});
    return samples;
}

struct Affine {
    Eigen::Affine3d motion;

    Vector3d operator()(const Vector3d &p) const { return motion * p; }
    Eigen::Matrix3d Gradient(const Vector3d &) const { return motion.linear(); }
};

static Matrix3Xd RandomPoints(int n, double size) {
    std::mt19937 random(3);
    Matrix3Xd points(3, n);
    for (int i = 0; i < n; ++i)
        points.col(i) = size * RandomVector(random);
    return points;
}

TEST(DeformationField, CarriesAllOfSpaceByAnAffineMap) {
    Affine map{RandomRigid(5)};
    map.motion.linear() *= Eigen::Vector3d(1.2, 0.7, 1).asDiagonal();
    for (const Shape &shape : {Sphere(12, 20), Points(Sphere(12, 20))}) {
        const DeformationField field(SamplesOf(shape, map));
        const Matrix3Xd points = RandomPoints(500, 2);
        for (int i = 0; i < 500; ++i) {
            const Vector3d p = points.col(i);
            Eigen::Matrix3f linear;
            ASSERT_LE((p + field(p, &linear) - map(p)).norm(), 2e-6);
            ASSERT_LE((linear.cast<double>() - map.motion.linear()).norm(), 2e-6);
        }
    }
}

TEST(DeformationField, IsExactAtItsSamples) {
    const Shape shape = Tube(10, 12);
    for (const Shape &each : {shape, Points(shape)}) {
        const FieldSamples samples = SamplesOf(each, Twist());
        const DeformationField field(samples);
        for (int i = 0; i < each.Size(); ++i)
            ASSERT_LE((field(samples.position.col(i)) - samples.displacement.col(i)).norm(), 1e-8);
    }
}

/// The largest error of a twist between the vertices of flat triangles of this size.
static double ErrorOnPlane(int n) {
    const Shape shape =
        Moved(Grid(n, n, 6.0 / (n - 1)), Eigen::Affine3d(Eigen::AngleAxisd(0.8, Vector3d(1, 0.4, 0.1).normalized())));
    const DeformationField field(SamplesOf(shape, Twist()));
    double largest = 0;
    for (const auto &face : shape.face)
        for (double a : {0.2, 0.5, 0.7}) {
            const Vector3d x = a * shape.position[std::size_t(face[0])] + 0.3 * shape.position[std::size_t(face[1])] +
                               (0.7 - a) * shape.position[std::size_t(face[2])];
            largest = std::max(largest, (x + field(x) - Twist()(x)).norm());
        }
    return largest;
}

TEST(DeformationField, IsOfThirdOrderBetweenItsSamples) {
    const double coarse = ErrorOnPlane(9), fine = ErrorOnPlane(17), finer = ErrorOnPlane(33);
    EXPECT_GT(coarse, 1e-4);
    EXPECT_LT(fine, coarse / 6.5);
    EXPECT_LT(finer, fine / 6.5);
}

TEST(DeformationField, CarriesWhatIsBesideTheSurfaceAsThatTurns) {
    const DeformationField field(SamplesOf(Tube(60, 48), Twist()));
    for (double z : {1.0, 2.3, 4.7}) {
        const Vector3d p(1.1, 0, z); // a tenth off
        EXPECT_LE((p + field(p) - Twist()(p)).norm(), 0.02);
    }
}

TEST(DeformationField, WhatRestsKeepsItsBits) {
    FieldSamples samples = SamplesOf(TwoSheets(9, 0.1), Twist());
    for (Index i = 0; i < 81; ++i) { // the lower one
        samples.displacement.col(i).setZero();
        samples.gradient[std::size_t(i)].setZero();
    }
    const DeformationField field(samples);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-0.2, 8.2), height(-1, 0.04);
    for (int i = 0; i < 1000; ++i) {
        const Vector3d p(place(random), place(random), height(random));
        Eigen::Matrix3f linear;
        ASSERT_TRUE(SameBits(Vector3d(p + field(p, &linear)), p));
        ASSERT_EQ(linear, Eigen::Matrix3f::Identity());
        ASSERT_GT(field(Vector3d(p[0], p[1], 0.2)).norm(), 0.1);
    }
}

TEST(DeformationField, GivesTheSameBitsInAnyOrder) {
    const DeformationField field(SamplesOf(Sphere(20, 30), Twist()));
    const Matrix3Xd points = RandomPoints(3000, 1);
    Matrix3Xd one(3, points.cols()), other(one), third(one);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        one.col(i) = field(points.col(i));
    for (Eigen::Index i = points.cols(); i-- > 0;)
        other.col(i) = field(points.col(i));
    ParallelFor(4, std::size_t(points.cols()), 7, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            third.col(Eigen::Index(i)) = field(points.col(Eigen::Index(i)));
    });
    EXPECT_TRUE(SameBits(one, other));
    EXPECT_TRUE(SameBits(one, third));
}

TEST(DeformationField, LeavesPointsAloneThatAreNotFinite) {
    for (const Shape &shape : {Tube(6, 8), Points(Tube(6, 8))}) {
        const DeformationField field(SamplesOf(shape, Twist()));
        const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
        for (const Vector3d &p : {Vector3d(nan, 0, 0), Vector3d(0, inf, 0), Vector3d(-inf, nan, inf)}) {
            Eigen::Matrix3f linear;
            EXPECT_TRUE(field(p, &linear).isZero(0));
            EXPECT_EQ(linear, Eigen::Matrix3f::Identity());
        }
    }
}

TEST(DeformationField, OfOneSampleMovesAllAlike) {
    FieldSamples samples =
        SamplesOf(Shape{{{1, 2, 3}}, {}, {}}, Affine{Eigen::Affine3d(Eigen::Translation3d(1, 0, 0))});
    EXPECT_LE((DeformationField(samples)(Vector3d(9, 9, 9)) - Vector3d(1, 0, 0)).norm(), 1e-12);
    samples.triangle.push_back({0, 0, 0});
    EXPECT_LE((DeformationField(samples)(Vector3d(9, 9, 9)) - Vector3d(1, 0, 0)).norm(), 1e-12);
}
