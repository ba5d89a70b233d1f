// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/morton.h>
#include <vcg_ext/surface/point_cloud.h>
#include "test_support.h"

#include <limits>
#include <map>

using namespace vcg::fcd;
using namespace fcd_test;

/// Compares nodes and edges with the mesh: live vertices at equal positions are one node.
template <class Mesh>
static void ExpectConnectivity(const Mesh &mesh, const SurfaceGraph &s) {
    std::map<std::array<double, 3>, Index> nodeAt;
    ASSERT_EQ(s.nodeOf.size(), mesh.vert.size());
    for (int i = 0; i < int(mesh.vert.size()); ++i) {
        if (mesh.vert[i].IsD()) {
            EXPECT_EQ(s.nodeOf[i], -1);
            continue;
        }
        const Eigen::Vector3d p = mesh.At(i);
        ASSERT_GE(s.nodeOf[i], 0);
        ASSERT_LT(s.nodeOf[i], s.graph.Size());
        EXPECT_EQ(nodeAt.emplace(std::array<double, 3>{p[0], p[1], p[2]}, s.nodeOf[i]).first->second, s.nodeOf[i]);
        const Eigen::Vector3d node = s.graph.position.col(s.nodeOf[i]).template cast<double>();
        EXPECT_LE((s.frame.FromFrame(node) - p).norm(), 1e-6 * s.frame.scale);
    }
    EXPECT_EQ(Index(nodeAt.size()), s.graph.Size());
    EXPECT_EQ(s.report.vertices, mesh.vn);
    EXPECT_EQ(s.report.welded, mesh.vn - s.graph.Size());

    EdgeSet expected;
    const auto *first = mesh.vert.data();
    for (const auto &f : mesh.face)
        for (int c = 0; c < 3 && !f.IsD(); ++c)
            Insert(expected, s.nodeOf[f.cV(c) - first], s.nodeOf[f.cV((c + 1) % 3) - first]);
    for (const auto &e : mesh.edge)
        if (!e.IsD())
            Insert(expected, s.nodeOf[e.cV(0) - first], s.nodeOf[e.cV(1) - first]);
    ExpectAdjacencyInOrder(s.graph.adjacency);
    EXPECT_EQ(EdgesOf(s.graph.adjacency), expected);
}

static SurfaceGraph Checked(const Shape &shape) {
    const MeshD mesh(shape);
    SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
    ExpectConnectivity(mesh, s);
    return s;
}

/// The graph's edges between vertices of the mesh (each node's first vertex).
static EdgeSet VertexEdges(const SurfaceGraph &s) {
    std::vector<Index> vertexOf(s.graph.Size(), -1);
    for (Index i = Index(s.nodeOf.size()) - 1; i >= 0; --i)
        if (s.nodeOf[i] >= 0)
            vertexOf[s.nodeOf[i]] = i;
    EdgeSet edges;
    for (const auto &e : EdgesOf(s.graph.adjacency))
        Insert(edges, vertexOf[e.first], vertexOf[e.second]);
    return edges;
}

static void ExpectSameBits(const SurfaceGraph &a, const SurfaceGraph &b) {
    EXPECT_EQ(a.nodeOf, b.nodeOf);
    EXPECT_EQ(a.graph.adjacency.begin, b.graph.adjacency.begin);
    EXPECT_EQ(a.graph.adjacency.item, b.graph.adjacency.item);
    EXPECT_TRUE(SameBits(a.graph.position, b.graph.position));
    EXPECT_EQ(a.nodeArea, b.nodeArea);
    EXPECT_EQ(a.area, b.area);
    EXPECT_EQ(a.averageEdge, b.averageEdge);
}

TEST(SurfaceGraph, HasTheMeshsEdges) {
    for (const Shape &shape : {Triangle(), Quad(), Grid(7, 5), Strip(9), Tube(5, 7), Sphere(5, 8), Fan3(), Fan(1000),
                               TwoSheets(4, 0.1), UnweldedGrid(6, 4), Wireframe(5, 4)})
        Checked(shape);
}

TEST(SurfaceGraph, ReportsACleanMeshAsClean) {
    const SurfaceReport r = Checked(Sphere(5, 8)).report;
    EXPECT_EQ(r.welded, 0);
    EXPECT_EQ(r.isolated, 0);
    EXPECT_EQ(r.nonManifoldEdges, 0);
    EXPECT_EQ(r.degenerateFaces, 0);
    EXPECT_FALSE(r.pointCloud);
}

TEST(SurfaceGraph, CountsNonManifoldEdges) {
    EXPECT_EQ(Checked(Fan(2)).report.nonManifoldEdges, 0);
    EXPECT_EQ(Checked(Fan3()).report.nonManifoldEdges, 1);
    EXPECT_EQ(
        Checked(Join(Fan3(), Moved(Fan(5), Eigen::Affine3d(Eigen::Translation3d(9, 0, 0))))).report.nonManifoldEdges,
        2);
}

TEST(SurfaceGraph, NeitherEdgeElementsNorDegenerateFacesMakeAnEdgeNonManifold) {
    Shape shape = Quad();
    shape.edge = {{0, 3}, {0, 1}};
    EXPECT_EQ(Checked(shape).report.nonManifoldEdges, 0) << "edge elements";
    shape = Quad();
    shape.face.push_back({0, 0, 1});
    EXPECT_EQ(Checked(shape).report.nonManifoldEdges, 0) << "degenerate face";
}

TEST(SurfaceGraph, DuplicateFacesAddNothing) {
    Shape shape = Grid(3, 3);
    const EdgeSet once = VertexEdges(Checked(shape));
    shape.face.insert(shape.face.end(),
                      {shape.face[0], shape.face[3], {shape.face[3][2], shape.face[3][1], shape.face[3][0]}});
    EXPECT_EQ(VertexEdges(Checked(shape)), once);
}

TEST(SurfaceGraph, FacesAtTheSameNodesAreOne) {
    Shape unoriented = Sphere(20, 30);
    for (std::size_t f = 0; f < unoriented.face.size(); f += 3)
        std::swap(unoriented.face[f][0], unoriented.face[f][2]);
    Shape touching = Join(Sphere(5, 8), Triangle()); // a flap on a closed fan
    touching.position.back() = touching.position[0];
    Shape crossed = Join(Grid(9, 9), Fan(40));
    for (int i = 0; i < 80; i += 9)
        crossed.edge.push_back({i, i + 1});
    crossed.face.push_back({0, 0, 1});
    std::mt19937 random(1);
    for (const Shape &shape : {Triangle(), Quad(), Fan3(), Grid(100, 90), Sphere(20, 30), unoriented, touching, crossed,
                               Join(Grid(70, 70), Sphere(30, 40))}) {
        const SurfaceGraph once = Checked(shape);
        EXPECT_EQ(once.report.repeatedFaces, 0);
        const int n = int(shape.face.size()), proper = n - int(once.report.degenerateFaces);
        for (int chosen : {1, 4, n})
            for (bool unwelded : {false, true}) {
                Shape repeated = shape;
                int count = 0;
                for (int i = 0; i < n; i += n / std::min(n, chosen))
                    for (int times = 1 + int(random() % 2); i < proper && times > 0; --times, ++count) {
                        std::array<int, 3> face = shape.face[i];
                        std::shuffle(face.begin(), face.end(), random);
                        for (int j = 0; j < 3 && unwelded; ++j) {
                            repeated.position.push_back(shape.position[face[j]]);
                            face[j] = repeated.Size() - 1;
                        }
                        repeated.face.push_back(face);
                    }
                const SurfaceGraph s = Checked(repeated);
                EXPECT_EQ(s.report.repeatedFaces, count);
                EXPECT_EQ(s.report.nonManifoldEdges, once.report.nonManifoldEdges);
                EXPECT_EQ(s.graph.adjacency.item, once.graph.adjacency.item);
                EXPECT_EQ(s.nodeArea, once.nodeArea);
                EXPECT_EQ(s.area, once.area);
                EXPECT_EQ(s.averageEdge, once.averageEdge);
            }
    }
}

TEST(SurfaceGraph, BordersOfFacesThatAreRepeatedAreJoinedAHairApart) {
    Shape shape = Join(Grid(5, 4), Moved(Grid(5, 4), Eigen::Affine3d(Eigen::Translation3d(4, 2e-7, 0))));
    const SurfaceGraph once = BuildSurfaceGraph(Read(MeshD(shape)));
    EXPECT_GT(once.report.seams, 0);
    const std::vector<std::array<int, 3>> copy = shape.face;
    shape.face.insert(shape.face.end(), copy.begin(), copy.end());
    const SurfaceGraph twice = BuildSurfaceGraph(Read(MeshD(shape)));
    EXPECT_EQ(twice.report.seams, once.report.seams);
    ExpectSameBits(twice, once);
}

TEST(SurfaceGraph, DegenerateFacesAreCounted) {
    Shape shape = Grid(3, 3);
    shape.face.push_back({0, 0, 1});
    shape.face.push_back({4, 4, 4});
    shape.position.push_back(shape.position[0]); // a sliver between welded vertices
    shape.face.push_back({0, 9, 5});
    const SurfaceGraph s = Checked(shape);
    EXPECT_EQ(s.report.degenerateFaces, 3);
    EXPECT_EQ(s.report.welded, 1);
}

TEST(SurfaceGraph, WeldsCoincidentVertices) {
    const Shape grid = Grid(6, 4), soup = UnweldedGrid(6, 4);
    const SurfaceGraph s = Checked(soup), whole = Checked(grid);
    EXPECT_EQ(s.graph.Size(), 24);
    EXPECT_EQ(s.report.welded, soup.Size() - 24);
    EXPECT_TRUE(SameBits(s.graph.position, whole.graph.position));
    EXPECT_EQ(s.graph.adjacency.item, whole.graph.adjacency.item);
    EXPECT_EQ(s.area, whole.area);
}

TEST(SurfaceGraph, WeldsNegativeZero) {
    Shape shape{{{-1, 0.0, -0.0}, {-1, -0.0, 0.0}, {1, 0, 0}, {1, -0.0, -0.0}, {0, 1, 0}, {0, -1, 0}}, {}, {}};
    shape.face = {{0, 2, 4}, {1, 3, 5}};
    EXPECT_EQ(Checked(shape).report.welded, 2);
}

TEST(SurfaceGraph, DoesNotWeldNeighbours) {
    const SurfaceGraph s = Checked(Jittered(Grid(5, 5), 1e-5));
    EXPECT_EQ(s.report.welded, 0);
}

TEST(SurfaceGraph, SkipsDeletedElements) {
    Shape shape = Join(Grid(4, 4), {{{100, 0, 0}, {-100, 0, 0}}, {}, {}});
    shape.edge = {{16, 17}, {0, 16}};
    MeshD mesh(shape);
    mesh.DeleteVertex(17);
    mesh.DeleteEdge(0);
    mesh.DeleteFace(0);
    mesh.DeleteFace(1);
    mesh.DeleteVertex(0);
    mesh.DeleteEdge(1);
    mesh.vert[0].P()[0] = std::numeric_limits<double>::quiet_NaN(); // deleted: not read
    const SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
    ExpectConnectivity(mesh, s);
    EXPECT_EQ(s.graph.Size(), 16);
    EXPECT_EQ(s.report.isolated, 1);
    EXPECT_NEAR(s.area * s.frame.scale * s.frame.scale, 8, 1e-4);
}

TEST(SurfaceGraph, SkipsFacesAndEdgesOfDeletedVertices) {
    Shape shape = Grid(4, 4);
    shape.edge = {{5, 15}};
    MeshD mesh(shape);
    mesh.DeleteVertex(5);
    const SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
    EXPECT_EQ(s.graph.Size(), 15);
    ExpectAdjacencyInOrder(s.graph.adjacency);
    EXPECT_NEAR(s.area * s.frame.scale * s.frame.scale, 6, 1e-4);
}

TEST(SurfaceGraph, MeshWithAllFacesDeletedIsAPointCloud) {
    MeshD mesh(Triangle());
    mesh.DeleteFace(0);
    const SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
    EXPECT_TRUE(s.report.pointCloud);
    EXPECT_EQ(s.graph.adjacency.item.size(), 6u);
}

TEST(SurfaceGraph, TakesEdgesAlone) {
    const SurfaceGraph s = Checked(Wireframe(5, 4));
    EXPECT_FALSE(s.report.pointCloud);
    EXPECT_EQ(s.report.nonManifoldEdges, 0);
    EXPECT_NEAR(s.averageEdge * s.frame.scale, 1, 1e-6);
}

TEST(SurfaceGraph, CountsIsolatedVertices) {
    Shape shape = Triangle();
    shape.position.emplace_back(5, 5, 5);
    shape.position.emplace_back(6, 5, 5);
    EXPECT_EQ(Checked(shape).report.isolated, 2);
}

TEST(SurfaceGraph, PointsAreJoinedWithTheirNearest) {
    const int k = vcg::fcd::detail::cloudNeighbours;
    for (int n : {2, 5, 9, 10, 700}) {
        const MeshD mesh(PointCloud(n));
        const SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
        EXPECT_TRUE(s.report.pointCloud);
        EXPECT_EQ(s.report.nonManifoldEdges, 0);
        ASSERT_EQ(s.graph.Size(), n);
        ExpectAdjacencyInOrder(s.graph.adjacency);
        const Eigen::Matrix3Xf &x = s.graph.position;
        auto sorted = [&](Index u, const std::vector<Index> &nodes) {
            std::vector<float> d;
            for (Index v : nodes)
                d.push_back((x.col(u) - x.col(v)).norm());
            std::sort(d.begin(), d.end());
            return d;
        };
        std::vector<float> farthest(n); // of the k nearest
        for (Index u = 0; u < n; ++u) {
            std::vector<Index> others;
            for (Index v = 0; v < n; ++v)
                if (v != u)
                    others.push_back(v);
            const std::vector<float> all = sorted(u, others);
            const std::vector<float> found = sorted(u, {s.graph.adjacency[u].begin(), s.graph.adjacency[u].end()});
            const int wanted = std::min(k, n - 1);
            ASSERT_GE(int(found.size()), wanted);
            for (int i = 0; i < wanted; ++i)
                ASSERT_NEAR(found[i], all[i], 1e-6f);
            farthest[u] = all[wanted - 1];
        }
        int longer = 0; // for points whose nearest ones lie on two sides only
        for (const auto &e : EdgesOf(s.graph.adjacency))
            longer +=
                (x.col(e.first) - x.col(e.second)).norm() > std::max(farthest[e.first], farthest[e.second]) + 1e-6f;
        EXPECT_LE(longer, n / 100);
    }
}

TEST(SurfaceGraph, PointsAreNeighboursBothWays) {
    for (const Shape &cloud : {PointCloud(20000), Points(Grid(120, 130))}) {
        const SurfaceGraph one = BuildSurfaceGraph(Read(MeshD(cloud)), Threads(1)),
                           three = BuildSurfaceGraph(Read(MeshD(cloud)), Threads(3));
        EXPECT_EQ(one.graph.adjacency.begin, three.graph.adjacency.begin);
        EXPECT_EQ(one.graph.adjacency.item, three.graph.adjacency.item);
        EXPECT_EQ(one.nodeArea, three.nodeArea);
        EXPECT_EQ(one.averageEdge, three.averageEdge);
        ExpectAdjacencyInOrder(one.graph.adjacency); // symmetric, ascending, each once
        double edges = 0;
        for (const auto &e : EdgesOf(one.graph.adjacency))
            edges += (one.graph.position.col(e.first) - one.graph.position.col(e.second)).norm();
        EXPECT_NEAR(one.averageEdge, 2 * edges / double(one.graph.adjacency.item.size()), 1e-6 * one.averageEdge);
    }
}

TEST(SurfaceGraph, TellsOfLinesThatPointsDoNotSeeBeyond) {
    const auto lines = [](int denser) {
        Shape shape;
        for (int line = 0; line < 3; ++line)
            for (int i = 0; i <= 4 * denser; ++i)
                shape.position.emplace_back(double(i) / denser, line, 0);
        return BuildSurfaceGraph(Read(MeshD(shape))).report;
    };
    EXPECT_GT(lines(120).oneSided, 3 * 4 * 120 / 2);
    EXPECT_TRUE(IsInLines(lines(120)));
    for (int denser : {1, 20})
        EXPECT_FALSE(IsInLines(lines(denser))) << denser;
    for (const Shape &cloud : {PointCloud(3000), Points(Grid(50, 60))})
        EXPECT_LE(BuildSurfaceGraph(Read(MeshD(cloud))).report.oneSided, 4) << "the corners";
}

TEST(SurfaceGraph, TakesASinglePoint) {
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(PointCloud(1))));
    EXPECT_EQ(s.graph.Size(), 1);
    EXPECT_EQ(s.report.isolated, 1);
}

TEST(SurfaceGraph, TakesPointsAtOnePlace) {
    const Shape shape{{{3, 4, 5}, {3, 4, 5}, {3, 4, 5}}, {}, {}};
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
    EXPECT_EQ(s.graph.Size(), 1);
    EXPECT_EQ(s.report.welded, 2);
}

TEST(SurfaceGraph, TakesAPointCloudWithDuplicates) {
    const Shape cloud = PointCloud(100);
    const SurfaceGraph twice = BuildSurfaceGraph(Read(MeshD(Join(cloud, cloud)))),
                       once = BuildSurfaceGraph(Read(MeshD(cloud)));
    EXPECT_EQ(twice.report.welded, 100);
    EXPECT_TRUE(SameBits(twice.graph.position, once.graph.position));
    EXPECT_EQ(twice.graph.adjacency.item, once.graph.adjacency.item);
}

/// Two grids of 6 x 5 vertices, the second one \p gap beyond the first along x.
static Shape TwoGrids(double gap) {
    const Shape grid = Grid(6, 5);
    return Join(grid, Moved(grid, Eigen::Affine3d(Eigen::Translation3d(5 + gap, 0, 0))));
}

TEST(SurfaceGraph, JoinsBordersAHairApart) {
    const SurfaceGraph exact = BuildSurfaceGraph(Read(MeshD(TwoGrids(0))));
    EXPECT_EQ(exact.report.seams, 0);
    EXPECT_EQ(exact.report.welded, 5);
    for (double gap : {1e-12, 1e-9, 1e-7, 5e-7}) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(TwoGrids(gap * exact.frame.scale))));
        EXPECT_EQ(s.report.welded + s.report.seams, 5) << gap;
        EXPECT_EQ(s.report.gaps, 0);
        EXPECT_EQ(VertexEdges(s), VertexEdges(exact));
        EXPECT_NEAR(s.area, exact.area, 1e-5);
        EXPECT_EQ(s.graph.Size(), exact.graph.Size());
    }
    for (double gap : {3e-6, 1e-3}) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(TwoGrids(gap * exact.frame.scale))));
        EXPECT_EQ(s.report.welded + s.report.seams, 0) << gap;
        EXPECT_EQ(s.report.gaps, 10);
    }
    const auto seamsWith = [&](double gap, double weldDistance) {
        const MeshD mesh(TwoGrids(gap * exact.frame.scale));
        return BuildSurfaceGraph(Read(mesh), nullptr, {}, Eigen::Matrix3d::Identity(), {}, weldDistance).report.seams;
    };
    EXPECT_EQ(seamsWith(5e-7, 0), 0);
    EXPECT_EQ(seamsWith(3e-6, 6e-6), 5);
    EXPECT_EQ(seamsWith(5e-4, 1e-3), 5);
    EXPECT_EQ(BuildSurfaceGraph(Read(MeshD(TwoGrids(0.5)))).report.gaps, 0) << "half an edge is no slit";
}

TEST(SurfaceGraph, JoinsLongTrianglesAHairApart) {
    // Each corner at the end of two long edges, with many others within a tenth of these: all pairs were too many.
    const int segments = sanitized ? 2000 : 20000;
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Jittered(Unwelded(Tube(3, segments)), 1e-7))));
    EXPECT_EQ(s.graph.Size(), 3 * segments);
    EXPECT_EQ(s.report.welded + s.report.seams, 9 * segments);
    EXPECT_EQ(s.report.gaps, 0);
}

TEST(SurfaceGraph, DoesNotJoinWhatIsNoBorder) {
    // Two nearly coincident closed surfaces.
    const Shape sphere = Sphere(8, 12);
    const SurfaceGraph s =
        BuildSurfaceGraph(Read(MeshD(Join(sphere, Moved(sphere, Eigen::Affine3d(Eigen::Scaling(1 + 1e-6)))))));
    EXPECT_EQ(s.report.seams, 0);
    EXPECT_EQ(s.report.components, 0);
    EXPECT_EQ(s.graph.Size(), 2 * BuildSurfaceGraph(Read(MeshD(sphere))).graph.Size());
}

TEST(SurfaceGraph, WeldsWhereRangesOfVerticesMeet) {
    const Shape grid = Grid(150, 150); // most positions have six corners, and 65536 is no multiple of that
    const SurfaceGraph welded = BuildSurfaceGraph(Read(MeshD(grid))),
                       soup = BuildSurfaceGraph(Read(MeshD(Unwelded(grid))));
    EXPECT_TRUE(SameBits(soup.graph.position, welded.graph.position));
    EXPECT_EQ(soup.graph.adjacency.begin, welded.graph.adjacency.begin);
    EXPECT_EQ(soup.graph.adjacency.item, welded.graph.adjacency.item);
}

TEST(SurfaceGraph, RefusesAMeshWithoutVertices) {
    EXPECT_EQ(MessageOf<Error>([] { BuildSurfaceGraph(Read(MeshD())); }), "The mesh has no vertices.");
    MeshD mesh(Points(Triangle()));
    for (int i = 0; i < 3; ++i)
        mesh.DeleteVertex(i);
    EXPECT_EQ(MessageOf<Error>([&] { BuildSurfaceGraph(Read(mesh)); }), "The mesh has no vertices.");
}

TEST(SurfaceGraph, RefusesNonFiniteCoordinatesByName) {
    const double inf = std::numeric_limits<double>::infinity();
    for (double bad : {inf, -inf, std::numeric_limits<double>::quiet_NaN()})
        for (int vertex : {0, 5, 11})
            for (int d = 0; d < 3; ++d) {
                Shape shape = Grid(4, 3);
                shape.position[vertex][d] = bad;
                const std::string message = MessageOf<Error>([&] { BuildSurfaceGraph(Read(MeshD(shape))); });
                EXPECT_NE(message.find("Vertex " + std::to_string(vertex) + " "), std::string::npos) << message;
            }
}

TEST(SurfaceGraph, DoesNotDependOnScaleAndPlace) {
    const Shape shape = Join(UnweldedGrid(9, 7), Moved(Tube(5, 8), Eigen::Affine3d(Eigen::Translation3d(20, 0, 0))));
    const EdgeSet edges = VertexEdges(Checked(shape));
    for (double scale : {1e-30, 1e-3, 3.0, 1e30, 1e150})
        EXPECT_EQ(VertexEdges(BuildSurfaceGraph(Read(MeshD(Moved(shape, Eigen::Affine3d(Eigen::Scaling(scale))))))),
                  edges)
            << scale;
    EXPECT_EQ(VertexEdges(BuildSurfaceGraph(
                  Read(MeshD(Moved(shape, Eigen::Affine3d(Eigen::Translation3d(1e7, -2e7, 1.5e7))))))),
              edges);
    const MeshF small(Moved(shape, Eigen::Affine3d(Eigen::Scaling(1e-30)))),
        large(Moved(shape, Eigen::Affine3d(Eigen::Scaling(1e30))));
    EXPECT_EQ(VertexEdges(BuildSurfaceGraph(Read(small))), edges);
    EXPECT_EQ(VertexEdges(BuildSurfaceGraph(Read(large))), edges);
}

TEST(SurfaceGraph, TakesLargeNumbers) {
    const double most = 1e307;
    const Shape shape{{{-most, 0, 0}, {most, 0, 0}, {0, most, most}}, {{0, 1, 2}}, {}};
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
    EXPECT_EQ(s.graph.Size(), 3);
    EXPECT_TRUE(s.graph.position.allFinite());
    EXPECT_TRUE(std::isfinite(s.frame.scale));
}

TEST(SurfaceGraph, ScalingByAPowerOfTwoChangesNoBit) {
    const Shape shape = Jittered(Tube(6, 9), 0.1);
    const SurfaceGraph s = Checked(shape);
    for (int k : {-40, -1, 3, 50}) {
        const SurfaceGraph t =
            BuildSurfaceGraph(Read(MeshD(Moved(shape, Eigen::Affine3d(Eigen::Scaling(std::ldexp(1.0, k)))))));
        ExpectSameBits(s, t);
        EXPECT_EQ(t.frame.scale, std::ldexp(s.frame.scale, k));
    }
}

TEST(SurfaceGraph, FrameIsAUnitBoxAroundTheOrigin) {
    for (double size : {1e-20, 0.7, 1.0, 1e9}) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Moved(Tube(5, 9), Eigen::Affine3d(Eigen::Scaling(size))))));
        const Eigen::Vector3f lo = s.graph.position.rowwise().minCoeff(), hi = s.graph.position.rowwise().maxCoeff();
        EXPECT_NEAR((hi - lo).norm(), 1, 1e-6);
        EXPECT_LE((lo + hi).norm(), 1e-6);
    }
}

TEST(SurfaceGraph, FrameAndBack) {
    const SurfaceGraph s = Checked(Tube(5, 9));
    std::mt19937 random(1);
    for (int i = 0; i < 20; ++i) {
        const Eigen::Affine3d motion = RandomRigid(i);
        const Eigen::Vector3d p = RandomVector(random);
        EXPECT_TRUE(s.frame.FromFrame(s.frame.ToFrame(p)).isApprox(p, 1e-14));
        const Eigen::Vector3d through = s.frame.FromFrame(s.frame.ToFrame(motion.matrix()) * s.frame.ToFrame(p));
        EXPECT_LE((through - motion * p).norm(), 1e-13);
    }
}

TEST(SurfaceGraph, NodesAreInMortonOrder) {
    for (const Shape &shape : {Grid(40, 30), PointCloud(2000), UnweldedGrid(20, 20)}) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
        std::vector<std::uint32_t> code;
        for (Index u = 0; u < s.graph.Size(); ++u)
            code.push_back(
                vcg::fcd::detail::MortonCode(s.graph.position(0, u), s.graph.position(1, u), s.graph.position(2, u)));
        EXPECT_TRUE(std::is_sorted(code.begin(), code.end()));
    }
}

TEST(SurfaceGraph, DoesNotDependOnTheThreads) {
    for (const Shape &shape : {Jittered(Grid(200, 190), 0.3), Unwelded(Tube(70, 60)), PointCloud(5000)}) {
        const MeshD mesh(shape);
        const SurfaceGraph s = BuildSurfaceGraph(Read(mesh), Threads(1));
        for (unsigned threads : Rounds({7u, 2u}))
            ExpectSameBits(s, BuildSurfaceGraph(Read(mesh), Threads(threads)));
    }
}

TEST(SurfaceGraph, AreaAndAverageEdgeAreThoseOfTheMesh) {
    const Shape shape = Jittered(Grid(50, 40), 0.3);
    const SurfaceGraph s = Checked(shape);
    double area = 0, length = 0;
    for (const auto &f : shape.face)
        area += 0.5 *
                (shape.position[f[1]] - shape.position[f[0]]).cross(shape.position[f[2]] - shape.position[f[0]]).norm();
    const EdgeSet edges = VertexEdges(s);
    for (const auto &e : edges)
        length += (shape.position[e.first] - shape.position[e.second]).norm();
    EXPECT_NEAR(s.area * s.frame.scale * s.frame.scale, area, 1e-5 * area);
    EXPECT_NEAR(s.averageEdge * s.frame.scale, length / double(edges.size()), 1e-5);
}

TEST(SurfaceGraph, ANodesAreaIsAThirdOfItsFaces) {
    for (const Shape &shape : {Jittered(Grid(50, 40), 0.3), Unwelded(Jittered(Tube(20, 16), 0.02)), Fan(40)}) {
        const SurfaceGraph s = Checked(shape);
        std::vector<double> area(s.graph.Size(), 0);
        double sum = 0;
        for (const auto &f : shape.face) {
            const Eigen::Vector3d &x = shape.position[f[0]];
            const double third = (shape.position[f[1]] - x).cross(shape.position[f[2]] - x).norm() / 6;
            for (int c : f)
                area[s.nodeOf[c]] += third;
        }
        ASSERT_EQ(Index(s.nodeArea.size()), s.graph.Size());
        const double unit = s.frame.scale * s.frame.scale;
        for (Index u = 0; u < s.graph.Size(); ++u) {
            EXPECT_NEAR(s.nodeArea[u] * unit, area[u], 1e-5 * (area[u] + 1e-3));
            sum += s.nodeArea[u];
        }
        EXPECT_NEAR(s.area, sum, 1e-9);
    }
}

/// \p n random points on a unit sphere.
static Shape SphereCloud(int n) {
    std::mt19937 random(5);
    Shape s;
    for (int i = 0; i < n; ++i)
        s.position.push_back(RandomVector(random).normalized());
    return s;
}

TEST(SurfaceGraph, AreaOfPointsIsThatOfTheirSurface) {
    const auto area = [](const Shape &shape) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
        return s.area * s.frame.scale * s.frame.scale;
    };
    const double sphere = 4 * std::acos(-1.0);
    for (int n : {1000, 4000, 16000})
        EXPECT_NEAR(area(SphereCloud(n)) / sphere, 1, 0.1) << n << " points";
    EXPECT_NEAR(area(SphereCloud(16000)) / area(SphereCloud(1000)), 1, 0.05) << "does not depend on the density";
    EXPECT_NEAR(area(Points(Grid(30, 30))) / (29 * 29), 1, 0.3);
    EXPECT_NEAR(area(Points(Jittered(Grid(100, 100, 0.1), 0.03))) / (9.9 * 9.9), 1, 0.2);
}

TEST(SurfaceGraph, DensePartsOfACloudDoNotCountMore) {
    // The left half of a sheet has nine times as many points.
    Shape shape;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit;
    for (int i = 0; i < 10000; ++i) {
        const double x = unit(random), y = unit(random);
        shape.position.emplace_back(i % 10 ? x : x + 1, y, 0);
    }
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
    double half[2] = {0, 0};
    for (int i = 0; i < shape.Size(); ++i)
        half[shape.position[i][0] >= 1] += s.nodeArea[s.nodeOf[i]] * s.frame.scale * s.frame.scale;
    EXPECT_NEAR(half[0], 1, 0.15);
    EXPECT_NEAR(half[1], 1, 0.15);
}

TEST(SurfaceGraph, PointsAtOnePlaceOrAHairFromItAreOne) {
    const Shape sheet = Points(Jittered(Grid(20, 20), 0.3));
    const SurfaceGraph once = BuildSurfaceGraph(Read(MeshD(sheet)));
    std::mt19937 random(2);
    for (int times : Rounds({8, 2, 30}))
        for (double jitter : Rounds({2e-5, 0.0, 1e-6, 1e-4})) { // the sheet's diagonal is 27
            Shape many;
            for (int i = 0; i < times * sheet.Size(); ++i)
                many.position.push_back(sheet.position[i / times] + (i % times ? jitter : 0) * RandomVector(random));
            const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(many)));
            ASSERT_EQ(s.graph.Size(), once.graph.Size()) << times << " times, jitter " << jitter;
            EXPECT_EQ(s.report.welded, many.Size() - sheet.Size());
            for (int i = 0; i < many.Size(); ++i)
                ASSERT_EQ(s.nodeOf[i], s.nodeOf[i / times * times]);
            EXPECT_NEAR(s.area, once.area, 1e-3 * once.area);
        }
}

TEST(SurfaceGraph, ScanLinesAreASurface) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (double jitter : {0.0, 0.3})
        for (int dense : Rounds({10, 1, 3, 5, 7, 20, 30})) {
            Shape lines;
            for (int y = 0; y < 12; ++y)
                for (int x = 0; x <= 11 * dense; ++x)
                    lines.position.emplace_back(double(x) / dense + jitter * unit(random) / dense, y, 0);
            const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(lines)));
            std::vector<Index> componentOf;
            EXPECT_EQ(ConnectedComponents(s.graph.adjacency, componentOf), 1) << dense;
            // Each inner point has neighbours on its line and on both next ones, and its share of the area.
            for (int y = 2; y < 10; ++y)
                for (int x = 2 * dense; x <= 9 * dense; ++x) {
                    const Index u = s.nodeOf[y * (11 * dense + 1) + x];
                    bool has[3] = {};
                    for (Index v : s.graph.adjacency[u]) {
                        const double across = double(s.graph.position(1, v) - s.graph.position(1, u)) * s.frame.scale;
                        ASSERT_LE(std::abs(across), dense > 2 ? 1.01 : 2.5);
                        has[1 + int(std::lround(std::min(1.0, std::max(-1.0, across))))] = true;
                    }
                    EXPECT_TRUE(has[0] && has[1] && has[2]) << dense << ": " << x << ", " << y;
                    EXPECT_NEAR(s.nodeArea[u] * s.frame.scale * s.frame.scale * dense, 1, 0.5);
                }
        }
}

TEST(SurfaceGraph, AFewStrayVerticesDoNotCoarsenTheFrame) {
    const Shape shape = Jittered(Tube(30, 20), 0.02);
    const SurfaceGraph s = Checked(shape);
    const EdgeSet edges = VertexEdges(s);
    for (double far : {1e3, 1e6, 1e9, 1e30}) {
        Shape with = shape;
        with.position.emplace_back(far, 0, -far);
        const SurfaceGraph t = BuildSurfaceGraph(Read(MeshD(with)));
        EXPECT_EQ(VertexEdges(t), edges) << far;
        EXPECT_EQ(t.report.welded, 0);
        EXPECT_EQ(t.report.isolated, 1);
        EXPECT_LE(t.frame.scale, 8 * s.frame.scale);
        EXPECT_TRUE(t.graph.position.allFinite());
        EXPECT_NEAR(t.area * t.frame.scale * t.frame.scale, s.area * s.frame.scale * s.frame.scale, 1e-3);
    }
}

/// A mesh with free and held vertices, and its graph.
template <class Mesh>
static SurfaceGraph RegionOf(const Mesh &mesh, const std::vector<int> &tag, unsigned threads = 0) {
    const Region region = FreeRegion(Read(mesh), tag, Eigen::Matrix3d::Identity(), Threads(threads));
    return BuildSurfaceGraph(Read(mesh), &region, tag, Eigen::Matrix3d::Identity(), Threads(threads));
}

TEST(SurfaceGraphOfARegion, OfAllFreeIsThatOfTheMesh) {
    for (const Shape &shape : {Jittered(Grid(30, 20), 0.3), Unwelded(Tube(20, 16)), PointCloud(500), Wireframe(9, 7)}) {
        const MeshD mesh(shape);
        const SurfaceGraph s = RegionOf(mesh, std::vector<int>(shape.position.size(), 1));
        ExpectSameBits(s, BuildSurfaceGraph(Read(mesh)));
        EXPECT_EQ(s.tag, std::vector<Index>(s.graph.Size(), 1));
    }
}

TEST(SurfaceGraphOfARegion, HasTheEdgesOfFacesThatMayDeform) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Shape shape = seed % 2 ? Jittered(Grid(40, 30), 0.3, seed) : Jittered(Sphere(20, 24), 0.02, seed);
        std::vector<int> tag;
        for (Index t : RandomGroups(shape.Size(), 5 + 3 * seed, seed))
            tag.push_back(int(std::min(t, 3)) - 1);
        const MeshD mesh(shape);
        const SurfaceGraph s = RegionOf(mesh, tag);
        EdgeSet expected;
        std::set<Index> part;
        double area = 0;
        for (const auto &f : shape.face)
            if (tag[f[0]] == 1 || tag[f[1]] == 1 || tag[f[2]] == 1) {
                for (int c = 0; c < 3; ++c)
                    Insert(expected, f[c], f[(c + 1) % 3]);
                part.insert(f.begin(), f.end());
                const Eigen::Vector3d &x = shape.position[f[0]];
                area += 0.5 * (shape.position[f[1]] - x).cross(shape.position[f[2]] - x).norm();
            }
        EXPECT_EQ(VertexEdges(s), expected);
        ExpectAdjacencyInOrder(s.graph.adjacency);
        EXPECT_NEAR(s.area * s.frame.scale * s.frame.scale, area, 1e-4 * area);
        EXPECT_EQ(s.report.vertices, Index(part.size()));
        EXPECT_EQ(s.report.welded, 0);
        for (int i = 0; i < shape.Size(); ++i) {
            ASSERT_EQ(s.nodeOf[i] >= 0, part.count(i) == 1) << i;
            if (s.nodeOf[i] < 0)
                continue;
            EXPECT_EQ(s.tag[s.nodeOf[i]], std::max(0, tag[i]));
            EXPECT_EQ(s.IsHeld(s.nodeOf[i]), tag[i] != 1);
            const Eigen::Vector3d node = s.graph.position.col(s.nodeOf[i]).cast<double>();
            EXPECT_LE((s.frame.FromFrame(node) - shape.position[i]).norm(), 1e-6 * s.frame.scale);
        }
    }
}

TEST(SurfaceGraphOfARegion, HeldBeatsFreeAndFixedBeatsAHandle) {
    const std::vector<std::pair<std::vector<int>, int>> cases{
        {{1, 1}, 1},  {{1, 2}, 2}, {{2, 1}, 2}, {{0, 1}, 0},  {{1, 0}, 0},    {{2, 0}, 0}, {{0, 2}, 0},   {{1, -1}, 0},
        {{-3, 2}, 0}, {{3, 2}, 2}, {{2, 3}, 2}, {{-1, 0}, 0}, {{1, 3, 2}, 2}, {{5}, 5},    {{3, 1, 0}, 0}};
    for (const auto &c : cases)
        for (bool faces : {false, true}) { // of more vertices: held and far from free ones
            Shape shape = Triangle();      // whose first vertex is there several times
            std::vector<int> tag{c.first[0], 1, 7};
            for (std::size_t i = 1; i < c.first.size(); ++i) {
                const int n = shape.Size();
                shape.position.push_back(shape.position[0]);
                tag.push_back(c.first[i]);
                if (faces) {
                    shape.position.emplace_back(-1, -double(i), 0);
                    shape.position.emplace_back(-2, -double(i), 0);
                    tag.insert(tag.end(), {0, 0});
                    shape.face.push_back({n, n + 1, n + 2});
                }
            }
            const SurfaceGraph s = RegionOf(MeshD(shape), tag);
            EXPECT_EQ(s.tag[s.nodeOf[0]], c.second) << c.first[0] << ", " << c.first.back();
            EXPECT_EQ(s.tag[s.nodeOf[1]], 1);
            EXPECT_EQ(s.tag[s.nodeOf[2]], 7);
        }
}

TEST(SurfaceGraphOfARegion, DeletedVerticesHaveNoSay) {
    MeshD mesh(Join(Points(Triangle()), Points(Triangle())));
    mesh.DeleteVertex(0);
    const SurfaceGraph s = RegionOf(mesh, {0, 1, 1, 2, 1, 1});
    EXPECT_EQ(s.tag[s.nodeOf[3]], 2);
}

TEST(SurfaceGraphOfARegion, HoldsASoupWhereOneOfTheVerticesIsHeld) {
    // A tag for each face: vertices at one position differ. Held ones there are found, though they share no face with
    // free ones.
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const Shape whole = Jittered(Grid(60, 50), 0.3), soup = Unwelded(whole);
        std::vector<int> tag, expected(whole.position.size(), std::numeric_limits<int>::max());
        std::vector<char> isFree(whole.position.size(), 0);
        const std::vector<Index> ofFace = RandomGroups(Index(whole.face.size()), 4, seed);
        for (std::size_t f = 0; f < whole.face.size(); ++f)
            for (int c : whole.face[f]) {
                const int t = ofFace[f] == 3 ? -1 : int(ofFace[f]);
                tag.push_back(t);
                if (t == 1)
                    isFree[c] = 1;
                else
                    expected[c] = std::min(expected[c], std::max(0, t));
            }
        const SurfaceGraph s = RegionOf(MeshD(soup), tag);
        std::vector<Index> nodeOf(whole.position.size(), -1);
        Index found = 0;
        for (std::size_t f = 0; f < whole.face.size(); ++f)
            for (int c = 0; c < 3; ++c) {
                const int at = whole.face[f][c];
                const Index node = s.nodeOf[3 * f + c];
                ASSERT_EQ(node >= 0, isFree[at] != 0) << "a place with a free vertex is part of it, with all of them";
                if (node < 0)
                    continue;
                found += nodeOf[at] < 0;
                nodeOf[at] = nodeOf[at] < 0 ? node : nodeOf[at];
                ASSERT_EQ(node, nodeOf[at]);
                EXPECT_EQ(s.tag[node], expected[at] == std::numeric_limits<int>::max() ? 1 : expected[at]);
            }
        EXPECT_EQ(found, s.graph.Size());
    }
}

TEST(SurfaceGraphOfARegion, VerticesAtTheSamePlaceAgreeThoughNoneIsFree) {
    // A handle's vertices beside free surface, and fixed ones at the same positions without a common face.
    const int n = 60;
    Shape shape = Grid(n, n);
    std::vector<int> tag = TagsOf(shape, [](const Eigen::Vector3d &p) { return p[0] < 29.5 ? 2 : 1; });
    const int first = shape.Size();
    shape = Join(shape, Grid(n, n));
    for (int i = 0; i < n * n; ++i)
        tag.push_back(shape.position[i][0] < 29.5 ? 0 : shape.position[i][0] < 31.5 ? 2 : 1);
    shape.face.erase(
        std::remove_if(shape.face.begin(), shape.face.end(),
                       [&](const auto &f) { // of the second sheet: none that is free and not
                           return f[0] >= first && std::set<int>{tag[f[0]], tag[f[1]], tag[f[2]]}.size() > 1;
                       }),
        shape.face.end());
    const SurfaceGraph s = RegionOf(MeshD(shape), tag);
    for (int i = 0; i < n * n; ++i)
        if (s.nodeOf[i] >= 0) {
            EXPECT_EQ(s.nodeOf[first + i], s.nodeOf[i]) << i;
            EXPECT_EQ(s.tag[s.nodeOf[i]], tag[first + i] == 0 ? 0 : std::max(tag[i], tag[first + i]));
        }
}

TEST(SurfaceGraphOfARegion, WhatIsOutsideChangesNoBit) {
    const Shape shape = Jittered(Tube(40, 24), 0.02);
    const std::vector<int> tag = TagsOf(shape, [](const Eigen::Vector3d &p) { return TubeTag(p); });
    const SurfaceGraph s = RegionOf(MeshD(shape), tag);
    for (double far : {3.0, 1e4, 1e9})
        for (int outside : {0, -1}) {
            const Shape other = Moved(shape, Eigen::Affine3d(Eigen::Translation3d(far, -far, 0)));
            const Shape around = Join(other, Join(shape, other));
            std::vector<int> tags(shape.position.size(), outside);
            tags.insert(tags.end(), tag.begin(), tag.end());
            tags.resize(around.position.size(), outside);
            SurfaceGraph t = RegionOf(MeshD(around), tags);
            const auto begin = t.nodeOf.begin() + shape.Size();
            EXPECT_EQ(std::count(t.nodeOf.begin(), begin, -1), shape.Size());
            t.nodeOf = std::vector<Index>(begin, begin + shape.Size());
            ExpectSameBits(t, s);
            EXPECT_EQ(t.tag, s.tag);
            EXPECT_TRUE(SameBits(t.frame.origin, s.frame.origin));
            EXPECT_EQ(t.frame.scale, s.frame.scale);
        }
}

TEST(SurfaceGraphOfARegion, OfNothingFreeIsEmpty) {
    for (const Shape &shape : {Grid(5, 5), Points(Grid(5, 5))}) {
        const SurfaceGraph s = RegionOf(MeshD(shape), std::vector<int>(25, 0));
        EXPECT_EQ(s.graph.Size(), 0);
        EXPECT_EQ(s.nodeOf, std::vector<Index>(25, -1));
    }
}

TEST(SurfaceGraphOfARegion, DoesNotDependOnTheThreads) {
    for (const Shape &shape : {Unwelded(Jittered(Grid(200, 190), 0.3)), PointCloud(5000)}) {
        const MeshD mesh(shape);
        std::vector<int> tag;
        for (Index t : RandomGroups(shape.Size(), 5, 3))
            tag.push_back(int(std::min(t, 2)));
        const SurfaceGraph s = RegionOf(mesh, tag, 1);
        for (unsigned threads : Rounds({7u, 2u})) {
            const SurfaceGraph t = RegionOf(mesh, tag, threads);
            ExpectSameBits(s, t);
            EXPECT_EQ(s.tag, t.tag);
        }
    }
}

TEST(SurfaceGraphOfARegion, IsHeldByWhatIsAHairAway) {
    // The second grid is held: the first one is joined to its border, and other held vertices change nothing.
    for (double gap : {0.0, 1e-8, 3e-6, 1e-5}) { // the diagonal is 6.4: the last is beyond the weld distance
        const Shape shape = TwoGrids(gap);
        const auto tags = [](int n) {
            std::vector<int> tag(n, 0);
            std::fill(tag.begin(), tag.begin() + 30, 1);
            return tag;
        };
        const SurfaceGraph s = RegionOf(MeshD(shape), tags(shape.Size()));
        const bool isJoined = gap < 6e-6;
        EXPECT_EQ(std::count(s.tag.begin(), s.tag.end(), 0), isJoined ? 5 : 0) << gap;
        EXPECT_EQ(s.graph.Size(), 30);
        EXPECT_EQ(s.report.welded + s.report.seams, isJoined ? 5 : 0);
        for (int i = 30; i < shape.Size(); ++i)
            EXPECT_EQ(s.nodeOf[i] >= 0, isJoined && shape.position[i][0] < 5.5);
        // Held vertices near the free surface, but not at its border, and far ones.
        Shape with = Join(shape, Moved(Grid(9, 9), Eigen::Affine3d(Eigen::Translation3d(0.3, 0, 1e-5))));
        with = Join(with, Moved(Grid(9, 9), Eigen::Affine3d(Eigen::Translation3d(100, 0, 0))));
        SurfaceGraph t = RegionOf(MeshD(with), tags(with.Size()));
        t.nodeOf.resize(s.nodeOf.size());
        ExpectSameBits(s, t);
    }
}

TEST(SurfaceGraphOfARegion, CanBeCancelledAnywhere) {
    for (const Shape &shape : {Unwelded(Grid(6, 6)), PointCloud(50)}) {
        const MeshD mesh(shape);
        std::vector<int> tag;
        for (Index t : RandomGroups(shape.Size(), 3, 3))
            tag.push_back(int(t));
        const auto read = [&](const CallbackLog &log) {
            const Progress progress = log.Progress(1);
            const Region region = FreeRegion(Read(mesh), tag, Eigen::Matrix3d::Identity(), progress.Slice(0, 0.2));
            BuildSurfaceGraph(Read(mesh), &region, tag, Eigen::Matrix3d::Identity(), progress.Slice(0.2, 1));
        };
        CallbackLog all;
        read(all);
        EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
        const std::size_t calls = all.percent.size();
        for (std::size_t i = 0; i < calls; ++i) {
            CallbackLog log(i);
            EXPECT_THROW(read(log), Cancelled);
        }
    }
}

TEST(SurfaceGraph, ReadsFloatMeshesAlike) {
    const Shape shape = UnweldedGrid(7, 6); // coordinates that float holds
    ExpectSameBits(BuildSurfaceGraph(Read(MeshF(shape))), BuildSurfaceGraph(Read(MeshD(shape))));
}

TEST(SurfaceGraph, CanBeCancelledAnywhere) {
    for (const Shape &shape : {Grid(5, 5), PointCloud(50)}) {
        const MeshD mesh(shape);
        CallbackLog all;
        BuildSurfaceGraph(Read(mesh), all.Progress(1));
        EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
        const std::size_t calls = all.percent.size();
        for (std::size_t i = 0; i < calls; ++i) {
            CallbackLog log(i);
            EXPECT_THROW(BuildSurfaceGraph(Read(mesh), log.Progress(1)), Cancelled);
        }
    }
}
