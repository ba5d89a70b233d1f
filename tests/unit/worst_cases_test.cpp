// SPDX-License-Identifier: GPL-3.0-or-later
//
// The worst possible meshes and handles: within seconds, finite output with held vertices in place, or one clear error.
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/surface/surface_regions.h>
#include "test_support.h"

#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using vcg::tri::BuildCentroidalGraph;
using vcg::tri::DeformCentroidal;

static const int many = sanitized ? 2000 : 70000; // more than 16 bits can count

/// \p n triangles, each by itself, in a box.
static Shape LooseTriangles(int n) {
    const int side = int(std::ceil(std::cbrt(n)));
    Shape s;
    for (int i = 0; i < n; ++i) {
        const double x = 2 * (i % side), y = 2 * (i / side % side), z = 2 * (i / side / side), turn = 0.1 * i;
        s.position.emplace_back(x, y, z);
        s.position.emplace_back(x + std::cos(turn), y + std::sin(turn), z);
        s.position.emplace_back(x, y + 0.5, z + 1);
        s.face.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return s;
}

/// Faces that are a point, an edge seen twice, or three places on a line; n x n vertices.
static Shape NoArea(int n) {
    Shape s = Points(Grid(n, n));
    for (int i = 0; i + 2 < n * n; ++i) {
        s.face.push_back({i, i, i});
        s.face.push_back({i, i + 1, i + i % 2});
        if (i % n + 2 < n)
            s.face.push_back({i, i + 1, i + 2});
        if (i + 2 * n < n * n)
            s.face.push_back({i, i + 2 * n, i + n});
    }
    return s;
}

static Shape AtOnePoint(Shape s, const Vector3d &point) {
    for (Vector3d &p : s.position)
        p = point;
    return s;
}

/// Tags 2, 1, 0, 1 around and around; the handle makes \p motion.
static Handles TagsInTurn(std::size_t n, const Affine3d &motion = bend) {
    Handles h;
    for (std::size_t i = 0; i < n; ++i)
        h.tag.push_back(std::array<int, 4>{2, 1, 0, 1}[i % 4]);
    h.motion[2] = Motion(motion.matrix());
    return h;
}

static Case Bar(double scale = 1, const Vector3d &at = Vector3d::Zero()) {
    Case c = CaseOf(Jittered(Tube(40, 16), 0.02), [](const Vector3d &p) { return TubeTag(p); });
    c.shape = Moved(c.shape, Eigen::Translation3d(at) * Affine3d(Eigen::Scaling(scale)));
    Affine3d there = bend;
    there.translation() = scale * bend.translation() + at - bend.linear() * at;
    c.handles.motion[2] = Motion(there.matrix());
    return c;
}

static DeformationParam CoarseParam(double targetRadius = 0) {
    DeformationParam param;
    param.graph.targetRadius = targetRadius;
    param.maxIterations = 100; // enough to be right, if not at rest
    return param;
}

/// Deforms with both kinds of weights, and checks the promises for held vertices.
static void ExpectDeforms(const Shape &shape, const Handles &handles, DeformationParam param = CoarseParam()) {
    const MeshD mesh(shape);
    for (MappingWeights weights : {MappingWeights::Surface, MappingWeights::Euclidean}) {
        param.weights = weights;
        const DeformationResult r = DeformCentroidal(mesh, handles, param);
        ExpectHeldExact(mesh, handles, r.position);
        EXPECT_TRUE(r.rest.position.allFinite() && r.deformed.position.allFinite());
        EXPECT_TRUE(std::isfinite(r.energy));
        param.maxIterations = std::min(param.maxIterations, 20);
    }
}

static void ExpectGraph(const Shape &shape, GraphParam param = {}) {
    const CentroidalGraph g = BuildCentroidalGraph(MeshD(shape), param);
    EXPECT_TRUE(g.geometry.position.allFinite() && g.geometry.radius.allFinite());
    EXPECT_TRUE(std::isfinite(g.cost) && std::isfinite(g.targetRadius) && std::isfinite(g.averageEdge));
    for (Index patch : g.patchOf)
        ASSERT_TRUE(patch >= 0 && patch < Index(g.geometry.position.cols()));
}

static std::string ErrorOf(const Case &c, const DeformationParam &param = CoarseParam()) {
    const MeshD mesh(c.shape);
    const std::vector<VertexD> before = mesh.vert;
    const std::string message = MessageOf<Error>([&] { DeformCentroidal(mesh, c.handles, param); });
    if (!before.empty()) {
        EXPECT_EQ(std::memcmp(before.data(), mesh.vert.data(), before.size() * sizeof before[0]), 0);
    }
    return message;
}

static void ExpectError(const Case &c, const std::string &word, const DeformationParam &param = CoarseParam()) {
    const std::string message = ErrorOf(c, param);
    EXPECT_NE(message.find(word), std::string::npos) << message;
}

TEST(WorstCases, ManyComponents) {
    const Shape shape = LooseTriangles(many);
    ExpectGraph(shape);
    Handles few;
    few.tag.assign(shape.position.size(), 1);
    for (int i = 0; i < 30; ++i)
        few.tag[many / 20 * i] = i % 2 * 2;
    few.motion[2] = Motion(bend.matrix());
    ExpectDeforms(shape, few);
    const Shape part = LooseTriangles(many / 3 + 1); // more vertices than 16 bits can count
    ExpectDeforms(part, TagsInTurn(part.position.size()));
}

TEST(WorstCases, ManyHandles) {
    const Shape shape = LooseTriangles(many / 3 + 1);
    Handles all;
    for (int i = 0; i < shape.Size(); ++i) {
        all.tag.push_back(i % 3 == 0 ? 1 : i);
        all.motion[i] = Motion(Affine3d(Eigen::Translation3d(0, 0.001 * i, 0)).matrix());
    }
    all.tag[1] = shape.Size(); // not 1, which is free
    ExpectDeforms(shape, all);
}

/// Faces around an edge. With sanitizers, factorising a star takes time by the cube of its size: 20 s for a thousand.
static const int manyAround = sanitized ? 300 : many;

TEST(WorstCases, AFanOfManyFaces) {
    const int n = manyAround;
    const Shape fan = Fan(n);
    ExpectGraph(fan);
    Handles few;
    few.tag.assign(fan.position.size(), 1);
    few.tag[0] = 0;
    few.tag[n / 20] = 2;
    few.motion[2] = Motion(bend.matrix());
    ExpectDeforms(fan, few);
}

TEST(WorstCases, AFanOfTagsInTurn) {
    const Shape fan = Fan(manyAround);
    ExpectDeforms(fan, TagsInTurn(fan.position.size()));
}

TEST(WorstCases, AFanOfAPatchPerVertex) {
    // The graph is a star: one node with ten thousand neighbours; 2500 are already too many for the bi-Laplacian.
    const int n = sanitized ? 2500 : 10000;
    const Shape fan = Fan(n);
    Handles few;
    few.tag.assign(fan.position.size(), 1);
    for (int i = 2; i < n / 10; ++i)
        few.tag[i] = i % 2 * 2;
    few.motion[2] = Motion(bend.matrix());
    ExpectDeforms(fan, few, CoarseParam(1e-5));
}

TEST(WorstCases, FacesWithoutArea) {
    const int n = sanitized ? 40 : 70;
    const Shape shape = NoArea(n);
    ExpectGraph(shape);
    ExpectDeforms(shape, TagsInTurn(shape.position.size()));
    const Case c = CaseOf(shape, [&](const Vector3d &p) { return p[0] < 0.14 * n ? 0 : p[0] > 0.8 * n ? 2 : 1; });
    ExpectDeforms(c.shape, c.handles);
}

TEST(WorstCases, AllVerticesAtOnePoint) {
    const Vector3d point(1, 2, 3);
    const Shape grid = AtOnePoint(sanitized ? Grid(70, 70) : Grid(300, 300), point); // too many to look at each pair
    for (const Shape &shape : {grid, Points(grid)}) {
        ExpectGraph(shape);
        // One position is one node: a fixed vertex there holds all of it, and a handle carries free ones.
        Handles handles = TagsInTurn(shape.position.size());
        Matrix3Xd x = DeformCentroidal(MeshD(shape), handles, CoarseParam()).position;
        EXPECT_TRUE((x.colwise() - point).isZero(0));
        std::replace(handles.tag.begin(), handles.tag.end(), 0, 1);
        x = DeformCentroidal(MeshD(shape), handles, CoarseParam()).position;
        EXPECT_LE((x.colwise() - bend * point).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(WorstCases, OneTriangle) {
    ExpectGraph(Triangle());
    std::vector<int> tag{0, 1, 2};
    do
        for (double radius : {0.0, 1e-3, 1e3})
            ExpectDeforms(Triangle(), {tag, {{2, Motion(bend.matrix())}}, {}}, CoarseParam(radius));
    while (std::next_permutation(tag.begin(), tag.end()));
}

TEST(WorstCases, OneVertex) {
    const Shape one{{{1, 2, 3}}, {}, {}};
    ExpectGraph(one);
    for (int tag : {-1, 0, 1})
        ExpectError({one, {{tag}, {}, {}}}, "There is no handle");
    ExpectError({one, {{2}, {}, {}}}, "nothing to deform");
    ExpectError({Shape(), {}}, "There is no handle");
    EXPECT_NE(MessageOf<Error>([] { BuildCentroidalGraph(MeshD(), {}); }).find("no vertices"), std::string::npos);
}

TEST(WorstCases, ACollinearStrip) {
    Shape strip = Strip(2000);
    for (Vector3d &p : strip.position)
        p = Vector3d(p[0] + 0.5 * p[1], 2 * p[0] + p[1], 0);
    const Case c = CaseOf(strip, [](const Vector3d &p) { return p[0] < 300 ? 0 : p[0] > 1700 ? 2 : 1; });
    ExpectGraph(c.shape);
    ExpectDeforms(c.shape, c.handles);
    ExpectDeforms(Points(c.shape), c.handles);
}

TEST(WorstCases, FineDetailFarFromTheOrigin) {
    // At 1e7 with detail of 1e-2: the same result as at the origin, up to the precision of the coordinates.
    const Vector3d far(1e7, -1e7, 1e7);
    const Case near = Bar(), there = Bar(1, far);
    const MeshD mesh(there.shape);
    const DeformationResult r = DeformCentroidal(mesh, there.handles, CoarseParam());
    ExpectHeldExact(mesh, there.handles, r.position);
    EXPECT_EQ(r.surface.welded, 0);
    const Matrix3Xd expected = DeformCentroidal(MeshD(near.shape), near.handles, CoarseParam()).position;
    EXPECT_LE(((r.position.colwise() - far) - expected).cwiseAbs().maxCoeff(), 1e-2);
}

TEST(WorstCases, DetailBelowThePrecisionOfTheFrame) {
    // 1e7 wide, with two pieces whose vertices are 1e-2 apart: in the frame each is a point.
    const Shape shape =
        Join(Moved(Grid(20, 20, 0.01), Affine3d(Eigen::Translation3d(-1e7, 0, 0))),
             Join(Grid(50, 50, 1e5), Moved(Grid(20, 20, 0.01), Affine3d(Eigen::Translation3d(1e7, 0, 0)))));
    const Case c = CaseOf(shape, [](const Vector3d &p) { return p[0] < 0 ? 0 : p[0] > 9e6 ? 2 : 1; });
    ExpectGraph(c.shape);
    ExpectDeforms(c.shape, c.handles);
}

TEST(WorstCases, WhatIsFreeIsFarSmallerThanTheWayToWhatHoldsIt) {
    for (double size : {1e-10, 1e-12, 1e-16, 1e-25, 0.0}) {
        Case c = CaseOf(Jittered(Grid(61, 31), 0.1), [](const Vector3d &p) {
            return p[0] < 6 ? 0 : p[0] > 54 ? 2 : 1;
        });
        for (std::size_t i = 0; i < c.shape.position.size(); ++i)
            if (c.handles.tag[i] == 1)
                c.shape.position[i] = size * (c.shape.position[i] - Vector3d(30, 15, 0));
        ExpectDeforms(c.shape, c.handles);
    }
}

TEST(WorstCases, HugeAndTinyCoordinates) {
    const Matrix3Xd once = DeformCentroidal(MeshD(Bar().shape), Bar().handles, CoarseParam()).position;
    for (double scale : {std::ldexp(1., -1000), std::ldexp(1., -100), std::ldexp(1., 100), std::ldexp(1., 330)}) {
        const Case c = Bar(scale);
        ExpectGraph(c.shape);
        ExpectDeforms(c.shape, c.handles);
        const Matrix3Xd x = DeformCentroidal(MeshD(c.shape), c.handles, CoarseParam()).position;
        EXPECT_LE((x / scale - once).cwiseAbs().maxCoeff(), 1e-9) << scale;
    }
    // Near the largest numbers: positions are finite, but squares of lengths may overflow.
    for (double scale : {1e-308, 1e200, 2e307}) {
        Case c = Bar();
        c.shape = Moved(c.shape, Affine3d(Eigen::Scaling(scale)));
        c.handles.motion[2] = Motion(Affine3d(bend.linear()).matrix());
        const MeshD mesh(c.shape);
        ExpectHeldExact(mesh, c.handles, DeformCentroidal(mesh, c.handles, CoarseParam()).position);
    }
}

TEST(WorstCases, FloatCoordinatesAtTheEndsOfTheirRange) {
    for (double scale : {1e-38, 1e-30, 1e30, 1e37}) {
        const Case c = Bar(scale);
        const MeshF mesh(c.shape);
        ExpectHeldExact(mesh, c.handles, DeformCentroidal(mesh, c.handles, CoarseParam()).position);
    }
}

TEST(WorstCases, DeletedVerticesAndFaces) {
    Case c = Bar();
    MeshD mesh(c.shape);
    for (int f = 0; f < int(mesh.face.size()); f += 3)
        mesh.DeleteFace(f);
    for (int v = 0; v < int(mesh.vert.size()); v += 5) {
        for (int f = 0; f < int(mesh.face.size()); ++f)
            for (int k = 0; k < 3; ++k)
                if (!mesh.face[f].IsD() && mesh.face[f].V(k) == &mesh.vert[v])
                    mesh.DeleteFace(f);
        mesh.vert[v].P()[1] = std::numeric_limits<double>::infinity();
        mesh.DeleteVertex(v);
    }
    const DeformationResult r = DeformCentroidal(mesh, c.handles, CoarseParam());
    ExpectHeldExact(mesh, c.handles, r.position);
    EXPECT_GT(r.surface.vertices, 0); // of the part that bends
    EXPECT_LE(r.surface.vertices, mesh.vn);
    EXPECT_EQ(r.tags.fixed + r.tags.handle + r.tags.free, mesh.vn);

    for (int v = 0; v < int(mesh.vert.size()); ++v) // a face may be left whose vertices are gone
        if (!mesh.vert[v].IsD() && v != 101)
            mesh.DeleteVertex(v);
    const CentroidalGraph one = BuildCentroidalGraph(mesh, {});
    EXPECT_EQ(one.geometry.position.cols(), 1);
    EXPECT_EQ(one.patchOf[101], 0);
    mesh.DeleteVertex(101);
    EXPECT_NE(MessageOf<Error>([&] { BuildCentroidalGraph(mesh, {}); }).find("no vertices"), std::string::npos);
    EXPECT_NE(MessageOf<Error>([&] { DeformCentroidal(mesh, c.handles, CoarseParam()); }).find("no handle"),
              std::string::npos);
}

TEST(WorstCases, CoordinatesThatAreNotFinite) {
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                       -std::numeric_limits<double>::infinity()})
        for (int d = 0; d < 3; ++d) {
            Case c = Bar();
            c.shape.position[17][d] = bad;
            c.shape.position[500][d] = bad;
            ExpectError(c, "Vertex 17 has a coordinate that is not a finite number");
            EXPECT_NE(MessageOf<Error>([&] { BuildCentroidalGraph(MeshD(c.shape), {}); }).find("Vertex 17"),
                      std::string::npos);
        }
}

TEST(WorstCases, EverythingFixedOrNothingTagged) {
    Case c = Bar();
    for (int tag : {-5, 0, 1}) {
        c.handles.tag.assign(c.shape.position.size(), tag);
        ExpectError(c, "There is no handle");
    }
    c.handles.tag.assign(c.shape.position.size(), 2);
    ExpectError(c, "nothing to deform");
    c.handles.tag[3] = 0;
    ExpectError(c, "nothing to deform");
    c.handles.tag[3] = 1; // one free vertex is enough
    ExpectDeforms(c.shape, c.handles);
}

TEST(WorstCases, TagsAtTheEndsOfTheirRange) {
    Case c = Bar();
    const int most = std::numeric_limits<int>::max(), least = std::numeric_limits<int>::min();
    for (int &tag : c.handles.tag)
        tag = tag == 0 ? least : tag == 2 ? most : tag;
    c.handles.motion[most] = c.handles.motion.at(2);
    ExpectDeforms(c.shape, c.handles);
    c.handles.point.push_back({300, Vector3d(1, 2, 3)});
    ExpectDeforms(c.shape, c.handles);
}

TEST(WorstCases, AHandleWithoutAMotionStays) {
    Case c = Bar();
    c.handles.motion.clear();
    ExpectDeforms(c.shape, c.handles);
    c.handles.motion[77] = Motion(bend.matrix()); // of no vertex
    ExpectDeforms(c.shape, c.handles);
}

TEST(WorstCases, MotionsThatCannotBe) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    auto error = [](const Eigen::Matrix4d &m) { return MessageOf<Error>([&] { Motion{m}; }); };
    for (const Vector3d &diagonal :
         {Vector3d(1, 1, -1), Vector3d(-1, -1, -1), Vector3d(1, 1, 0), Vector3d(0, 0, 0), Vector3d(1, 1e-14, 1)})
        EXPECT_NE(error(Affine3d(diagonal.asDiagonal()).matrix()).find("mirrors or flattens"), std::string::npos);
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m(1, 3) = nan;
    EXPECT_NE(error(m).find("not finite"), std::string::npos);
    m(1, 3) = 0;
    m(3, 1) = 1;
    EXPECT_NE(error(m).find("not affine"), std::string::npos);
}

TEST(WorstCases, MotionsBeyondAllMeasure) {
    for (double far : {1e6, 1e20}) {
        Case c = Bar();
        c.handles.motion[2] = Motion(Affine3d(Eigen::Translation3d(far, 0, 0)).matrix());
        ExpectDeforms(c.shape, c.handles);
        c.handles.motion[2] = Motion(Affine3d(Eigen::Scaling(far)).matrix());
        ExpectDeforms(c.shape, c.handles);
        c.handles.motion[2] = Motion(Affine3d(Eigen::Scaling(1 / far)).matrix());
        ExpectDeforms(c.shape, c.handles);
    }
    const char *const tooFar = "Handle 2 moves too far";
    Case c = Bar();
    for (double far : {1e40, 1e200, 1e308}) {
        c.handles.motion[2] = Motion(Affine3d(Eigen::Translation3d(far, 0, 0)).matrix());
        ExpectError(c, tooFar);
    }
    c.handles.motion[2] = Motion(Affine3d(Eigen::Scaling(1e90)).matrix());
    ExpectError(c, tooFar);
    c.handles.motion[2] = Motion(Affine3d(Eigen::Scaling(2.0)).matrix());
    DeformationParam param = CoarseParam();
    for (double pose : {1e6, 1e300, -1e300}) {
        param.pose = pose;
        if (pose > 0)
            ExpectError(c, tooFar, param);
    }
    Case point = Bar();
    point.handles.point.push_back({300, Vector3d(1e100, 0, 0)});
    ExpectError(point, "Point handle 1 moves too far");
}

// In a suite of its own: ThreadSanitizer runs no other worst cases.
TEST(WorstCasesInThreads, AreTheSameToTheBit) {
    const int n = sanitized ? 5000 : 35000;
    const Shape duplicates = Join(PointCloud(3000), PointCloud(3000)), sheet = Grid(n / 650, 160);
    for (const Shape &shape : {LooseTriangles(SurfaceRegions::most + 200), NoArea(sanitized ? 40 : 120), Fan(n / 20),
                               Points(duplicates), Unwelded(Jittered(sheet, 0.2))}) {
        const MeshD mesh(shape);
        const Handles handles = TagsInTurn(shape.position.size());
        DeformationParam param;
        param.maxIterations = 20;
        const DeformationResult one = DeformCentroidal(mesh, handles, param, Threads(1));
        const CentroidalGraph graph = BuildCentroidalGraph(mesh, param.graph, Threads(1));
        for (unsigned threads : Rounds({7u, 2u})) {
            const DeformationResult same = DeformCentroidal(mesh, handles, param, Threads(threads));
            EXPECT_TRUE(SameBits(same.position, one.position));
            EXPECT_EQ(same.energy, one.energy);
            const CentroidalGraph sameGraph = BuildCentroidalGraph(mesh, param.graph, Threads(threads));
            EXPECT_EQ(sameGraph.patchOf, graph.patchOf);
            EXPECT_EQ(sameGraph.cost, graph.cost);
            EXPECT_TRUE(SameBits(sameGraph.geometry.radius, graph.geometry.radius));
        }
    }
}

TEST(WorstCases, EachTriangleForItselfAHairFromTheOthers) {
    // Corners at one position are slightly apart, as after a conversion; also held ones.
    const auto tagAt = [](const Vector3d &p) { return TubeTag(p); };
    const Shape shape = Tube(40, 30);
    const Case whole = CaseOf(shape, tagAt);
    Case apart = CaseOf(Unwelded(shape), tagAt);
    const Matrix3Xd expected = DeformCentroidal(MeshD(shape), whole.handles, {}).position;
    for (const double hair : {1e-9, 1e-7, 1e-6}) { // the tube is 6.6 across
        const MeshD mesh(Jittered(apart.shape, hair));
        const DeformationResult result = DeformCentroidal(mesh, apart.handles, {});
        ExpectHeldExact(mesh, apart.handles, result.position);
        double square = 0;
        for (std::size_t f = 0; f < shape.face.size(); ++f)
            for (std::size_t c = 0; c < 3; ++c)
                square += (result.position.col(Eigen::Index(3 * f + c)) - expected.col(shape.face[f][c])).squaredNorm();
        EXPECT_LE(std::sqrt(square / double(3 * shape.face.size())), 0.003 * 6.6) << hair;
    }
}

TEST(WorstCases, MoreNodesThanCanBeSolved) {
    if (sanitized)
        GTEST_SKIP() << "takes minutes";
    DeformationParam param;
    param.graph.targetRadius = 1e-9; // a patch a vertex
    ExpectError(CaseOf(Grid(460, 460), [](const Eigen::Vector3d &p) { return p[0] < 5     ? 0
                                                                             : p[0] > 455 ? 2
                                                                                          : 1; }),
                "nodes; 200000 are the most", param);
}

TEST(WorstCases, TrianglesForThemselvesInAnyPlane) {
    // Borders are searched along a line, which is normal to this plane.
    const Vector3d line = Vector3d(0.5773, 0.6144, 0.5378).normalized();
    const Shape flat = Unwelded(Grid(sanitized ? 40 : 120, sanitized ? 40 : 120));
    Shape standing = flat;
    for (Vector3d &p : standing.position)
        p = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), line) * p;
    double seconds[2];
    Index joined[2];
    for (const bool stands : {false, true}) {
        const MeshD mesh(Jittered(stands ? standing : flat, 1e-6));
        const Stopwatch watch;
        joined[stands] = BuildSurfaceGraph(Read(mesh)).report.seams;
        seconds[stands] = watch.Seconds();
    }
    EXPECT_GT(joined[0], Index(flat.face.size()));
    EXPECT_GT(joined[1], Index(flat.face.size()));
    EXPECT_LE(seconds[1], 5 * seconds[0] + 0.1);
}
