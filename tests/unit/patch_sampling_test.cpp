// SPDX-License-Identifier: GPL-3.0-or-later
#include "../plain_sampling.h"
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using vcg::tri::BuildSurfaceGraph;

static SurfaceGraph SurfaceOf(const Shape &shape) { return BuildSurfaceGraph(MeshD(shape)); }

static double Distance(const Graph &g, Index a, Index b) {
    return (g.position.col(a) - g.position.col(b)).cast<double>().norm();
}

static bool SameTag(const std::vector<Index> &tag, Index a, Index b) { return tag.empty() || tag[a] == tag[b]; }

/// Every node in one patch; patches not empty, connected, of one tag; radius and cost as documented.
static void ExpectPartition(const Graph &g, const std::vector<Index> &tag, const Patches &p) {
    const Index k = p.Size();
    ASSERT_EQ(Index(p.patchOf.size()), g.Size());
    ASSERT_EQ(Index(p.radius.size()), k);
    for (Index u = 0; u < g.Size(); ++u) {
        ASSERT_GE(p.patchOf[u], 0);
        ASSERT_LT(p.patchOf[u], k);
    }
    for (Index j = 0; j < k; ++j)
        ASSERT_EQ(p.patchOf[p.center[j]], j) << "a centre is not in its patch";
    UnionFind parts = ComponentsWhere(g.adjacency, [&](Index u, Index v) { return p.patchOf[u] == p.patchOf[v]; });
    std::vector<double> radius(k, 0);
    double cost = 0;
    for (Index u = 0; u < g.Size(); ++u) {
        const Index c = p.center[p.patchOf[u]];
        ASSERT_EQ(parts.Root(u), parts.Root(c)) << "a patch is not connected";
        ASSERT_TRUE(SameTag(tag, u, c)) << "a patch has two tags";
        const double d = Distance(g, u, c);
        radius[p.patchOf[u]] = std::max(radius[p.patchOf[u]], d);
        cost += d * d;
    }
    for (Index j = 0; j < k; ++j)
        ASSERT_NEAR(p.radius[j], radius[j], 1e-6);
    EXPECT_NEAR(p.cost, cost, 1e-5 * cost);
}

/// What holds in addition when the iteration has converged.
static void ExpectConverged(const Graph &g, const std::vector<Index> &tag, const Patches &p, double D) {
    ExpectPartition(g, tag, p);
    ASSERT_TRUE(p.converged);
    const Csr members = GroupMembers(p.patchOf, p.Size());
    for (Index j = 0; j < p.Size(); ++j) {
        if (members[j].size() > 1) {
            EXPECT_LE(p.radius[j], D * (1 + 1e-6));
        }
        Eigen::Vector3d barycenter = Eigen::Vector3d::Zero();
        for (Index u : members[j])
            barycenter += g.position.col(u).cast<double>() / double(members[j].size());
        auto off = [&](Index u) { return (g.position.col(u).cast<double>() - barycenter).norm(); };
        double nearest = off(p.center[j]);
        for (Index u : members[j])
            nearest = std::min(nearest, off(u));
        EXPECT_NEAR(off(p.center[j]), nearest, 1e-6);
    }
}

static PatchParam Param(double D, int initialPatches = 20) {
    PatchParam param;
    param.targetRadius = D;
    param.initialPatches = initialPatches;
    return param;
}

TEST(RandomSample, IsDistinctAscendingAndInRange) {
    for (Index n : {1, 2, 10, 1000})
        for (Index count : {1, 5, 300, 2000})
            for (unsigned seed = 0; seed < 5; ++seed) {
                const std::vector<Index> s = vcg::fcd::detail::RandomSample(n, count, seed);
                ASSERT_EQ(Index(s.size()), std::min(n, count));
                for (std::size_t i = 0; i < s.size(); ++i) {
                    ASSERT_GE(s[i], 0);
                    ASSERT_LT(s[i], n);
                    ASSERT_TRUE(i == 0 || s[i - 1] < s[i]);
                }
            }
}

TEST(RandomSample, LeavesNoGap) {
    const std::vector<Index> s = vcg::fcd::detail::RandomSample(10000, 100, 1);
    for (std::size_t i = 0; i < s.size(); ++i)
        EXPECT_EQ(s[i] / 100, Index(i));
}

TEST(RandomSample, DependsOnTheSeedAlone) {
    using vcg::fcd::detail::RandomSample;
    EXPECT_EQ(RandomSample(1000, 50, 3), RandomSample(1000, 50, 3));
    EXPECT_NE(RandomSample(1000, 50, 3), RandomSample(1000, 50, 4));
}

TEST(SamplePatches, PartitionsMiniatureMeshes) {
    for (const Shape &shape : {Triangle(), Quad(), Grid(20, 20), Strip(50), Tube(20, 12), Sphere(12, 20), Fan3(),
                               Fan(200), TwoSheets(12, 0.2), UnweldedGrid(12, 9), Wireframe(12, 9), PointCloud(500)})
        for (double D : {0.01, 0.1, 0.4}) {
            const SurfaceGraph s = SurfaceOf(shape);
            PatchParam param = Param(D);
            param.maxIterations = 1000; // a star is split once an iteration
            ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, param), D);
        }
}

TEST(SamplePatches, DoesNotCrossTags) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const SurfaceGraph s = SurfaceOf(Jittered(Grid(25, 25), 0.3, seed));
        const std::vector<Index> halves =
            TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] + p[1] < 20 ? 1 : 2; });
        ExpectConverged(s.graph, halves, SamplePatches(s.graph, halves, Param(0.15)), 0.15);
        const std::vector<Index> random = RandomGroups(s.graph.Size(), 3, seed); // many tiny parts
        ExpectConverged(s.graph, random, SamplePatches(s.graph, random, Param(0.15)), 0.15);
    }
}

TEST(SamplePatches, LeavesNoPatchEmptyOnIrregularGraphs) {
    for (unsigned seed = 1; seed <= 60; ++seed) {
        SurfaceGraph s = SurfaceOf(PointCloud(10 + 10 * (seed % 12), seed));
        s.graph.adjacency = RandomGraph(s.graph.Size(), s.graph.Size(), seed); // edges of any length
        const double D = 0.05 * (1 + seed % 5);
        SCOPED_TRACE(seed);
        ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, Param(D, 1 + seed % 4)), D);
    }
}

TEST(SamplePatches, AnyNumberOfIterationsGivesAPartition) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(30, 30), 0.3));
    for (int iterations : {1, 2, 3, 5}) {
        PatchParam param = Param(0.05, 3);
        param.maxIterations = iterations;
        const Patches p = SamplePatches(s.graph, {}, param);
        EXPECT_LE(p.iterations, iterations);
        SCOPED_TRACE(iterations);
        ExpectPartition(s.graph, {}, p);
    }
}

TEST(SamplePatches, RelaxesEvenWherePatchesAreSmallEnoughFromTheStart) {
    const SurfaceGraph s = SurfaceOf(Grid(40, 40));
    const Patches p = SamplePatches(s.graph, {}, Param(10, 30));
    ExpectConverged(s.graph, {}, p, 10);
    EXPECT_EQ(p.Size(), 30);
    EXPECT_GT(p.iterations, 2);
    // 30 square patches of a unit-diagonal square: k * side^4 / 6 per area, times the number of nodes.
    const double side = s.diagonal / std::sqrt(2.0), ideal = 1600 * side * side / 30 / 6;
    EXPECT_LT(p.cost, 1.25 * ideal);
}

TEST(SamplePatches, TakesMoreSeedsThanNodes) {
    const SurfaceGraph s = SurfaceOf(Quad());
    const Patches p = SamplePatches(s.graph, {}, Param(0.5, 300));
    ExpectPartition(s.graph, {}, p);
    EXPECT_EQ(p.Size(), 4);
}

TEST(SamplePatches, TakesExtremeRadii) {
    const SurfaceGraph s = SurfaceOf(Grid(6, 6));
    for (double D : {1e-30, 1e-60, 1e30}) {
        const Patches p = SamplePatches(s.graph, {}, Param(D, 4));
        ExpectPartition(s.graph, {}, p);
        EXPECT_EQ(p.Size(), D < 1 ? 36 : 4) << D;
    }
}

TEST(SamplePatches, EachDisconnectedPartHasItsOwn) {
    const SurfaceGraph s = SurfaceOf(Unwelded(Triangle())), many = [] {
        Shape shape;
        for (int i = 0; i < 1000; ++i)
            shape = Join(std::move(shape),
                         Moved(Triangle(), Eigen::Affine3d(Eigen::Translation3d(i % 32 * 2, i / 32 * 2, 0))));
        shape.position.emplace_back(-5, -5, 0); // isolated
        return SurfaceOf(shape);
    }();
    ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, Param(1)), 1);
    const Patches p = SamplePatches(many.graph, {}, Param(1));
    ExpectConverged(many.graph, {}, p, 1);
    EXPECT_EQ(p.Size(), 1001);
}

TEST(SamplePatches, TakesIsolatedNodes) {
    Shape shape = Points(Grid(5, 5));
    shape.edge = {{0, 1}};
    const SurfaceGraph s = SurfaceOf(shape);
    const Patches p = SamplePatches(s.graph, {}, Param(1));
    ExpectConverged(s.graph, {}, p, 1);
    EXPECT_GE(p.Size(), 24);
}

TEST(SamplePatches, DependsOnTheSeedAloneNotOnTheThreads) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(150, 150), 0.3));
    PatchParam param = Param(0.1);
    const Patches first = SamplePatches(s.graph, {}, param, Threads(1));
    for (unsigned threads : {1u, 2u, 7u}) {
        const Patches again = SamplePatches(s.graph, {}, param, Threads(threads));
        EXPECT_EQ(again.patchOf, first.patchOf);
        EXPECT_EQ(again.center, first.center);
        EXPECT_EQ(again.radius, first.radius);
        EXPECT_EQ(again.cost, first.cost);
    }
    param.randomSeed = 2;
    EXPECT_NE(SamplePatches(s.graph, {}, param).center, first.center);
}

TEST(SamplePatches, IsAsGoodAsThePlainAlgorithm) {
    double sum = 0;
    struct Case {
        const char *name;
        Shape shape;
        double D;
    };
    for (const Case &c :
         {Case{"grid", Jittered(Grid(317, 317), 0.3), 0.045}, Case{"small grid", Jittered(Grid(100, 90), 0.3), 0.09},
          Case{"tube", Jittered(Tube(400, 150), 0.01), 0.1}, Case{"sphere", Sphere(200, 300), 0.12},
          Case{"sheets", TwoSheets(150, 0.5), 0.08}}) {
        SCOPED_TRACE(c.name);
        const SurfaceGraph s = SurfaceOf(c.shape);
        const PatchParam param = Param(c.D, 100);
        const Patches p = SamplePatches(s.graph, {}, param);
        ExpectConverged(s.graph, {}, p, param.targetRadius);
        const PlainPatches plain = SamplePlainly(s.graph, param);
        EXPECT_LT(p.cost, 1.04 * plain.cost);
        sum += p.cost / plain.cost / 5;
        EXPECT_LT(p.Size(), 1.1 * double(plain.center.size()));
        // With k patches the cost goes as 1 / k: compare what is left of it.
        EXPECT_LT(p.cost * p.Size(), 1.04 * plain.cost * double(plain.center.size()));
    }
    EXPECT_LT(sum, 1.02) << "mean over the meshes; single ones with few patches scatter by the local minimum they find";
}

TEST(SamplePatches, IsNearlyUniform) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(317, 317), 0.3));
    for (unsigned seed = 1; seed <= 3; ++seed) {
        PatchParam param = Param(0.045, 100);
        param.randomSeed = seed;
        const Patches p = SamplePatches(s.graph, {}, param);
        const Csr members = GroupMembers(p.patchOf, p.Size());
        double square = 0;
        for (Index j = 0; j < p.Size(); ++j)
            square += double(members[j].size()) * double(members[j].size());
        const double mean = double(s.graph.Size()) / p.Size();
        EXPECT_LT(std::sqrt(square / p.Size() / (mean * mean) - 1), 0.25);
    }
}

TEST(SamplePatches, AnyNumberOfIterationsGivesAPartitionOfManyNodes) {
    const SurfaceGraph s = SurfaceOf(Grid(200, 200));
    for (int iterations : {1, 2, 4, 20}) {
        PatchParam param = Param(0.1, 20);
        param.maxIterations = iterations;
        SCOPED_TRACE(iterations);
        ExpectPartition(s.graph, {}, SamplePatches(s.graph, {}, param));
    }
}

TEST(SamplePatches, KeepsTagsAndPartsApartAmongManyNodes) {
    const SurfaceGraph s = SurfaceOf(TwoSheets(120, 0.01));
    const std::vector<Index> tag = TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] < 35.5 ? 1 : 0; });
    ExpectConverged(s.graph, tag, SamplePatches(s.graph, tag, Param(0.12)), 0.12);
}

TEST(SamplePatches, CanBeCancelledAnywhere) {
    const SurfaceGraph s = SurfaceOf(Grid(100, 100));
    CallbackLog all;
    SamplePatches(s.graph, {}, Param(0.15), all.Progress(1));
    EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
    const std::size_t calls = all.percent.size();
    ASSERT_GT(calls, 0u);
    for (std::size_t i = 0; i < calls; ++i) {
        CallbackLog log(i);
        EXPECT_THROW(SamplePatches(s.graph, {}, Param(0.15), log.Progress(1)), Cancelled);
    }
}

TEST(GrowPatches, KeepsTheCentres) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(20, 20), 0.3));
    const std::vector<Index> center{3, 200, 77, 399};
    const Patches p = GrowPatches(s.graph, {}, center);
    ExpectPartition(s.graph, {}, p);
    EXPECT_EQ(p.center, center);
}

TEST(GrowPatches, AddsACentreWhereNoneLeads) {
    const SurfaceGraph s = SurfaceOf(TwoSheets(8, 3));
    const std::vector<Index> tag = TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] < 3.5 ? 1 : 2; });
    const Patches p = GrowPatches(s.graph, tag, {5});
    ExpectPartition(s.graph, tag, p);
    EXPECT_EQ(p.Size(), 4);
    EXPECT_EQ(p.center[0], 5);
}

TEST(GrowPatches, GivesEachNodeANearbyCentre) {
    // On a flat convex grid a patch is nearly the Voronoi cell.
    const SurfaceGraph s = SurfaceOf(Grid(40, 40));
    const std::vector<Index> center = vcg::fcd::detail::RandomSample(s.graph.Size(), 12, 1);
    const Patches p = GrowPatches(s.graph, {}, center);
    ExpectPartition(s.graph, {}, p);
    for (Index u = 0; u < s.graph.Size(); ++u) {
        double nearest = 1;
        for (Index c : center)
            nearest = std::min(nearest, Distance(s.graph, u, c));
        EXPECT_LE(Distance(s.graph, u, p.center[p.patchOf[u]]), nearest + 1.5 * s.averageEdge);
    }
}
