// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handles.h>
#include "test_support.h"

#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::AngleAxisd;
using Eigen::Matrix4d;
using Eigen::Vector3d;

static Matrix4d Affine(const Eigen::Matrix3d &linear, const Vector3d &translation = Vector3d::Zero()) {
    Matrix4d m = Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = linear;
    m.topRightCorner<3, 1>() = translation;
    return m;
}

static Vector3d Apply(const Matrix4d &m, const Vector3d &p) { return (m * p.homogeneous()).head<3>(); }

/// Turn by \p angle about an axis through \p point.
static Matrix4d TurnAbout(const Vector3d &point, const Vector3d &axis, double angle) {
    const Eigen::Matrix3d r = AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    return Affine(r, point - r * point);
}

static const Vector3d center(0.3, -2, 5);

TEST(Motion, IsTheIdentityByDefault) { EXPECT_EQ(Motion().matrix, Matrix4d::Identity()); }

TEST(Motion, RefusesNumbersThatAreNotFinite) {
    for (double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        for (int i = 0; i < 16; ++i) {
            Matrix4d m = Matrix4d::Identity();
            m(i) = bad;
            EXPECT_NE(MessageOf<Error>([&] { Motion{m}; }).find("finite"), std::string::npos);
        }
}

TEST(Motion, RefusesProjections) {
    for (int c = 0; c < 4; ++c) {
        Matrix4d m = Matrix4d::Identity();
        m(3, c) += 0.1;
        EXPECT_NE(MessageOf<Error>([&] { Motion{m}; }).find("affine"), std::string::npos);
    }
}

TEST(Motion, RefusesMirrorsAndFlattening) {
    for (const Vector3d &scale :
         {Vector3d(-1, 1, 1), Vector3d(-1, -1, -1), Vector3d(1, 1, 0), Vector3d(0, 0, 0), Vector3d(1, 1, 1e-14),
          Vector3d(-1e300, 1e300, 1e300), Vector3d(-1e-300, 1e-300, 1e-300)})
        EXPECT_NE(MessageOf<Error>([&] { Motion{Affine(scale.asDiagonal())}; }).find("determinant"), std::string::npos);
}

TEST(Motion, TakesRotationsTranslationsAndScalingsOfAnySize) {
    std::mt19937 random(1);
    for (double scale : {1e-300, 1e-30, 1e-3, 1.0, 1e3, 1e30, 1e300})
        EXPECT_NO_THROW(Motion{Affine(scale * RandomRotation(random), 1e6 * RandomVector(random))});
    EXPECT_NO_THROW(Motion{Affine(Vector3d(3, 0.2, 1).asDiagonal())});
}

TEST(Motion, WholeIsTheMatrixToTheBit) {
    for (unsigned seed = 1; seed < 50; ++seed) {
        const Matrix4d m = RandomRigid(seed).matrix();
        EXPECT_TRUE(SameBits(Motion(m).At(100, center), m));
    }
}

TEST(Motion, NoneIsTheIdentity) {
    for (unsigned seed = 1; seed < 50; ++seed) {
        Matrix4d m = RandomRigid(seed).matrix();
        m.topLeftCorner<3, 3>() *= 1 + 0.1 * seed;
        EXPECT_TRUE(Motion(m).At(0, center).isApprox(Matrix4d::Identity(), 1e-13));
    }
}

TEST(Motion, ComesCloseToTheWholeContinuously) {
    for (unsigned seed = 1; seed < 50; ++seed) {
        Matrix4d m = RandomRigid(seed).matrix();
        m.topLeftCorner<3, 3>() *= Eigen::DiagonalMatrix<double, 3>(1, 1.5, 0.7);
        EXPECT_TRUE(Motion(m).At(100 - 1e-9, center).isApprox(m, 1e-9));
    }
}

TEST(Motion, HalfOfATurnTwiceIsTheTurn) {
    std::mt19937 random(1);
    for (double angle : {1e-10, 1e-7, 1e-3, 0.5, 2.0, 3.1})
        for (int i = 0; i < 20; ++i) {
            const Matrix4d whole = TurnAbout(3 * RandomVector(random), RandomVector(random), angle);
            const Matrix4d half = Motion(whole).At(50, center);
            EXPECT_LE((half * half - whole).norm(), 1e-7) << angle;
            EXPECT_TRUE((half.topLeftCorner<3, 3>() * half.topLeftCorner<3, 3>().transpose()).isIdentity(1e-12));
        }
}

TEST(Motion, HalfOfAScrewTwiceIsTheScrew) {
    for (unsigned seed = 1; seed < 100; ++seed) {
        const Matrix4d whole = RandomRigid(seed).matrix();
        const Matrix4d half = Motion(whole).At(50, center);
        EXPECT_LE((half * half - whole).norm(), 1e-9) << seed;
    }
}

TEST(Motion, ATurnKeepsTheDistanceFromItsAxis) {
    const Vector3d pivot(10, -4, 2), axis = Vector3d(1, 2, -1).normalized();
    const Motion turn(TurnAbout(pivot, axis, 2.5));
    auto off = [&](const Vector3d &p) { return (p - pivot).cross(axis).norm(); };
    for (double percent : {-20.0, 10.0, 33.0, 75.0, 150.0, 300.0}) {
        const Matrix4d part = turn.At(percent, center);
        EXPECT_TRUE(part.isApprox(TurnAbout(pivot, axis, 2.5 * percent / 100), 1e-12)) << percent;
        EXPECT_NEAR(off(Apply(part, center)), off(center), 1e-12);
    }
}

TEST(Motion, HalfOfAHalfTurnIsAQuarter) {
    for (const Vector3d &axis : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(1, 1, 0)}) {
        const Matrix4d whole = TurnAbout(Vector3d(1, 2, 3), axis, M_PI), half = Motion(whole).At(50, center);
        EXPECT_LE((half * half - whole).norm(), 1e-9);
        EXPECT_NEAR(AngleAxisd(Eigen::Matrix3d(half.topLeftCorner<3, 3>())).angle(), M_PI / 2, 1e-9);
    }
}

TEST(Motion, TranslatesLinearly) {
    const Vector3d t(3, -1, 1000);
    const Motion motion(Affine(Eigen::Matrix3d::Identity(), t));
    for (double percent : {-50.0, 0.0, 25.0, 50.0, 150.0})
        EXPECT_TRUE(motion.At(percent, center).isApprox(Affine(Eigen::Matrix3d::Identity(), percent / 100 * t), 1e-14));
}

TEST(Motion, ScalesByThePower) {
    const Motion motion(Affine(8 * Eigen::Matrix3d::Identity(), Vector3d(1, 2, 3)));
    const Vector3d moved = Apply(motion.matrix, center) - center;
    for (double percent : {0.0, 50.0, 100.0 / 3, 150.0}) {
        const Matrix4d part = motion.At(percent, center);
        EXPECT_TRUE(
            (part.topLeftCorner<3, 3>()).isApprox(std::pow(8, percent / 100) * Eigen::Matrix3d::Identity(), 1e-12));
        EXPECT_LE((Apply(part, center) - center - percent / 100 * moved).norm(), 1e-12) << "the centre goes straight";
    }
}

TEST(Motion, StretchesAlongItsOwnAxes) {
    std::mt19937 random(1);
    const Eigen::Matrix3d axes = RandomRotation(random);
    const Motion motion(Affine(axes * Vector3d(4, 1, 0.25).asDiagonal() * axes.transpose()));
    const Eigen::Matrix3d half = axes * Vector3d(2, 1, 0.5).asDiagonal() * axes.transpose();
    EXPECT_TRUE((motion.At(50, center).topLeftCorner<3, 3>()).isApprox(half, 1e-12));
}

// --- turns ---

static const double degree = M_PI / 180;

/// A rotation by any angle about an axis through a point.
static Motion Turn(const Vector3d &axis, double degrees, const Vector3d &point) {
    return Motion(TurnAbout(point, axis, degrees * degree), degrees * degree * axis.normalized(), point);
}

TEST(MotionTurn, GoesAllTheWay) {
    const Vector3d pivot(10, -4, 2);
    for (const Vector3d &axis : {Vector3d(0, 0, 1), Vector3d(-1, 0, 0), Vector3d(1, 2, -1)})
        for (double degrees :
             {-3600.0, -720.0, -540.0, -360.0, -359.9999999, -270.0,    -180.0, -179.0, 1.0,   90.0,    179.0,
              180.0,   181.0,  270.0,  359.99, 360.0,        360.00001, 450.0,  540.0,  720.0, 100000.0})
            for (double percent : {-20.0, 10.0, 25.0, 50.0, 75.0, 150.0, 300.0}) {
                const Matrix4d wanted = TurnAbout(pivot, axis, degrees * degree * percent / 100);
                EXPECT_LE((Turn(axis, degrees, pivot).At(percent, center) - wanted).norm(), 1e-7)
                    << degrees << " at " << percent;
            }
}

TEST(MotionTurn, HalfOfThreeQuartersIsThreeEighths) {
    const Vector3d z(0, 0, 1), origin(0, 0, 0), x(1, 0, 0);
    for (const auto &c : {std::pair(270.0, 135.0), std::pair(360.0, 180.0), std::pair(-270.0, -135.0)}) {
        const Vector3d p = Apply(Turn(z, c.first, origin).At(50, center), x);
        EXPECT_LE((p - Vector3d(std::cos(c.second * degree), std::sin(c.second * degree), 0)).norm(), 1e-12);
    }
}

TEST(MotionTurn, HasBothEndsToTheBit) {
    for (double degrees : {-360.0, 200.0, 270.0, 360.0, 1000.0}) {
        const Motion turn = Turn(Vector3d(1, 2, 3), degrees, center);
        EXPECT_FALSE(turn.turn.isZero(0));
        EXPECT_TRUE(SameBits(turn.At(100, center), turn.matrix));
        EXPECT_TRUE(SameBits(turn.At(0, center), Matrix4d(Matrix4d::Identity())));
    }
}

TEST(MotionTurn, ComesCloseToTheWholeContinuously) {
    std::mt19937 random(1);
    for (double degrees : {-360.0, 200.0, 270.0, 360.0, 1000.0})
        for (int i = 0; i < 20; ++i) {
            // Stretched before, scaled after, shifted: the rotation is still the turn.
            const Vector3d axis = RandomVector(random), pivot = RandomVector(random), shift = RandomVector(random);
            const Eigen::Matrix3d axes = RandomRotation(random);
            Matrix4d m = TurnAbout(pivot, axis, degrees * degree) *
                         Affine(1.7 * axes * Vector3d(1, 2, 0.5).asDiagonal() * axes.transpose());
            m.topRightCorner<3, 1>() += shift;
            const Motion motion(m, degrees * degree * axis.normalized(), pivot);
            ASSERT_FALSE(motion.turn.isZero(0));
            EXPECT_LE((motion.At(100 - 1e-9, center) - m).norm(), 1e-8 * m.norm());
            EXPECT_LE((motion.At(1e-9, center) - Matrix4d::Identity()).norm(), 1e-8);
        }
}

TEST(MotionTurn, TheRestOfTheWayIsStraight) {
    const Vector3d shift(5, 1, -2);
    const Matrix4d m = Affine(Eigen::Matrix3d::Identity(), shift) * TurnAbout(center, Vector3d(0, 0, 1), 2 * M_PI);
    const Motion motion(m, Vector3d(0, 0, 2 * M_PI), center);
    for (double percent : {10.0, 50.0, 90.0, 120.0})
        EXPECT_LE((Apply(motion.At(percent, center), center) - center - percent / 100 * shift).norm(), 1e-12);
}

TEST(MotionTurn, UpToHalfATurnIsTheScrew) {
    for (double degrees : {-179.0, -90.0, 1.0, 179.0}) {
        Matrix4d m = TurnAbout(center, Vector3d(1, 2, 3), degrees * degree);
        m(0, 3) += 5;
        const Motion motion(m, degrees * degree * Vector3d(1, 2, 3).normalized(), center);
        EXPECT_TRUE(SameBits(motion.At(30, center), Motion(m).At(30, center)));
    }
}

TEST(MotionTurn, IsDroppedWhereTheMatrixRotatesOtherwise) {
    const Matrix4d quarter = TurnAbout(center, Vector3d(0, 0, 1), M_PI / 2);
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const Vector3d &turn : {Vector3d(0, 0, 4), Vector3d(4, 0, 0), Vector3d(0, 0, -2.5 * M_PI),
                                 Vector3d(0, 0, infinity), Vector3d(nan, 0, 0), Vector3d(0, 0, 1e300)}) {
        EXPECT_TRUE(Motion(quarter, turn, center).turn.isZero(0));
        EXPECT_TRUE(SameBits(Motion(quarter, turn, center).At(50, center), Motion(quarter).At(50, center)));
    }
    EXPECT_TRUE(Motion(quarter, Vector3d(0, 0, 2.5 * M_PI), Vector3d(nan, 0, 0)).turn.isZero(0));
    EXPECT_EQ(Motion(quarter, Vector3d(0, 0, 2.5 * M_PI), center).turn, Vector3d(0, 0, 2.5 * M_PI));
}

TEST(HandlesToMesh, TheIdentityChangesNoBit) {
    const Matrix4d motion = Turn(Vector3d(1, 2, 3), 50, center).matrix;
    Handles handles;
    EXPECT_TRUE(SameBits(handles.ToMesh(motion), motion));
    handles.world = RandomRigid(1);
    handles.world.linear().col(0) *= 3;
    EXPECT_TRUE(SameBits(handles.ToMesh(Matrix4d::Identity()), Matrix4d(Matrix4d::Identity())));
}

TEST(HandlesToMesh, IsTheMotionInTheWorld) {
    for (unsigned seed = 1; seed < 20; ++seed)
        for (double scale : {1.0, 2.5, -1.0, -0.01}) { // below 0: mirrors
            Handles handles;
            handles.world = RandomRigid(seed);
            handles.world.linear() = handles.world.linear() * Vector3d(scale, 1, 3).asDiagonal();
            const Matrix4d world = Turn(Vector3d(1, 2, 3), 300, center).At(50, center), mesh = handles.ToMesh(world);
            const Vector3d p(0.3, -2, 1);
            const Vector3d there = handles.world * (mesh * p.homogeneous()).head<3>().eval(),
                           wanted = (world * (handles.world * p).homogeneous()).head<3>();
            EXPECT_LE((there - wanted).norm(), 1e-11);
            EXPECT_EQ(mesh.row(3), Eigen::RowVector4d(0, 0, 0, 1));
        }
}

TEST(CountTags, CountsLiveVertices) {
    MeshD mesh(Points(Grid(5, 2)));
    mesh.DeleteVertex(0);
    mesh.DeleteVertex(9);
    const TagCount count = vcg::tri::CountTags(mesh, {0, 0, 1, 1, 1, 2, 7, -1, -5, 2});
    EXPECT_EQ(count.fixed, 1);
    EXPECT_EQ(count.free, 3);
    EXPECT_EQ(count.handle, 2);
    EXPECT_EQ(count.outside, 2);
}

TEST(CountTags, RefusesAWrongNumberOfTags) {
    const MeshD mesh(Grid(3, 3));
    for (std::size_t n : {0, 8, 10}) {
        const std::string message = MessageOf<Error>([&] { vcg::tri::CountTags(mesh, std::vector<int>(n, 1)); });
        EXPECT_NE(message.find(std::to_string(n) + " tags for 9 vertices"), std::string::npos) << message;
    }
}
