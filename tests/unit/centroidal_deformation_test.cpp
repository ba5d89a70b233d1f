// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include "test_support.h"

#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using vcg::tri::BuildCentroidalGraph;
using vcg::tri::DeformCentroidal;

static Case TubeCase() {
    return CaseOf(Jittered(Tube(40, 16), 0.02), [](const Vector3d &p) { return TubeTag(p); });
}
static Case GridCase() {
    return CaseOf(Grid(25, 25, 0.25), [](const Vector3d &p) {
        return p[0] < 1 ? 0 : p[0] > 5 ? 2 : p[1] < 0.7 ? -1 : 1;
    });
}
static Case SphereCase() {
    return CaseOf(Sphere(24, 32), [](const Vector3d &p) {
        return p[2] < -0.7 ? 0 : p[2] > 0.7 ? 2 : p[0] > 0.9 ? 3 : 1;
    });
}

static DeformationParam Param(int patches = 40) {
    DeformationParam param;
    param.graph.initialPatches = patches;
    return param;
}

static Matrix3Xd Deformed(const Case &c, const DeformationParam &param = Param()) {
    return DeformCentroidal(MeshD(c.shape), c.handles, param).position;
}

TEST(DeformCentroidal, HeldVerticesAreExact) {
    for (const Case &c : {TubeCase(), GridCase(), SphereCase()})
        for (MappingWeights weights : {MappingWeights::Surface, MappingWeights::Euclidean}) {
            DeformationParam param = Param();
            param.weights = weights;
            const MeshD mesh(c.shape);
            const DeformationResult r = DeformCentroidal(mesh, c.handles, param);
            EXPECT_TRUE(r.converged);
            ExpectHeldExact(mesh, c.handles, r.position);
        }
}

TEST(DeformCentroidal, OneRigidMotionMovesTheWholeMesh) {
    for (Case c : {TubeCase(), SphereCase()})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            const Affine3d rigid = RandomRigid(seed);
            for (int &tag : c.handles.tag)
                tag = tag == 0 ? 4 : tag;
            for (int tag : {2, 3, 4})
                c.handles.motion[tag] = Motion(rigid.matrix());
            DeformationParam param = Param();
            param.tolerance = 1e-9;
            const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
            EXPECT_LE((Deformed(c, param) - rigid * rest).cwiseAbs().maxCoeff(), 1e-6);
        }
}

/// All vertices are free except \p count landmarks, spread over the mesh, which \p motion moves.
static Handles PointsOf(const Shape &shape, int count, const Affine3d &motion) {
    Handles handles;
    handles.tag.assign(shape.position.size(), 1);
    for (int i = 0; i < count; ++i) {
        const std::size_t vertex = shape.position.size() * i / count;
        handles.point.push_back({vertex, motion * shape.position[vertex]});
    }
    return handles;
}

TEST(DeformCentroidal, PointHandlesArriveAndTurnFreely) {
    const Shape shape = Jittered(Tube(60, 24), 0.01);
    const Matrix3Xd rest = PositionsOf(MeshD(shape));
    DeformationParam param = Param();
    param.tolerance = 1e-9;
    for (unsigned seed = 1; seed <= 3; ++seed)
        for (int count : {7, 41, 719}) {
            const Affine3d rigid = RandomRigid(seed);
            const DeformationResult r = DeformCentroidal(MeshD(shape), PointsOf(shape, count, rigid), param);
            EXPECT_EQ(r.tags.handle, count);
            EXPECT_EQ(r.tags.free, 1440 - count);
            // Landmarks only shift, but the surface turns as a whole.
            EXPECT_LE((r.position - rigid * rest).cwiseAbs().maxCoeff(), 1e-6) << count << " points";
        }
}

TEST(DeformCentroidal, PointHandlesAreExactInAnyPose) {
    Case c = TubeCase();
    c.handles.point = {{300, Vector3d(1, 2, 3)}, {303, Vector3d(1, 2, 4)}};
    ASSERT_EQ(c.handles.tag[300], 1);
    for (double pose : {0.0, 50.0, 100.0, 150.0}) {
        DeformationParam param = Param();
        param.pose = pose;
        const Matrix3Xd x = Deformed(c, param);
        EXPECT_TRUE(x.allFinite());
        for (const PointHandle &point : c.handles.point) {
            const Vector3d p = c.shape.position[point.vertex];
            EXPECT_LE((x.col(point.vertex) - p - pose / 100 * (point.target - p)).norm(), 1e-12);
        }
    }
}

TEST(DeformCentroidal, ASingleVertexThatIsOnlyMovedIsAPointHandle) {
    const Shape shape = Jittered(Grid(40, 40, 0.25), 0.02);
    Handles tagged, points;
    tagged.tag.assign(1600, 1);
    for (int i = 0; i < 20; ++i) {
        const std::size_t vertex = 7 + 79 * i;
        const Vector3d shift(0, 0, i % 3 * 0.5);
        tagged.tag[vertex] = 2 + i;
        tagged.motion[2 + i] = Motion(Affine3d(Eigen::Translation3d(shift)).matrix());
        points.point.push_back({vertex, shape.position[vertex] + shift});
    }
    points.tag.assign(1600, 1);
    const Matrix3Xd a = Deformed({shape, tagged}), b = Deformed({shape, points});
    ExpectHeldExact(MeshD(shape), tagged, a);
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(DeformCentroidal, TheSurfaceFollowsASmallHandle) {
    // A single vertex in the middle of a sheet is lifted. Half a patch away, the surface still moves most of that.
    const Shape shape = Grid(81, 81, 0.1);
    Handles handles;
    handles.tag.assign(81 * 81, 1);
    for (int i = 0; i < 81; ++i)
        for (int at : {i, 81 * 80 + i, 81 * i, 81 * i + 80})
            handles.tag[at] = 0;
    const int middle = 81 * 40 + 40;
    handles.tag[middle] = 2;
    handles.motion[2] = Motion(Affine3d(Eigen::Translation3d(0, 0, 1)).matrix());
    DeformationParam param = Param(100);
    const DeformationResult r = DeformCentroidal(MeshD(shape), handles, param);
    ExpectHeldExact(MeshD(shape), handles, r.position);
    EXPECT_GT(r.position(2, middle + 3), 0.7);
    EXPECT_GT(r.position(2, middle + 8), 0.3);
    for (int i = 1; i < 40; ++i)
        EXPECT_LE(r.position(2, middle + i), r.position(2, middle + i - 1) + 1e-3) << "not a single hill";
}

TEST(DeformCentroidal, ManySmallHandlesLeaveTheOthersExact) {
    const Shape shape = Jittered(Sphere(60, 80), 0.005);
    std::mt19937 random(3);
    Handles handles;
    handles.tag.assign(shape.position.size(), 1);
    for (int t = 2; t < 500; ++t) {
        handles.tag[random() % handles.tag.size()] = t;
        handles.motion[t] = Motion(Affine3d(Eigen::Translation3d(0.1 * RandomVector(random))).matrix());
    }
    for (int i = 0; i < 300; ++i)
        handles.tag[random() % handles.tag.size()] = 0;
    const MeshD mesh(shape);
    const DeformationResult r = DeformCentroidal(mesh, handles, Param());
    ExpectHeldExact(mesh, handles, r.position);
}

TEST(DeformCentroidal, RefusesPointHandlesThatCannotBe) {
    const Case c = TubeCase();
    auto error = [&](std::vector<PointHandle> points) {
        Case with = c;
        with.handles.point = std::move(points);
        return MessageOf<Error>([&] { Deformed(with); });
    };
    const Vector3d p(1, 2, 3);
    const std::size_t fixed = std::find(c.handles.tag.begin(), c.handles.tag.end(), 0) - c.handles.tag.begin();
    EXPECT_NE(error({{300, p}, {99999, p}}).find("Point handle 2 is at vertex 99999, which does not exist"),
              std::string::npos);
    EXPECT_NE(error({{300, p}, {301, p}, {300, p}}).find("Point handle 3 is at the same place as point handle 1"),
              std::string::npos);
    EXPECT_NE(error({{fixed, p}}).find("is held already"), std::string::npos);
    EXPECT_NE(error({{300, p * std::numeric_limits<double>::infinity()}}).find("not finite"), std::string::npos);
}

TEST(DeformCentroidal, LoosePartsFollowAPointHandleThatNoSurfaceIsAt) {
    Case c{Join(Triangle(), Shape{{{9, 9, 9}, {9, 9, 8}}, {}, {}}), {{1, 1, 1, 1, 1}, {}, {}}};
    c.handles.point = {{0, c.shape.position[0]}, {3, {9, 9, 12}}};
    const Matrix3Xd points = Deformed(c);
    EXPECT_EQ(points.col(0), c.shape.position[0]);
    EXPECT_EQ(points.col(3), Vector3d(9, 9, 12));
    EXPECT_LE((points.col(4) - Vector3d(9, 9, 11)).norm(), 1e-12);
    c.handles.point = {{0, c.shape.position[0]}, {3, {9, 9, 12}}, {3, {9, 9, 9}}};
    EXPECT_NE(MessageOf<Error>([&] { Deformed(c); }).find("Point handle 3 is at the same place as point handle 2"),
              std::string::npos);
}

TEST(DeformCentroidal, NoMotionIsTheRestPoseToTheBit) {
    for (Case c : {TubeCase(), GridCase(), SphereCase()}) {
        const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
        DeformationParam param = Param();
        param.pose = 0;
        EXPECT_TRUE(SameBits(Deformed(c, param), rest));
        c.handles.motion.clear(); // a handle without a motion stays where it is
        EXPECT_TRUE(SameBits(Deformed(c), rest));
    }
}

/// Shapes of all kinds with random tags.
static std::vector<Case> RandomlyTagged(const Affine3d &motion) {
    std::vector<Case> cases;
    const std::vector<Shape> shapes{Jittered(Tube(30, 14), 0.02),
                                    Jittered(Sphere(16, 20), 0.02),
                                    Jittered(Grid(25, 20), 0.2),
                                    Unwelded(Jittered(Tube(20, 10), 0.02)),
                                    PointCloud(300),
                                    Wireframe(12, 9)};
    for (std::size_t i = 0; i < shapes.size(); ++i)
        for (unsigned often : {2, 30}) { // one in so many is held
            std::mt19937 random(unsigned(i) + 1);
            Case c{shapes[i], Handles()};
            for (std::size_t v = 0; v < c.shape.position.size(); ++v)
                c.handles.tag.push_back(random() % often ? 1 : 2 + int(random() % 3));
            for (int tag : {2, 3, 4})
                c.handles.motion[tag] = Motion(motion.matrix());
            cases.push_back(c);
        }
    return cases;
}

TEST(DeformCentroidal, NoMotionMovesNothingToTheBitWhereverTheTagsAre) {
    for (Case c : RandomlyTagged(Affine3d::Identity()))
        for (double smoothness : {0.0, 0.0058, 1.0}) {
            const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
            DeformationParam param = Param();
            param.smoothness = smoothness;
            EXPECT_TRUE(SameBits(Deformed(c, param), rest));
            std::replace(c.handles.tag.begin(), c.handles.tag.end(), 3, 0);
            std::replace(c.handles.tag.begin(), c.handles.tag.end(), 4, -1);
            EXPECT_TRUE(SameBits(Deformed(c, param), rest));
        }
}

TEST(DeformCentroidal, OneRigidMotionMovesEverythingWhereverTheTagsAre) {
    const Affine3d rigid = RandomRigid(7);
    for (const Case &c : RandomlyTagged(rigid))
        for (double smoothness : {0.0, 0.0058, 1.0}) {
            const MeshD mesh(c.shape);
            DeformationParam param = Param();
            param.smoothness = smoothness;
            const Matrix3Xd rest = PositionsOf(mesh), x = Deformed(c, param);
            const double diagonal = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
            EXPECT_LE((x - rigid * rest).cwiseAbs().maxCoeff(), 1e-6 * diagonal)
                << c.shape.Size() << " vertices, alpha " << smoothness;
            ExpectHeldExact(mesh, c.handles, x);
        }
}

/// The tags for the shape of \p c twice: \p before for the first copy, those of \p c for the second.
static Case With(const Case &c, const Shape &before, int tagBefore, const Shape &after, int tagAfter) {
    Case with{Join(before, Join(c.shape, after)), c.handles};
    with.handles.tag.assign(before.position.size(), tagBefore);
    with.handles.tag.insert(with.handles.tag.end(), c.handles.tag.begin(), c.handles.tag.end());
    with.handles.tag.resize(with.shape.position.size(), tagAfter);
    for (PointHandle &point : with.handles.point)
        point.vertex += before.position.size();
    return with;
}

/// Expects that \p c, which is in \p with from vertex \p first on, gets the same result there as alone.
static void ExpectNoBitChanged(const Case &c, const Case &with, int first, const DeformationParam &param = Param()) {
    const DeformationResult alone = DeformCentroidal(MeshD(c.shape), c.handles, param),
                            both = DeformCentroidal(MeshD(with.shape), with.handles, param);
    EXPECT_TRUE(SameBits(Matrix3Xd(both.position.middleCols(first, c.shape.Size())), alone.position));
    EXPECT_EQ(both.iterations, alone.iterations);
    EXPECT_EQ(both.energy, alone.energy);
    EXPECT_TRUE(SameBits(both.rest.position, alone.rest.position));
}

TEST(DeformCentroidal, WhatIsHeldFarFromTheBendChangesNoBit) {
    std::vector<Case> cases{TubeCase(), GridCase(), SphereCase()};
    cases.push_back(CaseOf(Unwelded(Tube(20, 12)), [](const Vector3d &p) { return TubeTag(p); }));
    cases[0].handles.point = {{300, Vector3d(1, 2, 3)}};
    for (const Case &c : cases)
        for (double far : Rounds({20.0, 1e5, 1e9})) {
            const Shape other = Moved(c.shape, Affine3d(Eigen::Translation3d(far, -far, 0.5 * far)));
            for (int tag : Rounds({0, -1, 2})) {
                ExpectNoBitChanged(c, With(c, other, tag, Shape(), 0), c.shape.Size());
                ExpectNoBitChanged(c, With(c, Shape(), 0, other, tag), 0);
                ExpectNoBitChanged(c, With(c, other, tag, other, 0), c.shape.Size());
            }
            const MeshD mesh(With(c, other, 0, other, -1).shape);
            ExpectHeldExact(mesh, With(c, other, 0, other, -1).handles, Deformed(With(c, other, 0, other, -1)));
        }
}

TEST(DeformCentroidal, WhatIsHeldBesideTheBendButNotAtItChangesNoBit) {
    const Case c = TubeCase();
    // A sleeve, a hair's breadth away.
    const Shape sleeve = Moved(c.shape, Affine3d(Eigen::Scaling(1.01, 1.01, 1.001)));
    for (int tag : {0, -1})
        ExpectNoBitChanged(c, With(c, sleeve, tag, sleeve, 0), c.shape.Size());
}

TEST(DeformCentroidal, AStrayVertexChangesNothing) {
    for (const Case &c : {TubeCase(), GridCase(), SphereCase()})
        for (double far : Rounds({1e3, 1e6, 1e9}))
            for (int tag : Rounds({1, 0, -1})) {
                const Shape stray{{{6 * far, 0, -far}}, {}, {}};
                for (LooseParts loose : {LooseParts::Follow, LooseParts::Stay}) {
                    DeformationParam param = Param();
                    param.looseParts = loose;
                    ExpectNoBitChanged(c, With(c, stray, tag, Shape(), 0), 1, param);
                    ExpectNoBitChanged(c, With(c, Shape(), 0, stray, tag), 0, param);
                }
            }
}

TEST(DeformCentroidal, IsolatedFreeVerticesChangeNothing) {
    for (const Case &c : {TubeCase(), GridCase()}) {
        Shape around;
        std::mt19937 random(2);
        for (int i = 0; i < 500; ++i)
            around.position.push_back(Vector3d(3, 0, 3) + 4 * RandomVector(random));
        ExpectNoBitChanged(c, With(c, around, 1, around, 1), 500);
        ExpectNoBitChanged(c, With(c, Points(c.shape), 1, Shape(), 1), c.shape.Size());
    }
}

TEST(DeformCentroidal, LooseSurfaceChangesNothing) {
    const Case c = TubeCase();
    const Shape buttons =
        Join(Moved(Sphere(8, 12), Affine3d(Eigen::Translation3d(3, 0, 4))),
             Moved(Sphere(20, 30), Affine3d(Eigen::Translation3d(1e4, 0, 4) * Eigen::Scaling(100.0))));
    ExpectNoBitChanged(c, With(c, buttons, 1, buttons, 1), buttons.Size());
}

TEST(DeformCentroidal, PullingOneOfTwoStripsThatAFixedPartJoinsLeavesTheOther) {
    Case c = CaseOf(Jittered(Grid(101, 11, 0.1), 0.02), [](const Vector3d &p) {
        return p[0] < 0.5 ? 2 : p[0] > 9.5 ? 3 : std::abs(p[0] - 5) < 0.3 ? 0 : 1;
    });
    const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
    for (double smoothness : {0.0, 0.0058}) {
        DeformationParam param = Param();
        param.smoothness = smoothness;
        c.handles.motion[3] = Motion();
        const Matrix3Xd one = Deformed(c, param);
        c.handles.motion[3] = Motion(Affine3d(Eigen::Translation3d(0, 1, 2)).matrix());
        const Matrix3Xd both = Deformed(c, param);
        int left = 0, right = 0;
        for (int i = 0; i < c.shape.Size(); ++i) {
            if (rest(0, i) > 5) {
                EXPECT_TRUE(SameBits(Vector3d(one.col(i)), Vector3d(rest.col(i)))) << i;
                right += (both.col(i) - rest.col(i)).norm() > 0.01;
            } else {
                EXPECT_TRUE(SameBits(Vector3d(one.col(i)), Vector3d(both.col(i)))) << i;
                left += (one.col(i) - rest.col(i)).norm() > 0.01;
            }
        }
        EXPECT_GT(left, 200);
        EXPECT_GT(right, 200);
    }
}

TEST(DeformCentroidal, HoldsASoupWithATagPerFaceAsItsWeldedMesh) {
    // A welded vertex is held if one of its corners is; also in a soup, whose faces share no vertex.
    const Shape tube = Jittered(Tube(40, 16), 0.02), soup = Unwelded(tube);
    Case faces{soup, {}}, welded{tube, {}};
    welded.handles.tag.assign(tube.position.size(), 1);
    for (const auto &f : tube.face) {
        const double z = (tube.position[f[0]] + tube.position[f[1]] + tube.position[f[2]])[2] / 3;
        const int tag = TubeTag(Vector3d(0, 0, z));
        for (int c : f) {
            faces.handles.tag.push_back(tag);
            if (tag != 1)
                welded.handles.tag[c] = tag;
        }
    }
    faces.handles.motion[2] = welded.handles.motion[2] = Motion(bend.matrix());
    const Matrix3Xd x = Deformed(faces), y = Deformed(welded);
    for (std::size_t f = 0; f < tube.face.size(); ++f)
        for (int c = 0; c < 3; ++c)
            EXPECT_LE((x.col(3 * f + c) - y.col(tube.face[f][c])).norm(), 0.15) << "face " << f;
    std::map<std::array<double, 3>, int> first;
    for (int i = 0; i < soup.Size(); ++i) {
        const Vector3d &p = soup.position[i];
        const int twin = first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, i).first->second;
        EXPECT_TRUE(SameBits(Vector3d(x.col(i)), Vector3d(x.col(twin)))) << i;
    }
}

TEST(DeformCentroidal, WithANodeAtEveryVertexTheSeedDoesNotMatter) {
    for (const Case &c : {TubeCase(), GridCase()}) {
        DeformationParam param = Param(10 * c.shape.Size());
        const Matrix3Xd first = Deformed(c, param);
        for (unsigned seed : {2, 99}) {
            param.graph.randomSeed = seed;
            EXPECT_LE((Deformed(c, param) - first).cwiseAbs().maxCoeff(), 0);
        }
    }
}

TEST(DeformCentroidal, PatchesOfFewVerticesAreNearToANodeAtEveryVertex) {
    double flow = 0, tensors = 0;
    for (const auto &[rings, segments] :
         {std::make_pair(30, 60), std::make_pair(90, 30)}) { // triangles along and across
        const Case c = CaseOf(Tube(rings, segments), [](const Vector3d &p) { return TubeTag(p); });
        const Matrix3Xd limit = Deformed(c, Param(10 * c.shape.Size()));
        DeformationParam param = Param(c.shape.Size() / 4);
        for (unsigned seed : Rounds({1, 2, 3})) {
            param.graph.randomSeed = seed;
            param.shape.mostTensorChange = ShapeConstants().mostTensorChange;
            tensors += (Deformed(c, param) - limit).norm() / limit.norm();
            param.shape.mostTensorChange = 1;
            flow += (Deformed(c, param) - limit).norm() / limit.norm();
        }
    }
    EXPECT_LT(tensors, 0.7 * flow) << flow;
}

TEST(DeformCentroidal, TheNumberOfNodesFollowsTheFreeArea) {
    // Less and less of a sheet is free: D falls with its square root, and the number of free nodes stays.
    std::vector<double> free, radius;
    for (double limit : {60.5, 30.5, 15.5}) {
        const Case c = CaseOf(Grid(121, 61), [&](const Vector3d &p) { return p[0] < 2 ? 0 : p[0] < limit ? 1 : 2; });
        DeformationParam param = Param(60);
        const DeformationResult r = DeformCentroidal(MeshD(c.shape), c.handles, param);
        int count = 0;
        double widest = 0;
        for (Index j = 0; j < r.rest.position.cols(); ++j)
            if (r.rest.position(0, j) > 2 && r.rest.position(0, j) < limit - 0.5) {
                ++count;
                widest = std::max(widest, r.rest.radius[j]);
            }
        free.push_back(count);
        radius.push_back(widest);
        const double D = 0.75 * std::sqrt(60 * (limit - 2) / 60);
        EXPECT_LE(widest, 1.1 * D) << limit;
        EXPECT_GE(widest, 0.6 * D) << limit;
    }
    for (double count : free)
        EXPECT_NEAR(count, free[0], 0.35 * free[0]);
}

TEST(DeformCentroidal, RefiningAPartOfTheSurfaceHardlyChangesTheShape) {
    // The same surface, with the left half sampled four times as densely.
    const auto tag = [](const Vector3d &p) { return p[0] < 0.5 ? 0 : p[0] > 7.5 ? 2 : 1; };
    const Affine3d lifted(Eigen::Translation3d(0, 0, 2));
    const Case c = CaseOf(Grid(81, 41, 0.1), tag, lifted);
    Case dense = c;
    for (std::size_t f = 0, faces = dense.shape.face.size(); f < faces; ++f) {
        const auto corners = dense.shape.face[f];
        Vector3d middle = Vector3d::Zero();
        for (int corner : corners)
            middle += dense.shape.position[corner] / 3;
        if (middle[0] > 4)
            continue;
        const int n = dense.shape.Size();
        dense.shape.position.push_back(middle);
        dense.handles.tag.push_back(tag(middle));
        dense.shape.face[f] = {corners[0], corners[1], n};
        dense.shape.face.push_back({corners[1], corners[2], n});
        dense.shape.face.push_back({corners[2], corners[0], n});
    }
    const Matrix3Xd x = Deformed(c, Param(100)), y = Deformed(dense, Param(100)).leftCols(c.shape.Size());
    EXPECT_LE(std::sqrt((x - y).squaredNorm() / double(x.cols())), 0.012 * 8.9);
}

/// Root mean square distance in percent of the diagonal of \p x.
static double PercentApart(const Matrix3Xd &x, const Matrix3Xd &y) {
    return 100 * std::sqrt((x - y).squaredNorm() / double(x.cols())) /
           (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

TEST(DeformCentroidal, ScanLinesTwentyTimesDenserHaveTheShapeOfTheMesh) {
    const int n = sanitized ? 21 : 41, dense = 20;
    const double width = n - 1;
    const auto height = [&](double x, double y) {
        return 0.03 * width * std::sin(6 / width * x) * std::cos(8 / width * y);
    };
    const auto tag = [&](const Vector3d &p) { return p[0] < 0.15 * width ? 0 : p[0] > 0.85 * width ? 2 : 1; };
    const Affine3d turned = Eigen::Translation3d(width * Vector3d(0.75, 0.5, 0.2)) *
                            Eigen::AngleAxisd(-1, Vector3d::UnitY()) *
                            Eigen::Translation3d(-width * Vector3d(0.9, 0.5, 0));
    Shape grid = Grid(n, n);
    for (Vector3d &p : grid.position)
        p[2] = height(p[0], p[1]);
    const Matrix3Xd expected = Deformed(CaseOf(grid, tag, turned), Param(300));
    for (int along : Rounds({0, 1})) {
        Shape lines;
        std::vector<int> same; // the points at the grid's vertices
        for (int across = 0; across < n; ++across)
            for (int i = 0; i <= dense * (n - 1); ++i) {
                Vector3d p;
                p[along] = double(i) / dense;
                p[1 - along] = across;
                p[2] = height(p[0], p[1]);
                lines.position.push_back(p);
            }
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                same.push_back(along == 0 ? y * (dense * (n - 1) + 1) + dense * x
                                          : x * (dense * (n - 1) + 1) + dense * y);
        const Matrix3Xd deformed = Deformed(CaseOf(lines, tag, turned), Param(300));
        Matrix3Xd there(3, Eigen::Index(same.size()));
        for (std::size_t i = 0; i < same.size(); ++i)
            there.col(Eigen::Index(i)) = deformed.col(same[i]);
        EXPECT_LE(PercentApart(expected, there), 0.5) << "along " << along;
    }
}

TEST(DeformCentroidal, WhatIsThereSeveralTimesCountsOnce) {
    const Shape tube = Jittered(Tube(40, 16), 0.02);
    const auto deformed = [](const Shape &shape) {
        return Deformed(CaseOf(shape, [](const Vector3d &p) { return TubeTag(p); }), Param(100));
    };
    const Matrix3Xd mesh = deformed(tube), cloud = deformed(Points(tube));
    for (int times : {2, 4}) {
        Shape many = tube;
        for (int k = 1; k < times; ++k)
            many.face.insert(many.face.end(), tube.face.begin(), tube.face.end());
        EXPECT_LE(PercentApart(mesh, deformed(many)), 0.2) << "faces " << times << " times";
    }
    for (int times : Rounds({8, 30}))
        for (double hair : {0.0, 1e-7}) { // tags are of the positions before the jitter
            std::mt19937 random(1);
            Case c{{}, {}};
            c.handles.motion[2] = Motion(bend.matrix());
            for (int i = 0; i < times * tube.Size(); ++i) {
                const Vector3d &p = tube.position[i / times];
                c.handles.tag.push_back(TubeTag(p));
                c.shape.position.push_back(p + (i % times ? hair : 0) * RandomVector(random));
            }
            const Matrix3Xd all = Deformed(c, Param(100));
            Matrix3Xd there(3, tube.Size());
            for (int i = 0; i < tube.Size(); ++i)
                there.col(i) = all.col(i * times);
            EXPECT_LE(PercentApart(cloud, there), hair > 0 ? 0.5 : 0.2) << times << " times, moved by " << hair;
        }
}

TEST(DeformCentroidal, AnUnweldedMeshWithLoosePartsHasTheShapeOfTheWeldedOne) {
    // A sleeve around a body of large triangles: a place on it has several vertices.
    Shape sleeve = Tube(61, 40, 4);
    for (Vector3d &p : sleeve.position)
        p = Vector3d(1.4 * p[0], 1.4 * p[1], p[2] + 1);
    const Shape body = Tube(10, 12), all = Join(body, sleeve);
    Case welded{all, {}};
    for (int i = 0; i < all.Size(); ++i)
        welded.handles.tag.push_back(i < body.Size() ? TubeTag(all.position[i]) : 1);
    welded.handles.motion[2] = Motion(bend.matrix());
    Case unwelded{Unwelded(all), {}};
    unwelded.handles.motion = welded.handles.motion;
    Matrix3Xd expected(3, 3 * Eigen::Index(all.face.size()));
    const Matrix3Xd x = Deformed(welded);
    for (std::size_t f = 0; f < all.face.size(); ++f)
        for (int c = 0; c < 3; ++c) {
            unwelded.handles.tag.push_back(welded.handles.tag[all.face[f][c]]);
            expected.col(Eigen::Index(3 * f) + c) = x.col(all.face[f][c]);
        }
    EXPECT_LE(PercentApart(expected, Deformed(unwelded)), 0.5);
}

TEST(DeformCentroidal, PoseIsAPercentageOfTheMotion) {
    const Case c = TubeCase();
    DeformationParam param = Param();
    for (double pose : {50.0, 150.0}) {
        param.pose = pose;
        Case part = c;
        Vector3d center = Vector3d::Zero();
        int count = 0;
        for (int i = 0; i < c.shape.Size(); ++i)
            if (c.handles.tag[i] == 2) {
                center += c.shape.position[i];
                ++count;
            }
        part.handles.motion[2] = Motion(c.handles.motion.at(2).At(pose, center / count));
        EXPECT_LE((Deformed(c, param) - Deformed(part)).cwiseAbs().maxCoeff(), 1e-5);
    }
}

TEST(DeformCentroidal, SingleVerticesThatTurnFarAreHeldInRotationOnTheWay) {
    const Shape shape = Grid(31, 31, 0.1);
    const Vector3d pivot(1.5, 1.5, 0);
    const auto turned = [&](double degrees) {
        const double angle = degrees * EIGEN_PI / 180;
        const Affine3d m = Eigen::Translation3d(pivot) *
                           Eigen::AngleAxisd(std::remainder(angle, 2 * EIGEN_PI), Vector3d::UnitX()) *
                           Eigen::Translation3d(-pivot);
        return Motion(m.matrix(), angle * Vector3d::UnitX(), pivot);
    };
    Case c = CaseOf(shape, [](const Vector3d &p) { return p[1] < 0.25 ? 0 : 1; });
    for (int at : {15 * 31 + 15, 20 * 31 + 10, 25 * 31 + 20})
        c.handles.tag[at] = 2;
    DeformationParam half = Param(), quarter = Param();
    half.pose = 50;
    quarter.pose = 25;
    const auto at = [&](double degrees, const DeformationParam &param) {
        c.handles.motion[2] = turned(degrees);
        return Deformed(c, param);
    };
    EXPECT_LE((at(340, half) - at(680, quarter)).norm(), 1e-9);
    EXPECT_LE((at(340, half) - at(170, Param())).norm(), 1e-6) << "no vertex knows of what comes later";
}

TEST(DeformCentroidal, ScalingTheSceneScalesTheAnswer) {
    for (double scale : {std::ldexp(1.0, -30), std::ldexp(1.0, 20)}) {
        Case c = TubeCase();
        const Matrix3Xd once = Deformed(c);
        Eigen::Matrix4d motion = bend.matrix();
        motion.topRightCorner<3, 1>() *= scale;
        c.handles.motion[2] = Motion(motion);
        c.shape = Moved(c.shape, Affine3d(Eigen::Scaling(scale)));
        EXPECT_LE((Deformed(c) / scale - once).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST(DeformCentroidal, MovingTheSceneMovesTheAnswer) {
    for (double far : {100.0, 1e6}) {
        Case c = CaseOf(Grid(33, 33, 0.25), [](const Vector3d &p) { return p[0] < 1 ? 0 : p[0] > 7 ? 2 : 1; });
        const Matrix3Xd once = Deformed(c);
        const Affine3d there(Eigen::Translation3d(far, -far, far / 2));
        c.shape = Moved(c.shape, there);
        c.handles.motion[2] = Motion((there * bend * there.inverse()).matrix());
        EXPECT_LE((there.inverse() * Deformed(c) - once).cwiseAbs().maxCoeff(), 1e-13 * far + 1e-6) << far;
    }
}

TEST(DeformCentroidal, DoesNotDependOnTheThreads) {
    for (const Case &c :
         {TubeCase(),
          CaseOf(Jittered(Grid(150, 150), 0.2), [](const Vector3d &p) { return p[0] < 9     ? 0
                                                                               : p[0] > 140 ? 2
                                                                                            : 1; }),
          CaseOf(PointCloud(3000), [](const Vector3d &p) { return p[0] < 0.2   ? 0
                                                                  : p[0] > 0.8 ? 2
                                                                               : 1; })}) {
        const MeshD mesh(c.shape);
        const DeformationResult one = DeformCentroidal(mesh, c.handles, Param(), Threads(1));
        for (unsigned threads : Rounds({7u, 2u})) {
            const DeformationResult same = DeformCentroidal(mesh, c.handles, Param(), Threads(threads));
            EXPECT_TRUE(SameBits(same.position, one.position));
            EXPECT_TRUE(SameBits(same.deformed.position, one.deformed.position));
            EXPECT_EQ(same.energy, one.energy);
            EXPECT_EQ(same.rest.edge, one.rest.edge);
        }
    }
}

TEST(DeformCentroidal, ReadsTheMeshOnly) {
    const Case c = TubeCase();
    const MeshD mesh(c.shape);
    const std::vector<VertexD> vert = mesh.vert;
    const std::vector<FaceD> face = mesh.face;
    auto expectUntouched = [&] {
        EXPECT_EQ(std::memcmp(vert.data(), mesh.vert.data(), vert.size() * sizeof vert[0]), 0);
        EXPECT_EQ(std::memcmp(face.data(), mesh.face.data(), face.size() * sizeof face[0]), 0);
        EXPECT_TRUE(mesh.vert_attr.empty() && mesh.face_attr.empty() && mesh.mesh_attr.empty());
    };
    DeformCentroidal(mesh, c.handles, Param());
    expectUntouched();
    BuildCentroidalGraph(mesh, Param().graph);
    expectUntouched();
    CallbackLog log(5);
    EXPECT_THROW(DeformCentroidal(mesh, c.handles, Param(), log.Progress()), Cancelled);
    expectUntouched();
}

TEST(DeformCentroidal, SeamsStayTogether) {
    const Case c = CaseOf(Unwelded(Jittered(Tube(30, 14), 0.02)), [](const Vector3d &p) { return TubeTag(p); });
    const MeshD mesh(c.shape);
    const DeformationResult r = DeformCentroidal(mesh, c.handles, Param());
    ExpectHeldExact(mesh, c.handles, r.position);
    std::map<std::array<double, 3>, int> first;
    for (int i = 0; i < c.shape.Size(); ++i) {
        const Vector3d &p = c.shape.position[i];
        const int twin = first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, i).first->second;
        EXPECT_TRUE(SameBits(Vector3d(r.position.col(i)), Vector3d(r.position.col(twin)))) << i;
    }
    EXPECT_EQ(int(first.size()), 30 * 14);
}

TEST(DeformCentroidal, SeamsWithDifferentTagsStayTogether) {
    // Fixed wins over a handle, both win over free, and both sides move to the same place.
    for (const auto &pair : {std::make_pair(2, 1), std::make_pair(0, 1), std::make_pair(-1, 1), std::make_pair(0, 2),
                             std::make_pair(3, 2), std::make_pair(-1, 0)}) {
        Case c = TubeCase();
        const int n = c.shape.Size();
        c.shape = Join(c.shape, c.shape);
        c.handles.tag.insert(c.handles.tag.end(), c.handles.tag.begin(), c.handles.tag.end());
        for (int i = 320; i < 330; ++i) {
            c.handles.tag[i] = pair.first;
            c.handles.tag[n + i] = pair.second;
        }
        const Matrix3Xd x = Deformed(c);
        EXPECT_TRUE(SameBits(Matrix3Xd(x.leftCols(n)), Matrix3Xd(x.rightCols(n)))) << pair.first << ", " << pair.second;
    }
}

TEST(DeformCentroidal, AHandleThatIsFixedWhereTheSurfaceBendsDoesNotMove) {
    for (int at : {0, 100}) { // far from what is free, and beside it
        Case c = TubeCase();
        const int n = c.shape.Size();
        ASSERT_EQ(c.handles.tag[at], 0);
        c.shape.position.push_back(c.shape.position[at]);
        c.handles.tag.push_back(5);
        c.handles.motion[5] = Motion(bend.matrix());
        const Matrix3Xd x = Deformed(c);
        if (at) {
            EXPECT_TRUE(SameBits(Vector3d(x.col(n)), c.shape.position[n]));
        } else {
            EXPECT_LE((x.col(n) - bend * c.shape.position[n]).norm(), 1e-12) << "nothing is there to keep it";
        }
        EXPECT_TRUE(SameBits(Vector3d(x.col(at)), c.shape.position[at]));
    }
}

TEST(DeformCentroidal, CanBeCancelledAnywhere) {
    for (bool given : {false, true}) {
        const Case c = TubeCase();
        const MeshD mesh(c.shape);
        DeformationParam param = Param(20);
        if (given)
            param.nodes = PositionsOf(mesh).leftCols(30);
        CallbackLog all;
        DeformCentroidal(mesh, c.handles, param, all.Progress(1));
        EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
        EXPECT_EQ(all.percent.front(), 0);
        EXPECT_EQ(all.percent.back(), 100);
        const std::size_t calls = all.percent.size();
        for (std::size_t i = 0; i < calls; ++i) {
            CallbackLog log(i);
            EXPECT_THROW(DeformCentroidal(mesh, c.handles, param, log.Progress(1)), Cancelled) << i;
            EXPECT_EQ(log.percent.size(), i + 1) << "called again after the cancel";
        }
    }
}

template <class Change>
static std::string ParamError(const Change &change) {
    DeformationParam param = Param();
    change(param);
    const Case c = TubeCase();
    return MessageOf<Error>([&] { DeformCentroidal(MeshD(c.shape), c.handles, param); });
}

TEST(DeformCentroidal, RefusesParametersOutOfRange) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    auto contains = [](const std::string &message, const char *word) {
        EXPECT_NE(message.find(word), std::string::npos) << message;
    };
    for (double bad : {-1.0, nan, inf}) {
        contains(ParamError([&](DeformationParam &p) { p.graph.targetRadius = bad; }), "radius");
        contains(ParamError([&](DeformationParam &p) { p.graph.tolerance = bad; }), "tolerance");
        contains(ParamError([&](DeformationParam &p) { p.smoothness = bad; }), "smoothness");
        contains(ParamError([&](DeformationParam &p) { p.tolerance = bad; }), "tolerance");
        contains(ParamError([&](DeformationParam &p) { p.influence = bad; }), "influence");
    }
    for (double bad : {nan, inf, -inf}) {
        contains(ParamError([&](DeformationParam &p) { p.pose = bad; }), "pose");
        contains(ParamError([&](DeformationParam &p) { p.nodes = Matrix3Xd::Constant(3, 2, bad); }), "finite");
    }
    contains(ParamError([&](DeformationParam &p) { p.graph.initialPatches = -1; }), "patches");
    for (int bad : {0, -1}) {
        contains(ParamError([&](DeformationParam &p) { p.graph.maxIterations = bad; }), "iterations");
        contains(ParamError([&](DeformationParam &p) { p.maxIterations = bad; }), "iterations");
    }
    contains(ParamError([](DeformationParam &p) { p.influence = 1; }), "influence");
    contains(ParamError([](DeformationParam &p) { p.tolerance = 0; }), "tolerance");
    contains(ParamError([](DeformationParam &p) { p.graph.tolerance = 1; }), "tolerance");
    EXPECT_NO_THROW(DeformationParam().Validate());
}

static std::string CaseError(const Case &c) {
    return MessageOf<Error>([&] { DeformCentroidal(MeshD(c.shape), c.handles, Param()); });
}

TEST(DeformCentroidal, RefusesWhatCannotBeDeformed) {
    const Case good = TubeCase();
    auto tagged = [&](auto change) {
        Case c = good;
        for (int &tag : c.handles.tag)
            tag = change(tag);
        return CaseError(c);
    };
    EXPECT_NE(tagged([](int t) { return std::min(t, 1); }).find("no handle"), std::string::npos);
    EXPECT_NE(tagged([](int t) { return t == 1 ? 0 : t; }).find("free"), std::string::npos);
    EXPECT_NE(tagged([](int t) { return t == 1 ? -1 : t; }).find("free"), std::string::npos);
    for (int more : {-1, 1}) {
        Case c = good;
        c.handles.tag.resize(c.handles.tag.size() + more);
        EXPECT_NE(CaseError(c).find("one tag per vertex"), std::string::npos);
    }
    Case c = good;
    c.shape.position[7][1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(CaseError(c).find("Vertex 7"), std::string::npos);
    for (int i : {7, 300, 639}) { // fixed, free, handle; near what bends or not
        c = good;
        c.shape.position[i][2] = std::numeric_limits<double>::infinity();
        for (const Shape &shape : {c.shape, Points(c.shape)})
            EXPECT_NE(CaseError({shape, c.handles}).find("Vertex " + std::to_string(i) + " "), std::string::npos);
    }
    EXPECT_THROW(DeformCentroidal(MeshD(), {}, {}), Error);
}

/// Live vertices that are free or share a face with a free one.
static Index VerticesThatBend(const MeshD &mesh, const Handles &handles) {
    std::set<Index> found;
    for (const auto &f : mesh.face) {
        Index c[3] = {-1, -1, -1};
        for (int i = 0; i < 3 && !f.IsD(); ++i)
            c[i] = Index(f.cV(i) - &mesh.vert[0]);
        if (!f.IsD() && (handles.tag[c[0]] == 1 || handles.tag[c[1]] == 1 || handles.tag[c[2]] == 1))
            found.insert(c, c + 3);
    }
    return Index(found.size());
}

static void DeleteVertexAndFaces(MeshD &mesh, int vertex) {
    for (int f = 0; f < int(mesh.face.size()); ++f)
        for (int c = 0; c < 3; ++c)
            if (!mesh.face[f].IsD() && mesh.face[f].V(c) == &mesh.vert[vertex])
                mesh.DeleteFace(f);
    mesh.DeleteVertex(vertex);
}

static std::vector<std::pair<int, std::string>> stages;
static bool RecordStage(const int percent, const char *stage) {
    stages.emplace_back(percent, stage);
    return true;
}

TEST(DeformCentroidal, TellsOfAllItsStages) {
    stages.clear();
    const Case c = TubeCase();
    DeformCentroidal(MeshD(c.shape), c.handles, Param(), vcg::fcd::Progress(&RecordStage));
    for (const char *stage : {"Reading the mesh", "Reading the handles", "Sampling patches", "Building the graph",
                              "Mapping to the mesh", "Checking the result"})
        EXPECT_TRUE(std::any_of(stages.begin(), stages.end(), [&](const auto &s) { return s.second == stage; }))
            << stage;
    for (const auto &s : stages)
        EXPECT_NE(s.second, "") << s.first;
}

TEST(DeformCentroidal, DeletedElementsAreLeftAlone) {
    Case c = TubeCase();
    c.shape.position.emplace_back(std::numeric_limits<double>::quiet_NaN(), 1, 1);
    c.handles.tag.push_back(2);
    MeshD mesh(c.shape);
    mesh.DeleteVertex(c.shape.Size() - 1);
    DeleteVertexAndFaces(mesh, 0);
    const DeformationResult r = DeformCentroidal(mesh, c.handles, Param());
    EXPECT_EQ(r.surface.vertices, VerticesThatBend(mesh, c.handles));
    EXPECT_EQ(r.position.cols(), c.shape.Size());
    EXPECT_TRUE(r.position.leftCols(c.shape.Size() - 1).allFinite());
    EXPECT_TRUE(SameBits(Vector3d(r.position.col(0)), c.shape.position[0]));
    EXPECT_EQ(r.tags.handle, DeformCentroidal(MeshD(TubeCase().shape), TubeCase().handles, Param()).tags.handle);
}

/// A tube and, beside its handle, a loose button.
static Case SleeveAndButton() {
    const Shape button = Moved(Sphere(6, 8), Affine3d(Eigen::Translation3d(1.5, 0, 5.5) * Eigen::Scaling(0.2)));
    return CaseOf(Join(Tube(40, 16), button), [](const Vector3d &p) { return p[0] > 1.1 ? 1 : TubeTag(p); });
}

TEST(DeformCentroidal, LoosePartsFollowOrStay) {
    const Case c = SleeveAndButton();
    const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
    const int button = 40 * 16;
    DeformationParam param = Param();
    const Matrix3Xd followed = Deformed(c, param);
    param.looseParts = LooseParts::Stay;
    const Matrix3Xd stayed = Deformed(c, param);
    for (int i = button; i < c.shape.Size(); ++i) {
        EXPECT_LE((followed.col(i) - bend * Vector3d(rest.col(i))).norm(), 1e-6);
        EXPECT_LE((stayed.col(i) - rest.col(i)).norm(), 1e-6);
    }
    EXPECT_LE((followed - stayed).leftCols(button).norm(), 1e-12);
    const DeformationResult r = DeformCentroidal(MeshD(c.shape), c.handles, param);
    EXPECT_EQ(r.surface.components, 2);
    EXPECT_EQ(r.looseParts, 1);
}

TEST(DeformCentroidal, UsesGivenNodes) {
    const Case c = TubeCase();
    const MeshD mesh(c.shape);
    const CentroidalGraph graph = BuildCentroidalGraph(mesh, Param().graph);
    DeformationParam param = Param();
    param.nodes = graph.geometry.position;
    const DeformationResult r = DeformCentroidal(mesh, c.handles, param);
    ExpectHeldExact(mesh, c.handles, r.position);
    int used = 0;
    for (int j = 0; j < int(param.nodes.cols()); ++j) {
        if (TubeTag(param.nodes.col(j)) != 1) // nodes are only made on free surface
            continue;
        ++used;
        const double nearest = (r.rest.position.colwise() - param.nodes.col(j)).colwise().norm().minCoeff();
        EXPECT_LE(nearest, 1e-5);
    }
    EXPECT_GT(used, 10);
    param.nodes.conservativeResize(3, 1); // one for the whole mesh
    ExpectHeldExact(mesh, c.handles, DeformCentroidal(mesh, c.handles, param).position);
    param.nodes = PositionsOf(mesh); // all of them
    ExpectHeldExact(mesh, c.handles, DeformCentroidal(mesh, c.handles, param).position);
    param.nodes = Matrix3Xd::Zero(3, 5); // all nearer to the surface than five patches are to each other
    EXPECT_EQ(DeformCentroidal(mesh, c.handles, param).placedNodes, 5);
}

TEST(DeformCentroidal, LeavesOutGivenNodesThatAreNotOnTheSurface) {
    const Case c = TubeCase();
    const MeshD mesh(c.shape);
    const Matrix3Xd nodes = BuildCentroidalGraph(mesh, Param().graph).geometry.position;
    const Index k = Index(nodes.cols()), half = k / 2;
    DeformationParam param = Param();
    param.nodes = nodes;
    const DeformationResult all = DeformCentroidal(mesh, c.handles, param);
    EXPECT_EQ(all.placedNodes, k);
    EXPECT_EQ(DeformCentroidal(mesh, c.handles, Param()).placedNodes, 0) << "none was given";
    // Shifted by less than a patch, they are still its nodes ...
    param.nodes = nodes.colwise() + Vector3d(0.05, 0.05, 0.1);
    EXPECT_EQ(DeformCentroidal(mesh, c.handles, param).placedNodes, k);
    // ... as many others elsewhere have no effect ...
    param.nodes.resize(3, 2 * k);
    param.nodes << nodes, nodes.colwise() + Vector3d(0, 100, 0);
    const DeformationResult some = DeformCentroidal(mesh, c.handles, param);
    EXPECT_EQ(some.placedNodes, k);
    EXPECT_TRUE(SameBits(some.position, all.position));
    // ... and one more is one too many.
    for (const Matrix3Xd &bad :
         {Matrix3Xd(param.nodes.rightCols(2 * k - 1)), Matrix3Xd(nodes.colwise() + Vector3d(100, 0, 0)),
          Matrix3Xd(nodes.leftCols(half) * 10)}) {
        param.nodes = bad;
        const std::string message = MessageOf<Error>([&] { DeformCentroidal(mesh, c.handles, param); });
        EXPECT_NE(message.find("given nodes lie on the surface"), std::string::npos) << message;
    }
}

TEST(DeformCentroidal, SeamsAHairApartDoNotTear) {
    // A tube cut open along its length and across it, as exporters leave seams.
    const Case whole = TubeCase();
    const Shape soup = Unwelded(whole.shape);
    const double diagonal = 4; // and more
    for (double gap : {1e-9, 1e-7}) {
        Case cut{soup, whole.handles};
        cut.handles.tag.clear();
        std::mt19937 random(1);
        std::uniform_real_distribution<double> unit(-0.3, 0.3);
        std::map<std::array<double, 3>, int> first;
        for (int i = 0; i < whole.shape.Size(); ++i) {
            const Vector3d &p = whole.shape.position[i];
            first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, i);
        }
        std::vector<int> origin;
        for (Vector3d &p : cut.shape.position) {
            origin.push_back(first.at({p[0], p[1], p[2]}));
            cut.handles.tag.push_back(whole.handles.tag[origin.back()]);
            p += gap * diagonal * Vector3d(unit(random), unit(random), unit(random));
        }
        const DeformationResult r = DeformCentroidal(MeshD(cut.shape), cut.handles, Param());
        EXPECT_EQ(r.surface.components, 1) << gap;
        std::vector<Vector3d> at(whole.shape.Size(), Vector3d::Constant(std::nan("")));
        double most = 0;
        for (int i = 0; i < cut.shape.Size(); ++i) {
            Vector3d &p = at[origin[i]];
            if (std::isnan(p[0]))
                p = r.position.col(i);
            most = std::max(most, (p - r.position.col(i)).norm());
        }
        EXPECT_LE(most, 10 * gap * diagonal) << gap;
    }
}

TEST(DeformCentroidal, ReachesItsPoseOverSteps) {
    // The branch from rest: a further step moves no vertex by more than a few times the handle's move.
    Case c = TubeCase();
    Affine3d squeeze = Affine3d::Identity();
    squeeze.translation() = Vector3d(0.2, 0, -4.5);
    c.handles.motion[2] = Motion(squeeze.matrix());
    DeformationParam param = Param();
    std::vector<double> jump;
    Matrix3Xd before;
    for (double percent = sanitized ? 95 : 60; percent <= 100; percent += 2.5) {
        param.pose = percent;
        param.steps = int(percent / 2.5);
        const Matrix3Xd x = Deformed(c, param);
        if (before.cols() > 0)
            jump.push_back((x - before).colwise().norm().maxCoeff() / (0.025 * squeeze.translation().norm()));
        before = x;
    }
    EXPECT_LE(*std::max_element(jump.begin(), jump.end()), 6);
    // With a single branch, the steps make no difference.
    c = TubeCase();
    param = Param();
    param.tolerance = 1e-8;
    const Matrix3Xd at = Deformed(c, param);
    param.steps = 4;
    EXPECT_LE((Deformed(c, param) - at).cwiseAbs().maxCoeff(), 1e-4);
    param.steps = 0;
    EXPECT_EQ(MessageOf<Error>([&] { Deformed(c, param); }), "The pose can be reached in 1 to 1000 steps.");
}

TEST(DeformCentroidal, APartOfOnePatchTurnsWithTheHandleInItsMiddle) {
    Case c = TubeCase();
    const int first = c.shape.Size();
    c.shape = Join(c.shape, Moved(Grid(21, 21, 0.02), Affine3d(Eigen::Translation3d(3, 0, 1))));
    for (int i = 0; i < 441; ++i) // 3 x 3 in the middle
        c.handles.tag.push_back(std::abs(i / 21 - 10) <= 1 && std::abs(i % 21 - 10) <= 1 ? 2 : 1);
    const Affine3d turn(Eigen::AngleAxisd(2, Vector3d(1, 2, 3).normalized()));
    c.handles.motion[2] = Motion(turn.matrix());
    for (MappingWeights weights : {MappingWeights::Surface, MappingWeights::Euclidean}) {
        DeformationParam param = Param();
        param.weights = weights;
        const Matrix3Xd x = Deformed(c, param);
        double most = 0;
        for (int i = first; i < c.shape.Size(); ++i)
            most = std::max(most, (x.col(i) - turn * c.shape.position[i]).norm());
        if (weights == MappingWeights::Surface)
            EXPECT_LE(most, 1e-6);
        else
            EXPECT_LE(most, 0.1) << "the tube's nodes pull, too";
    }
}

TEST(DeformCentroidal, LoosePartsFollowWhereAFreeVertexLiesOnAHeldOne) {
    // The nearest place of the speck is such a vertex.
    Case c{Join(Grid(5, 5), Grid(5, 5)), {}};
    for (int i = 0; i < 50; ++i)
        c.handles.tag.push_back(i < 25 ? i % 5 < 2 ? 2 : 0 : i % 5 < 2 ? 1 : i % 5 == 2 ? 0 : 1);
    c.shape = Join(c.shape, Shape{{{0, 0, 0.1}}, {}, {}});
    c.handles.tag.push_back(1);
    const Affine3d lift(Eigen::Translation3d(0, 0, 2));
    c.handles.motion[2] = Motion(lift.matrix());
    const Matrix3Xd x = Deformed(c);
    EXPECT_LE((x.col(50) - Vector3d(0, 0, 2.1)).norm(), 1e-9);
}

TEST(DeformCentroidal, TakesPointClouds) {
    Case c = TubeCase();
    c.shape = Points(c.shape);
    const MeshD mesh(c.shape);
    const DeformationResult r = DeformCentroidal(mesh, c.handles, Param());
    EXPECT_TRUE(r.surface.pointCloud);
    ExpectHeldExact(mesh, c.handles, r.position);
    // It bends like the tube of which it is a part.
    EXPECT_LE((r.position - Deformed(TubeCase())).colwise().norm().maxCoeff(), 0.5);
}

TEST(DeformCentroidal, TakesFloatMeshes) {
    const Case c = GridCase();
    const MeshF mesh(c.shape);
    const DeformationResult r = DeformCentroidal(mesh, c.handles, Param());
    ExpectHeldExact(mesh, c.handles, r.position);
    EXPECT_LE((r.position - Deformed(c)).cwiseAbs().maxCoeff(), 1e-9); // float holds these coordinates
}

/// Tags 2, 1, 0, 1, repeated.
static Handles TagsInTurn(int n) {
    Handles h;
    for (int i = 0; i < n; ++i)
        h.tag.push_back(std::array<int, 4>{2, 1, 0, 1}[i % 4]);
    h.motion[2] = Motion(bend.matrix());
    return h;
}

static void ExpectFinite(const Shape &shape, const Handles &handles) {
    const MeshD mesh(shape);
    for (MappingWeights weights : {MappingWeights::Surface, MappingWeights::Euclidean})
        for (LooseParts loose : {LooseParts::Follow, LooseParts::Stay})
            for (double radius : {0.0, 1e-3, 1e3}) {
                DeformationParam param;
                param.weights = weights;
                param.looseParts = loose;
                param.graph.targetRadius = radius;
                param.maxIterations = 50;
                const DeformationResult r = DeformCentroidal(mesh, handles, param);
                ExpectHeldExact(mesh, handles, r.position);
                EXPECT_TRUE(r.deformed.position.allFinite());
                EXPECT_TRUE(std::isfinite(r.energy));
            }
}

TEST(DeformCentroidal, TakesOneTriangle) {
    std::vector<int> tag{0, 1, 2};
    do
        ExpectFinite(Triangle(), {tag, {{2, Motion(bend.matrix())}}, {}});
    while (std::next_permutation(tag.begin(), tag.end()));
}

TEST(DeformCentroidal, TakesACollinearStrip) {
    Shape strip = Strip(50);
    for (Vector3d &p : strip.position)
        p[0] += 0.5 * p[1], p[1] = 0;
    const Case c = CaseOf(strip, [](const Vector3d &p) { return p[0] < 10 ? 0 : p[0] > 40 ? 2 : 1; });
    ExpectFinite(c.shape, c.handles);
}

TEST(DeformCentroidal, TakesFacesWithoutArea) {
    Shape shape = Points(Grid(10, 10));
    for (int i = 0; i + 1 < 100; ++i)
        shape.face.push_back({i, i + 1, i % 2 ? i : i + 1});
    ExpectFinite(shape, TagsInTurn(100));
}

TEST(DeformCentroidal, TakesAllVerticesAtOnePlace) {
    Shape shape = Triangle();
    for (Vector3d &p : shape.position)
        p = Vector3d(1, 2, 3);
    const Matrix3Xd x = DeformCentroidal(MeshD(shape), {{2, 1, 1}, {{2, Motion(bend.matrix())}}, {}}, {}).position;
    for (int i = 0; i < 3; ++i)
        EXPECT_LE((x.col(i) - bend * Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST(DeformCentroidal, TakesAFanOfAThousandFaces) {
    const int many = sanitized ? 300 : 1000;
    ExpectFinite(Fan(many), TagsInTurn(many + 2));
}

TEST(DeformCentroidal, TakesAThousandComponents) {
    Shape shape = Triangle();
    for (int i = 1; i < 1000; ++i) {
        const double turn = 0.1 * i;
        shape = Join(std::move(shape), Moved(Triangle(), Eigen::Translation3d(i % 30 * 2, i / 30 * 2, std::sin(turn)) *
                                                             Affine3d(Eigen::AngleAxisd(turn, Vector3d::UnitX()))));
    }
    Handles handles;
    handles.tag.assign(3000, 1);
    for (int i = 0; i < 30; ++i)
        handles.tag[100 * i] = i % 2 * 2;
    handles.motion[2] = Motion(bend.matrix());
    ExpectFinite(shape, handles);
}

TEST(DeformCentroidal, TakesIsolatedVertices) {
    Case c = TubeCase();
    for (int i = 0; i < 12; ++i) {
        c.shape.position.emplace_back(3 + 0.1 * i, 0, 3);
        c.handles.tag.push_back(i % 3);
    }
    ExpectFinite(c.shape, c.handles);
}

TEST(DeformCentroidal, TakesNonManifoldAndDuplicateFaces) {
    Case c = TubeCase();
    std::mt19937 random(1);
    for (int i = 0; i < 60; ++i) {
        c.shape.face.push_back(c.shape.face[random() % 1000]);
        c.shape.face.push_back({int(random() % 640), int(random() % 640), int(random() % 640)});
    }
    ExpectFinite(c.shape, c.handles);
}

TEST(DeformCentroidal, TakesHugeAndTinyCoordinates) {
    for (double scale : {1e-30, 1e12, 1e30, 1e100}) {
        Case c = TubeCase();
        c.shape = Moved(c.shape, Affine3d(Eigen::Scaling(scale)));
        Eigen::Matrix4d motion = bend.matrix();
        motion.topRightCorner<3, 1>() *= scale;
        c.handles.motion[2] = Motion(motion);
        const Matrix3Xd x = Deformed(c);
        EXPECT_TRUE(x.allFinite());
        EXPECT_LE((x / scale - Deformed(TubeCase())).cwiseAbs().maxCoeff(), 0.5) << scale;
    }
}

TEST(DeformCentroidal, TakesHandlesThatScale) {
    Case c = TubeCase();
    Affine3d large = bend;
    large.linear() *= 1.5;
    c.handles.motion[2] = Motion(large.matrix());
    const MeshD mesh(c.shape);
    ExpectHeldExact(mesh, c.handles, Deformed(c));
}

TEST(DeformCentroidal, TheShapeHardlyDependsOnTheNumberOfNodesOrTheSeed) {
    const Case c = CaseOf(Tube(160, 48), [](const Vector3d &p) { return TubeTag(p); });
    const Matrix3Xd rest = PositionsOf(MeshD(c.shape));
    const double diagonal = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
    DeformationParam param = Param(400);
    const Matrix3Xd first = Deformed(c, param);
    auto rms = [&](const DeformationParam &other) {
        return std::sqrt((Deformed(c, other) - first).squaredNorm() / double(rest.cols())) / diagonal;
    };
    for (int patches : Rounds({200, 1000})) // 300 and 1500 nodes instead of 600
        EXPECT_LT(rms(Param(patches)), 0.0075) << patches;
    for (unsigned seed : Rounds({2, 3})) {
        param.graph.randomSeed = seed;
        EXPECT_LT(rms(param), 0.004) << "seed " << seed;
    }
    DeformationParam uniform = Param(400);
    uniform.graphWeights = GraphWeights::Uniform;
    EXPECT_GT(rms(uniform), 10 * param.tolerance) << "another choice of weights is more than what the solver leaves";
}

TEST(DeformCentroidal, MeasuresStretchAndRotation) {
    DeformationParam param = Param();
    Case c = TubeCase();
    EXPECT_TRUE(DeformCentroidal(MeshD(c.shape), c.handles, param).stretch.empty());
    param.measure = true;
    const Affine3d all(Eigen::Translation3d(1, 2, 3) *
                       Eigen::AngleAxisd(40 * std::acos(-1.0) / 180, Vector3d::UnitZ()));
    c.handles.motion[2] = c.handles.motion[3] = Motion(all.matrix());
    for (int &t : c.handles.tag)
        t = t == 0 ? 3 : t;
    const DeformationResult result = DeformCentroidal(MeshD(c.shape), c.handles, param);
    ASSERT_EQ(result.stretch.size(), c.shape.position.size());
    for (std::size_t i = 0; i < result.stretch.size(); ++i) {
        EXPECT_NEAR(result.stretch[i], 1, 1e-4);
        EXPECT_NEAR(result.rotation[i], 40, 0.05);
    }
    for (const Shape &shape : {PointCloud(300), Join(Grid(9, 9), Points(Moved(Grid(2, 1), bend)))}) {
        const Case other{shape, TagsInTurn(int(shape.position.size()))};
        const DeformationResult measured = DeformCentroidal(MeshD(shape), other.handles, param);
        for (std::size_t i = 0; i < shape.position.size(); ++i) {
            EXPECT_TRUE(std::isfinite(measured.stretch[i]) && measured.stretch[i] >= 0);
            EXPECT_TRUE(measured.rotation[i] >= 0 && measured.rotation[i] <= 180.01);
        }
    }
}

TEST(DeformCentroidal, ReportsWhatItDid) {
    const Case c = TubeCase();
    const DeformationResult r = DeformCentroidal(MeshD(c.shape), c.handles, Param());
    EXPECT_TRUE(r.converged);
    EXPECT_GT(r.iterations, 0);
    EXPECT_GT(r.energy, 0);
    EXPECT_EQ(r.surface.components, 1);
    EXPECT_EQ(r.surface.vertices, VerticesThatBend(MeshD(c.shape), c.handles));
    EXPECT_EQ(r.tags.fixed + r.tags.free + r.tags.handle + r.tags.outside, c.shape.Size());
    EXPECT_EQ(r.deformed.position.cols(), r.rest.position.cols());
}

TEST(BuildCentroidalGraph, DescribesThePatchesInMeshUnits) {
    const double scale = 100;
    Shape shape =
        Moved(Jittered(Tube(60, 40), 0.02), Affine3d(Eigen::Translation3d(1e3, 0, 0) * Eigen::Scaling(scale)));
    MeshD mesh(shape);
    DeleteVertexAndFaces(mesh, 0);
    GraphParam param;
    param.initialPatches = 50;
    param.targetRadius = 0.7 * scale;
    const CentroidalGraph g = BuildCentroidalGraph(mesh, param);
    EXPECT_TRUE(g.converged);
    EXPECT_NEAR(g.targetRadius, param.targetRadius, 1e-9 * scale);
    EXPECT_EQ(g.surface.components, 1);
    ASSERT_EQ(Index(g.patchOf.size()), shape.Size());
    EXPECT_EQ(g.patchOf[0], -1);
    std::vector<double> area(shape.position.size(), 0);
    double whole = 0;
    for (const auto &f : mesh.face)
        for (int c = 0; c < 3 && !f.IsD(); ++c) {
            area[f.cV(c) - &mesh.vert[0]] += vcg::DoubleArea(f) / 6;
            whole += vcg::DoubleArea(f) / 6;
        }
    Eigen::VectorXd radius = Eigen::VectorXd::Zero(g.geometry.radius.size());
    double cost = 0; // vertices count by their area, one on average
    for (int i = 1; i < shape.Size(); ++i) {
        const double d = (mesh.At(i) - g.geometry.position.col(g.patchOf[i])).norm();
        radius[g.patchOf[i]] = std::max(radius[g.patchOf[i]], d);
        cost += d * d * area[i] / whole * mesh.vn;
    }
    EXPECT_LE((radius - g.geometry.radius).cwiseAbs().maxCoeff(), 1e-4 * scale);
    EXPECT_LE(radius.maxCoeff(), param.targetRadius * (1 + 1e-5));
    EXPECT_NEAR(g.cost, cost, 1e-4 * cost);
    EdgeSet expected, found;
    for (const auto &f : mesh.face)
        for (int c = 0; c < 3 && !f.IsD(); ++c)
            Insert(expected, g.patchOf[f.cV(c) - &mesh.vert[0]], g.patchOf[f.cV((c + 1) % 3) - &mesh.vert[0]]);
    for (const auto &e : g.geometry.edge) {
        EXPECT_LT(e[0], e[1]);
        Insert(found, e[0], e[1]);
    }
    EXPECT_EQ(found, expected);
}

class VertexN;
class FaceN;
class EdgeN;
struct TypesN
    : vcg::UsedTypes<vcg::Use<VertexN>::AsVertexType, vcg::Use<EdgeN>::AsEdgeType, vcg::Use<FaceN>::AsFaceType> {};
class VertexN : public vcg::Vertex<TypesN, vcg::vertex::Coord3d, vcg::vertex::Normal3d, vcg::vertex::BitFlags> {};
class FaceN : public vcg::Face<TypesN, vcg::face::VertexRef, vcg::face::BitFlags> {};
class EdgeN : public vcg::Edge<TypesN, vcg::edge::VertexRef, vcg::edge::BitFlags> {};

TEST(BuildCentroidalGraph, GivesNodesTheNormalsOfTheirVertices) {
    MeshOf<VertexN, EdgeN, FaceN> mesh(Jittered(Sphere(24, 32), 0.02));
    for (auto &v : mesh.vert)
        v.N() = vcg::Point3d(v.P()[1], v.P()[2], v.P()[0]);
    const GraphGeometry g = BuildCentroidalGraph(mesh, Param().graph).geometry;
    ASSERT_EQ(g.normal.cols(), g.position.cols());
    for (Index i = 0; i < g.position.cols(); ++i) {
        const Vector3d p = g.position.col(i);
        EXPECT_LE((g.normal.col(i) - Vector3d(p[1], p[2], p[0])).norm(), 1e-6) << i;
    }
}

TEST(DeformCentroidal, NodesHaveNormalsWhereTheHandleIsFlat) {
    const Shape shape = Jittered(Sphere(24, 32), 0.02);
    MeshOf<VertexN, EdgeN, FaceN> mesh(shape);
    for (int i = 0; i < shape.Size(); ++i)
        mesh.vert[i].N() = mesh.vert[i].P();
    Case c = CaseOf(shape, [](const Vector3d &p) { return p[2] < -0.7 ? 0 : p[2] > 0.2 ? 2 : 1; });
    Eigen::Matrix4d &flat = c.handles.motion[2].matrix; // set directly, it is not refused
    flat = Eigen::Vector4d(1, 1, 0, 1).asDiagonal();
    flat(2, 3) = 1;
    stages.clear();
    const DeformationResult r = DeformCentroidal(mesh, c.handles, Param(), vcg::fcd::Progress(&RecordStage));
    ASSERT_TRUE(r.deformed.normal.allFinite());
    int onHandle = 0;
    for (Index j = 0; j < r.rest.position.cols(); ++j)
        if (r.rest.position(2, j) > 0.2) {
            ++onHandle;
            EXPECT_LE(r.deformed.normal.col(j).normalized().cross(Vector3d::UnitZ()).norm(), 1e-6);
        }
    EXPECT_GT(onHandle, 3);
    EXPECT_TRUE(std::any_of(stages.begin(), stages.end(), [](const auto &s) {
        return s.first >= 99 && s.second == "Building the graph";
    })) << "the layers of the graph can be cancelled, too";
}

TEST(BuildCentroidalGraph, CanBeCancelledAnywhere) {
    const MeshD mesh(Grid(40, 40));
    CallbackLog all;
    BuildCentroidalGraph(mesh, Param().graph, all.Progress(1));
    EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
    EXPECT_EQ(all.percent.back(), 100);
    const std::size_t calls = all.percent.size();
    for (std::size_t i = 0; i < calls; ++i) {
        CallbackLog log(i);
        EXPECT_THROW(BuildCentroidalGraph(mesh, Param().graph, log.Progress(1)), Cancelled);
    }
}

TEST(BuildCentroidalGraph, RefusesParametersOutOfRange) {
    GraphParam param;
    param.initialPatches = -1;
    EXPECT_THROW(BuildCentroidalGraph(MeshD(Grid(3, 3)), param), Error);
    EXPECT_THROW(BuildCentroidalGraph(MeshD(), {}), Error);
}
