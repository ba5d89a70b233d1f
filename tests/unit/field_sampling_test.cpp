// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/field/field_sampling.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A mesh that is deformed.
struct SampledCase {
    MeshD mesh;
    Handles handles;
    Matrix3Xd rest, deformed;
    std::vector<Eigen::Matrix3f> linear;

    explicit SampledCase(const Case &c) : mesh(c.shape), handles(c.handles) {
        DeformationParam param;
        param.graph.initialPatches = 50;
        const auto deformer = PrepareDeformer(Read(mesh), handles, param);
        deformed = rest = PositionsOf(mesh);
        const SurfacePose pose = deformer->Solve(handles, param);
        Carrier(*deformer, pose).Apply(deformed, &linear);
    }
    SampledField Sample(const FieldParam &param = {}, const Progress &progress = {}) const {
        return SampleField(Read(mesh), rest, deformed, linear, param, progress);
    }
    double Size() const { return (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm(); }
    /// The diagonal of the box of what moves.
    double MovingSize() const {
        Eigen::AlignedBox3d box;
        for (Eigen::Index i = 0; i < rest.cols(); ++i)
            if (rest.col(i) != deformed.col(i))
                box.extend(Vector3d(rest.col(i)));
        return box.diagonal().norm();
    }
    double Motion() const { return (deformed - rest).colwise().norm().maxCoeff(); }
    /// \param tolerance over the diagonal of the box of what moves
    FieldParam Few(Index moving, Index resting, double tolerance) const {
        FieldParam param;
        param.moving = moving;
        param.resting = resting;
        param.accuracy = tolerance * MovingSize();
        return param;
    }

    /// Expects that the field moves each vertex of a face as the deformation does, and keeps vertices at rest.
    void ExpectCarried(const SampledField &sampled, double tolerance) const {
        EXPECT_EQ(sampled.off, 0);
        EXPECT_EQ(sampled.stirred, 0);
        const DeformationField field(sampled.samples);
        const double allowed = tolerance * Size();
        double largest = 0;
        for (Eigen::Index i = 0; i < rest.cols(); ++i) {
            const Vector3d p = rest.col(i), there = p + field(p);
            const double off = (there - deformed.col(i)).norm();
            ASSERT_LE(off, allowed) << "vertex " << i;
            if (handles.tag[std::size_t(i)] <= 0)
                ASSERT_TRUE(SameBits(there, p)) << "vertex " << i;
            else
                largest = std::max(largest, off);
        }
        EXPECT_NEAR(sampled.largest, largest, 1e-6 * Size());
        EXPECT_LE(sampled.rms, sampled.largest);
    }
};

TEST(FieldSampling, TellsADeformationByFewVertices) {
    const SampledCase c(CaseOf(Tube(100, 120), [](const Vector3d &p) { return TubeTag(p); }));
    const SampledField sampled = c.Sample(c.Few(300, 100, 1e-3));
    c.ExpectCarried(sampled, 1e-3);
    EXPECT_LT(sampled.samples.Size(), c.rest.cols() / 5);
    EXPECT_GT(sampled.rounds, 1);
    EXPECT_LT(sampled.rms, 5e-4 * c.Size());
}

TEST(FieldSampling, OfARegionDoesNotDependOnOthers) {
    // Two regions with a handle between them, or two that touch, and a third one behind fixed vertices.
    const Shape tube = Tube(60, 150);
    const double end = tube.position.back()[2];
    const auto tagOf = [&](const Vector3d &p, bool more, bool two) {
        const double z = p[2] / end;
        if (two && z >= 0.4 && z < 0.5)
            return more ? 3 : 0;
        return z < 0.05 ? 0 : z < 0.3 ? 1 : z < 0.4 ? 2 : z < 0.6 ? int(more) : z < 0.7 ? 0 : z < 0.9 ? int(more) : 3;
    };
    for (const bool two : {false, true})
        for (const Shape &shape : {tube, Unwelded(Tube(30, 80)), Points(tube)}) {
            std::vector<Matrix3Xd> moved;
            for (const bool more : {false, true}) {
                Handles handles;
                for (const Vector3d &p : shape.position)
                    handles.tag.push_back(tagOf(p, more, two));
                handles.motion[2] = Motion(Affine3d(Eigen::AngleAxisd(0.5, Vector3d::UnitZ())).matrix());
                handles.motion[3] = Motion(Affine3d(Eigen::Translation3d(0.3, 0, 0)).matrix());
                const Arrays arrays = Read(MeshD(shape));
                const SurfaceView view(arrays);
                const auto deformer = PrepareDeformer(view, handles, DeformationParam());
                Matrix3Xd rest = view.Copy(), deformed = rest;
                std::vector<Eigen::Matrix3f> linear;
                const SurfacePose pose = deformer->Solve(handles, DeformationParam());
                Carrier(*deformer, pose).Apply(deformed, &linear);
                const SampledField sampled =
                    SampleField(view, rest, deformed, linear, {}, {}, Eigen::Matrix3d::Identity(), deformer->FreeIn());
                EXPECT_EQ(sampled.off, 0);
                EXPECT_EQ(sampled.stirred, 0);
                const DeformationField field(sampled.samples);
                // At the vertices, and off the surface.
                moved.emplace_back(3, 2 * rest.cols());
                for (Eigen::Index i = 0; i < rest.cols(); ++i) {
                    moved.back().col(i) = field(rest.col(i));
                    const Vector3d off = 0.03 * end * Vector3d(std::sin(7 * i), std::sin(11 * i), std::sin(13 * i));
                    moved.back().col(rest.cols() + i) = field(rest.col(i) + off);
                }
            }
            for (Eigen::Index i = 0; i < moved[0].cols(); ++i)
                if (const double z = shape.position[std::size_t(i) % shape.position.size()][2] / end;
                    z < (i < Eigen::Index(shape.position.size()) ? 0.39 : 0.35))
                    ASSERT_EQ(moved[0].col(i), moved[1].col(i)) << "at " << z << (two ? ", beside another handle" : "");
        }
}

TEST(FieldSampling, MoreSamplesWhereTheToleranceAsksForThem) {
    const SampledCase c(CaseOf(Tube(60, 80), [](const Vector3d &p) { return TubeTag(p); }));
    const SampledField coarse = c.Sample(c.Few(100, 50, 4e-3)), fine = c.Sample(c.Few(100, 50, 8e-4));
    c.ExpectCarried(coarse, 4e-3);
    c.ExpectCarried(fine, 8e-4);
    EXPECT_GT(fine.samples.Size(), 2 * coarse.samples.Size());
}

TEST(FieldSampling, PartsThatAreNearStayApart) {
    // One of two sheets is lifted, the other is fixed: neither affects the other.
    const SampledCase c(CaseOf(TwoSheets(60, 0.3), [](const Vector3d &p) {
        return p[2] < 0.1 ? 0 : p[0] < 9 ? 0 : p[0] > 50 ? 2 : 1;
    }));
    c.ExpectCarried(c.Sample(c.Few(30, 5, 1e-3)), 1e-3);
}

TEST(FieldSampling, NarrowPartsHaveEdgesAndPoints) {
    // A strip one quad wide, which needs far fewer samples than vertices, and a small triangle beside it.
    const SampledCase c(CaseOf(Join(Strip(300), Moved(Triangle(), Eigen::Affine3d(Eigen::Translation3d(20, 40, 0)))),
                               [](const Vector3d &p) { return p[0] < 40    ? 0
                                                              : p[0] > 260 ? 2
                                                                           : 1; }));
    const SampledField sampled = c.Sample(c.Few(40, 5, 1e-2));
    c.ExpectCarried(sampled, 1e-2);
    int edges = 0, points = 0;
    for (const auto &t : sampled.samples.triangle) {
        points += t[0] == t[1] && t[1] == t[2];
        edges += t[0] != t[1] && t[1] == t[2];
    }
    EXPECT_GT(edges, 3);
    EXPECT_GE(points, 1);
}

TEST(FieldSampling, AcceptsSeamsCloudsAndDeletedElements) {
    const auto tag = [](const Vector3d &p) { return TubeTag(p); };
    const SampledCase seams(CaseOf(Unwelded(Tube(40, 30)), tag));
    seams.ExpectCarried(seams.Sample(seams.Few(100, 50, 2e-3)), 2e-3);
    const SampledCase cloud(CaseOf(Points(Tube(60, 60)), tag));
    const SampledField sampled = cloud.Sample(cloud.Few(300, 50, 4e-3));
    cloud.ExpectCarried(sampled, 4e-3);
    EXPECT_TRUE(sampled.samples.triangle.empty());
    SampledCase holes(CaseOf(Tube(40, 30), tag));
    for (int f = 0; f < 500; f += 7)
        holes.mesh.DeleteFace(f);
    const SampledField whole = holes.Sample(holes.Few(100, 50, 2e-3));
    EXPECT_EQ(whole.off + whole.stirred, 0);
}

TEST(FieldSampling, NothingMovesWhereNothingDid) {
    SampledCase c(CaseOf(
        Tube(20, 30), [](const Vector3d &p) { return TubeTag(p); }, Eigen::Affine3d::Identity()));
    const SampledField sampled = c.Sample();
    c.ExpectCarried(sampled, 0);
    EXPECT_EQ(sampled.largest, 0);
}

TEST(FieldSampling, TellsWhatItCannotCarry) {
    // Two vertices at the same position that move apart.
    SampledCase c(CaseOf(Unwelded(Grid(2, 2)), [](const Vector3d &p) { return p[0] > 0.5 ? 2 : p[1] > 0.5 ? 1 : 0; }));
    for (Eigen::Index i = 0; i < c.rest.cols(); ++i)
        if (c.rest.col(i) == c.rest.col(0) && i > 0)
            c.deformed.col(i) += Vector3d(0, 0, 1);
    for (Eigen::Index i = 1; i < c.rest.cols(); ++i)
        c.deformed.col(i) += Vector3d(0, 0, double(i));
    const SampledField sampled = c.Sample();
    EXPECT_GT(sampled.off, 0);
    EXPECT_GT(sampled.largest, 0.4);
}

// Samples lie on faces, so a vertex without one goes with the nearest face.
TEST(FieldSampling, TellsOfVerticesWithoutAFace) {
    Shape shape = Grid(9, 9);
    shape.position.emplace_back(4, 4, 3);
    const MeshD mesh(shape);
    const Matrix3Xd rest = PositionsOf(mesh);
    Matrix3Xd deformed = rest;
    deformed.row(2).array() += 1;
    const std::vector<Eigen::Matrix3f> linear(std::size_t(rest.cols()), Eigen::Matrix3f::Identity());
    EXPECT_EQ(SampleField(Read(mesh), rest, deformed, linear).Warning(), "");
    deformed.rightCols(1).array() += 1;
    const SampledField sampled = SampleField(Read(mesh), rest, deformed, linear);
    EXPECT_EQ(sampled.off, 0);
    EXPECT_EQ(sampled.faceless, 1);
    EXPECT_NE(sampled.Warning().find("1 vertices without a face are farther off than"), std::string::npos);
}

TEST(FieldSampling, IsTheSameForAnyNumberOfThreadsAndCanBeCancelled) {
    const SampledCase c(CaseOf(Tube(60, 100), [](const Vector3d &p) { return TubeTag(p); }));
    const FieldSamples one = c.Sample(c.Few(200, 50, 1e-3), Threads(1)).samples,
                       three = c.Sample(c.Few(200, 50, 1e-3), Threads(3)).samples;
    EXPECT_TRUE(SameBits(one.position, three.position));
    EXPECT_TRUE(SameBits(one.displacement, three.displacement));
    EXPECT_EQ(one.triangle, three.triangle);
    for (double at : {0.1, 0.3, 0.6})
        EXPECT_THROW(c.Sample({}, Progress([](int, const char *) { return false; }).Slice(at, 1)), Cancelled);
}

TEST(FieldSampling, TakesAsManySamplesAsThePromiseNeeds) {
    // Each vertex of a surface moves differently: only all vertices as samples tell that.
    const int n = sanitized ? 90 : 260;
    const MeshD mesh(Grid(n, n));
    const Matrix3Xd rest = PositionsOf(mesh);
    Matrix3Xd deformed = rest;
    std::uint32_t random = 1;
    for (Eigen::Index i = 0; i < rest.cols(); ++i)
        deformed(2, i) += 1 + double((random = random * 1664525 + 1013904223) >> 8) * 0x1p-24;
    const std::vector<Eigen::Matrix3f> linear(std::size_t(rest.cols()), Eigen::Matrix3f::Identity());
    const SampledField sampled = SampleField(Read(mesh), rest, deformed, linear);
    EXPECT_EQ(sampled.off, 0);
    EXPECT_LE(sampled.largest, 1e-4 * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm());
    EXPECT_GT(sampled.samples.Size(), 0.887 * n * n); // 60000
    EXPECT_LT(sampled.rounds, 20);
}

TEST(FieldSampling, KeepsToANumberOfSamples) {
    const SampledCase c(CaseOf(Tube(60, 80), [](const Vector3d &p) { return TubeTag(p); }));
    FieldParam param = c.Few(100, 50, 1e-5);
    param.most = 700;
    const SampledField sampled = c.Sample(param), coarse = c.Sample(c.Few(100, 50, 1));
    EXPECT_LE(sampled.samples.Size(), 700);
    EXPECT_GT(sampled.samples.Size(), 650);
    EXPECT_GT(sampled.off, 0);
    EXPECT_EQ(sampled.stirred, 0);
    EXPECT_LT(sampled.largest, 0.5 * coarse.largest);
}

TEST(FieldSampling, IsAsExactAsTheMotionIsSmall) {
    SampledCase c(CaseOf(Tube(60, 80), [](const Vector3d &p) { return TubeTag(p); }));
    EXPECT_NEAR(c.Sample().accuracy, 1e-4 * c.MovingSize(), 1e-12 * c.Size());
    const double part = 0.0015 * c.Size() / c.Motion(); // a slide
    c.deformed = c.rest + part * (c.deformed - c.rest);
    for (Eigen::Matrix3f &each : c.linear)
        each = Eigen::Matrix3f::Identity() + float(part) * (each - Eigen::Matrix3f::Identity());
    FieldParam few = c.Few(100, 50, 0);
    const SampledField sampled = c.Sample(few);
    EXPECT_NEAR(sampled.accuracy, c.Motion() / 50, 1e-12 * c.Size());
    c.ExpectCarried(sampled, c.Motion() / 50 / c.Size());
    for (double asked : {c.Motion() / 20, c.Motion() / 500}) {
        few.accuracy = asked;
        const SampledField exact = c.Sample(few);
        EXPECT_EQ(exact.accuracy, asked);
        c.ExpectCarried(exact, asked / c.Size());
        EXPECT_EQ(exact.samples.Size() > sampled.samples.Size(), asked < sampled.accuracy);
    }
}

TEST(FieldSampling, IsNoMoreExactThanPositionsAreRounded) {
    SampledCase c(CaseOf(Tube(20, 30), [](const Vector3d &p) { return TubeTag(p); }));
    const Vector3d away(652000.123, 5102334.456, 300);
    c.rest.colwise() += away;
    c.deformed.colwise() += away;
    FieldParam param;
    param.accuracy = 1e-300;
    const SampledField sampled = c.Sample(param);
    EXPECT_GT(sampled.accuracy, 1e-9);
    EXPECT_LT(sampled.accuracy, 1e-8);
    EXPECT_EQ(sampled.off, 0);
    EXPECT_LE(sampled.largest, sampled.accuracy);
    for (double bad : {-1.0, double(NAN), double(INFINITY)}) {
        param.accuracy = bad;
        EXPECT_NE(MessageOf<BadInput>([&] { c.Sample(param); }).find("must be a positive number, or 0"),
                  std::string::npos);
    }
}

TEST(FieldSampling, LooksAtWhatSamplesOfACloudChange) {
    // All vertices around a new sample are compared again, so comparing all finds hardly anything more.
    const SampledCase c(CaseOf(Points(Tube(150, 160)), [](const Vector3d &p) { return TubeTag(p); }));
    const SampledField sampled = c.Sample(c.Few(500, 50, 1e-3));
    c.ExpectCarried(sampled, 1e-3);
    EXPECT_LT(sampled.rounds, 15);
}
