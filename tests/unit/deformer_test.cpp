// SPDX-License-Identifier: GPL-3.0-or-later
#include "centroidal_deformation.h"
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A tube bent at one end, with a loose ring beside it.
struct DeformerRig {
    Case bend;
    MeshD mesh;
    DeformationParam param;
    Matrix3Xd rest;
    std::unique_ptr<Deformer> deformer;

    explicit DeformerRig(const Affine3d &motion, const Eigen::Matrix3d &world = Eigen::Matrix3d::Identity())
        : bend(CaseOf(
              Tube(24, 60), [](const Vector3d &p) { return p[2] < 0.7   ? 0
                                                           : p[2] > 5.2 ? 2
                                                                        : 1; }, motion)),
          mesh(bend.shape) {
        bend.handles.world.linear() = world;
        param.graph.initialPatches = 50;
        deformer = vcg::tri::PrepareDeformer(mesh, bend.handles, param, rest);
    }
};

static Affine3d BentEnd() { return Eigen::Translation3d(0.5, 0, 0) * Eigen::AngleAxisd(0.9, Vector3d::UnitY()); }

TEST(Deformer, EachPoseIsThatOfADeformationAnew) {
    DeformerRig rig(BentEnd());
    for (double pose : {30.0, 100.0, -50.0, 30.0, 0.0}) {
        rig.param.pose = pose;
        Matrix3Xd position = rig.rest;
        const Deformer::Pose solved = rig.deformer->Solve(rig.bend.handles, rig.param);
        Carrier(*rig.deformer, solved).Apply(position);
        EXPECT_TRUE(SameBits(position, vcg::tri::DeformCentroidal(rig.mesh, rig.bend.handles, rig.param).position));
    }
}

TEST(Deformer, GivesWhatMayMoveOnceAndNothingElse) {
    DeformerRig rig(BentEnd());
    const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
    for (unsigned threads : {1u, 3u}) {
        Progress progress;
        progress.threads = threads;
        std::vector<std::atomic<int>> taken(rig.mesh.vert.size());
        Matrix3Xd position = rig.rest, applied = rig.rest;
        Carrier(*rig.deformer, pose).Apply(applied);
        Carrier(*rig.deformer, pose)
            .Apply([&](std::size_t i) { return Vector3d(rig.rest.col(Eigen::Index(i))); },
                   [&] {
                       return [&](std::size_t i, const Vector3d &p, const Eigen::Matrix3f &) {
                           ++taken[i];
                           position.col(Eigen::Index(i)) = p;
                       };
                   },
                   true, progress, [](std::size_t) {});
        EXPECT_TRUE(SameBits(position, applied));
        std::vector<int> moving(taken.size(), 0);
        rig.deformer->ForMoving([&](std::size_t i) { ++moving[i]; });
        for (std::size_t i = 0; i < taken.size(); ++i) {
            ASSERT_EQ(taken[i], moving[i]);
            ASSERT_EQ(moving[i], rig.bend.handles.tag[i] != 0);
        }
    }
}

TEST(Deformer, TurnsNormalsWithTheSurface) {
    for (const Eigen::Matrix3d &world : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
                                         Eigen::Matrix3d(RandomRigid(5).linear() * Vector3d(1, 2, 0.5).asDiagonal())}) {
        DeformerRig rig(BentEnd(), world);
        const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
        Matrix3Xd expected = rig.rest;
        std::vector<Eigen::Matrix3f> linear;
        Carrier(*rig.deformer, pose).Apply(expected, &linear);
        Matrix3Xd normal(3, rig.rest.cols()), position = rig.rest;
        for (Eigen::Index i = 0; i < normal.cols(); ++i) // of several lengths, one of them 0
            normal.col(i) = double(i % 7) * RandomRigid(unsigned(i)).linear().col(0);
        Matrix3Xd turned = normal;
        Carrier(*rig.deformer, pose)
            .ApplyWithNormals([&](std::size_t i) { return Vector3d(rig.rest.col(Eigen::Index(i))); },
                              [&](std::size_t i) { return Vector3d(normal.col(Eigen::Index(i))); },
                              [&] {
                                  return [&](std::size_t i, const Vector3d &p, const Vector3d &n) {
                                      position.col(Eigen::Index(i)) = p;
                                      turned.col(Eigen::Index(i)) = n;
                                  };
                              },
                              Progress(), [](std::size_t) {});
        EXPECT_TRUE(SameBits(position, expected));
        for (std::size_t i = 0; i < linear.size(); ++i) {
            const Vector3d before = normal.col(Eigen::Index(i)), after = turned.col(Eigen::Index(i));
            if (linear[i].isIdentity(0))
                ASSERT_EQ(after, before);
            ASSERT_LE((after - Turned(linear[i], before)).norm(), 1e-5);
            ASSERT_NEAR(after.norm(), before.norm(), 1e-5);
        }
    }
}

TEST(Deformer, CarriesItsOwnVerticesWhereTheyGo) {
    DeformerRig rig(BentEnd());
    const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
    Matrix3Xd position = rig.rest;
    std::vector<Eigen::Matrix3f> linear;
    const Carrier carrier(*rig.deformer, pose);
    carrier.Apply(position, &linear);
    Eigen::Matrix3f map;
    for (std::size_t i = 0; i < rig.mesh.vert.size(); ++i) {
        const Vector3d p = rig.rest.col(Eigen::Index(i));
        ASSERT_LE((carrier(i, p, map) - position.col(Eigen::Index(i))).norm(), 1e-12);
        ASSERT_LE((map - linear[i]).norm(), 1e-6);
    }
}

TEST(Deformer, CarriesPointsBesideItRigidlyWhereAllMovesSo) {
    const Affine3d motion = RandomRigid(3);
    Case c = CaseOf(
        Tube(24, 60), [](const Vector3d &p) { return p[2] > 5.2 ? 2 : 1; }, motion);
    const MeshD mesh(c.shape);
    Matrix3Xd rest;
    DeformationParam param;
    const auto deformer = vcg::tri::PrepareDeformer(mesh, c.handles, param, rest);
    const Deformer::Pose pose = deformer->Solve(c.handles, param);
    const Carrier carrier(*deformer, pose);
    Eigen::Matrix3f map;
    for (std::size_t i = 0; i < mesh.vert.size(); i += 5) {
        const Vector3d p = rest.col(Eigen::Index(i)) + Vector3d(0.3, -0.2, 0.1);
        EXPECT_LE((carrier(i, p, map) - motion * p).norm(), 1e-5);
    }
}

TEST(Deformer, KnowsItsNodes) {
    DeformerRig rig(BentEnd());
    const auto nodes = vcg::tri::DeformCentroidal(rig.mesh, rig.bend.handles, rig.param).rest.position;
    EXPECT_TRUE(HasNodes(*rig.deformer, nodes));
    EXPECT_TRUE(HasNodes(*rig.deformer, nodes.cast<float>().cast<double>()));
    Matrix3Xd other = nodes;
    other(1, 3) += 0.01;
    EXPECT_FALSE(HasNodes(*rig.deformer, other));
    EXPECT_FALSE(HasNodes(*rig.deformer, nodes.leftCols(nodes.cols() - 1)));
}
