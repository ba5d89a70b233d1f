// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

static DeformationCheck CheckOf(const Case &c, double pose = 100) {
    DeformationParam param;
    param.graph.initialPatches = 60;
    param.pose = pose;
    return vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).check;
}

/// A sheet of 3 x 3, its first and its last quarter held, the last moved by \p motion.
static Case SheetCase(const Affine3d &motion) {
    return CaseOf(
        Grid(31, 31, 0.1), [](const Vector3d &p) { return p[0] < 0.75   ? 0
                                                          : p[0] > 2.25 ? 2
                                                                        : 1; }, motion);
}

TEST(DeformationCheck, FindsNothingWhereAllIsWell) {
    for (const Affine3d &motion : {Affine3d::Identity(), Affine3d(Translation3d(0.5, 0.3, 1)),
                                   Affine3d(Translation3d(0, 0, 1) * Eigen::AngleAxisd(-2, Vector3d::UnitY()))}) {
        const DeformationCheck check = CheckOf(SheetCase(motion));
        EXPECT_FALSE(check.rigid);
        EXPECT_EQ(check.overruled, 0);
        EXPECT_EQ(check.strained, 0);
        EXPECT_EQ(check.longest, 1);
        EXPECT_EQ(check.flipped, 0);
    }
}

/// CountFlipped with a single patch, which \p linear turns.
static Index FoldedOf(const MeshD &mesh, const Eigen::Matrix3Xd &position, const Eigen::Matrix3d &linear) {
    const std::vector<int> free(mesh.vert.size(), 1);
    SurfaceGraph surface = ReadFreeSurface(Read(mesh), free, Eigen::Matrix3d::Identity(), {});
    vcg::fcd::MovingSurface moving;
    moving.nodeOf = surface.nodeOf;
    auto region = std::make_shared<vcg::fcd::MovingRegion>(std::move(surface), vcg::fcd::HeldNodes());
    region->patches.patchOf.assign(std::size_t(region->surface.graph.Size()), 0);
    moving.regions.push_back(region);
    return vcg::fcd::detail::CountFlipped(Read(mesh), moving, 0, {linear}, position, {});
}

TEST(DeformationCheck, CountsTrianglesThatTurnedOver) {
    const Shape shape = Grid(21, 21);
    MeshD mesh(shape);
    Eigen::Matrix3Xd posed = PositionsOf(mesh);
    EXPECT_EQ(FoldedOf(mesh, posed, Eigen::Matrix3d::Identity()), 0);
    EXPECT_EQ(FoldedOf(mesh, -posed, Vector3d(-1, -1, 1).asDiagonal()), 0);
    std::mt19937 random(1);
    for (int i = 0; i < 30; ++i)
        posed(int(random() % 2), int(random() % 441)) += 1.5;
    Index expected = 0;
    for (const auto &f : shape.face) {
        const Vector3d a = posed.col(f[0]), b = posed.col(f[1]), c = posed.col(f[2]);
        expected += (b - a).cross(c - a)[2] < 0;
    }
    ASSERT_GT(expected, 20);
    EXPECT_EQ(FoldedOf(mesh, posed, Eigen::Matrix3d::Identity()), expected);
    for (unsigned seed = 1; seed < 10; ++seed) {
        const Affine3d motion = RandomRigid(seed);
        EXPECT_EQ(FoldedOf(mesh, motion * posed, 3 * motion.linear()), expected) << "a turn as a whole is no fold";
    }
    posed.row(1) *= 1e-4;
    Shape needles = shape;
    for (Vector3d &p : needles.position)
        p[1] *= 1e-4;
    EXPECT_EQ(FoldedOf(MeshD(needles), posed, Eigen::Matrix3d::Identity()), 0) << "the normals of needles are noise";
    for (std::size_t f = 0; f < mesh.face.size(); ++f)
        mesh.DeleteFace(int(f));
    EXPECT_EQ(FoldedOf(mesh, posed, Eigen::Matrix3d::Identity()), 0) << "deleted faces do not count";
}

TEST(DeformationCheck, SeesThatAllMovesAsOne) {
    const Affine3d motion = RandomRigid(1);
    Case c = SheetCase(motion);
    EXPECT_FALSE(CheckOf(c).rigid) << "something is fixed";
    for (int &tag : c.handles.tag)
        tag = tag == 0 ? 1 : tag;
    EXPECT_TRUE(CheckOf(c).rigid);
    EXPECT_TRUE(CheckOf(c, 50).rigid);
    EXPECT_FALSE(CheckOf(c, 0).rigid) << "nothing moves";
    c.handles.tag[0] = 3;
    EXPECT_FALSE(CheckOf(c).rigid) << "another handle stays";
    c.handles.motion[3] = Motion(motion.matrix());
    EXPECT_TRUE(CheckOf(c).rigid);
    c.handles.tag[0] = -1;
    EXPECT_FALSE(CheckOf(c).rigid) << "outside stays";
    c.handles.tag[0] = 1;
    c.handles.point = {{0, c.shape.position[0] + Vector3d(0, 0, 1)}};
    EXPECT_FALSE(CheckOf(c).rigid) << "a point goes elsewhere";
    c.handles.tag.assign(c.handles.tag.size(), 1);
    EXPECT_TRUE(CheckOf(c).rigid) << "a single point";
}

TEST(DeformationCheck, CountsEdgesBetweenHeldRegionsThatStretch) {
    Case c = SheetCase(Affine3d(Translation3d(0, 0, 0.5)));
    c.handles.tag[15 * 31 + 8] = 2; // the next to the right of the fixed column 7, row 15
    const DeformationCheck check = CheckOf(c);
    EXPECT_EQ(check.strained, 2) << "along the row, and along the diagonal";
    EXPECT_NEAR(check.longest, std::hypot(0.5, 0.1) / 0.1, 1e-4);
    EXPECT_EQ(CheckOf(c, 10).strained, 0);
    c.handles.motion[2] = Motion(Affine3d(Translation3d(-0.08, 0, 0)).matrix());
    EXPECT_EQ(CheckOf(c).strained, 1) << "a fifth of the row's edge is left";
}

TEST(DeformationCheck, CountsHandleVerticesThatAnotherTagHolds) {
    Case c = SheetCase(Affine3d(Translation3d(0, 0, 0.5)));
    const int n = c.shape.Size();
    c.shape = Join(c.shape, c.shape);
    c.handles.tag.insert(c.handles.tag.end(), c.handles.tag.begin(), c.handles.tag.end());
    ASSERT_TRUE(c.handles.tag[7] == 0 && c.handles.tag[15] == 1 && c.handles.tag[23] == 2);
    const auto overruled = [&](int vertex, int tag) {
        Case other = c;
        other.handles.tag[n + vertex] = tag;
        return CheckOf(other).overruled;
    };
    EXPECT_EQ(CheckOf(c).overruled, 0);
    EXPECT_EQ(overruled(7, 2), 1) << "fixed wins";
    EXPECT_EQ(overruled(23, -5), 1) << "so does outside";
    EXPECT_EQ(overruled(23, 3), 1) << "the smaller number wins";
    EXPECT_EQ(overruled(7, -1), 0);
    EXPECT_EQ(overruled(15, 2), 0) << "what is free has no say";
}
