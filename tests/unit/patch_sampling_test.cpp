// SPDX-License-Identifier: GPL-3.0-or-later
#include "../plain_sampling.h"
#include <vcg_ext/patches/patch_sampling.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;

static SurfaceGraph SurfaceOf(const Shape &shape) { return BuildSurfaceGraph(Read(MeshD(shape))); }

static double Distance(const Graph &g, Index a, Index b) {
    return (g.position.col(a) - g.position.col(b)).cast<double>().norm();
}

static bool TakesPart(const std::vector<Index> &tag, Index u) { return tag.empty() || tag[u] == 1; }

/// The weight of each node, with a mean of 1 over those that take part.
static std::vector<double> Counts(const Graph &g, const std::vector<Index> &tag, const std::vector<float> &mass) {
    std::vector<double> counts(g.Size(), 0);
    double sum = 0, nodes = 0;
    for (Index u = 0; u < g.Size(); ++u)
        if (TakesPart(tag, u)) {
            counts[u] = mass.empty() ? 1 : mass[u];
            sum += counts[u];
            ++nodes;
        }
    for (Index u = 0; u < g.Size(); ++u)
        if (TakesPart(tag, u))
            counts[u] = sum > 0 ? counts[u] * nodes / sum : 1;
    return counts;
}

/// Expects that each node that takes part is in one patch, and others in none; that patches are connected and not
/// empty; and radius and cost as documented.
static void ExpectPartition(const Graph &g, const std::vector<Index> &tag, const Patches &p,
                            const std::vector<float> &mass = {}) {
    const Index k = p.Size();
    ASSERT_EQ(Index(p.patchOf.size()), g.Size());
    ASSERT_EQ(Index(p.radius.size()), k);
    ASSERT_EQ(p.tag, std::vector<Index>(k, 1));
    for (Index u = 0; u < g.Size(); ++u) {
        if (!TakesPart(tag, u)) {
            ASSERT_EQ(p.patchOf[u], -1);
            continue;
        }
        ASSERT_GE(p.patchOf[u], 0);
        ASSERT_LT(p.patchOf[u], k);
    }
    for (Index j = 0; j < k; ++j)
        ASSERT_EQ(p.patchOf[p.center[j]], j) << "a centre is not in its patch";
    UnionFind parts = ComponentsWhere(g.adjacency, [&](Index u, Index v) { return p.patchOf[u] == p.patchOf[v]; });
    const std::vector<double> counts = Counts(g, tag, mass);
    std::vector<double> radius(k, 0);
    double cost = 0;
    for (Index u = 0; u < g.Size(); ++u) {
        if (p.patchOf[u] < 0)
            continue;
        const Index c = p.center[p.patchOf[u]];
        ASSERT_EQ(parts.Root(u), parts.Root(c)) << "a patch is not connected";
        const double d = Distance(g, u, c);
        radius[p.patchOf[u]] = std::max(radius[p.patchOf[u]], d);
        cost += counts[u] * d * d;
    }
    for (Index j = 0; j < k; ++j)
        ASSERT_NEAR(p.radius[j], radius[j], 1e-6);
    EXPECT_NEAR(p.cost, cost, 1e-5 * cost);
}

/// More expectations once the iteration has converged.
static void ExpectConverged(const Graph &g, const std::vector<Index> &tag, const Patches &p, double D,
                            const std::vector<float> &mass = {}) {
    ExpectPartition(g, tag, p, mass);
    ASSERT_TRUE(p.converged);
    const std::vector<double> counts = Counts(g, tag, mass);
    const Csr members = GroupMembers(p.patchOf, p.Size());
    for (Index j = 0; j < p.Size(); ++j) {
        if (members[j].size() > 1) {
            EXPECT_LE(p.radius[j], D * (1 + 1e-6));
        }
        Eigen::Vector3d barycenter = Eigen::Vector3d::Zero();
        double sum = 0;
        for (Index u : members[j]) {
            barycenter += counts[u] * g.position.col(u).cast<double>();
            sum += counts[u];
        }
        if (!(sum > 0))
            continue;
        barycenter /= sum;
        auto off = [&](Index u) { return (g.position.col(u).cast<double>() - barycenter).norm(); };
        double nearest = off(p.center[j]);
        for (Index u : members[j])
            nearest = std::min(nearest, off(u));
        EXPECT_NEAR(off(p.center[j]), nearest, 1e-6);
    }
}

static PatchParam SamplingParam(double D, int initialPatches = 20) {
    PatchParam param;
    param.targetRadius = D;
    param.initialPatches = initialPatches;
    return param;
}

TEST(SamplePatches, PartitionsMiniatureMeshes) {
    for (const Shape &shape : {Triangle(), Quad(), Grid(20, 20), Strip(50), Tube(20, 12), Sphere(12, 20), Fan3(),
                               Fan(200), TwoSheets(12, 0.2), UnweldedGrid(12, 9), Wireframe(12, 9), PointCloud(500)})
        for (double D : {0.01, 0.1, 0.4}) {
            const SurfaceGraph s = SurfaceOf(shape);
            PatchParam param = SamplingParam(D);
            param.maxIterations = 1000; // a star is split once an iteration
            ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, {}, param), D);
        }
}

TEST(SamplePatches, OnlyNodesOfTagOneTakePart) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const SurfaceGraph s = SurfaceOf(Jittered(Grid(25, 25), 0.3, seed));
        const std::vector<Index> halves =
            TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] + p[1] < 20 ? 1 : 2; });
        ExpectConverged(s.graph, halves, SamplePatches(s.graph, halves, {}, SamplingParam(0.15)), 0.15);
        const std::vector<Index> random = RandomGroups(s.graph.Size(), 3, seed); // many tiny parts
        ExpectConverged(s.graph, random, SamplePatches(s.graph, random, {}, SamplingParam(0.15)), 0.15);
    }
}

TEST(SamplePatches, LeavesNoPatchEmptyOnIrregularGraphs) {
    for (unsigned seed = 1; seed <= 60; ++seed) {
        SurfaceGraph s = SurfaceOf(PointCloud(10 + 10 * (seed % 12), seed));
        s.graph.adjacency = RandomGraph(s.graph.Size(), s.graph.Size(), seed); // edges of any length
        const double D = 0.05 * (1 + seed % 5);
        SCOPED_TRACE(seed);
        ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, {}, SamplingParam(D, 1 + seed % 4)), D);
    }
}

TEST(SamplePatches, AnyNumberOfIterationsGivesAPartition) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(30, 30), 0.3));
    for (int iterations : {1, 2, 3, 5}) {
        PatchParam param = SamplingParam(0.05, 3);
        param.maxIterations = iterations;
        const Patches p = SamplePatches(s.graph, {}, {}, param);
        EXPECT_LE(p.iterations, iterations);
        SCOPED_TRACE(iterations);
        ExpectPartition(s.graph, {}, p);
    }
}

TEST(SamplePatches, RelaxesEvenWherePatchesAreSmallEnoughFromTheStart) {
    const SurfaceGraph s = SurfaceOf(Grid(40, 40));
    const Patches p = SamplePatches(s.graph, {}, {}, SamplingParam(10, 30));
    ExpectConverged(s.graph, {}, p, 10);
    EXPECT_EQ(p.Size(), 30);
    EXPECT_GT(p.iterations, 2);
    // 30 square patches of a unit-diagonal square: k * side^4 / 6 per area, times the number of nodes.
    const double side = 1 / std::sqrt(2.0), ideal = 1600 * side * side / 30 / 6;
    EXPECT_LT(p.cost, 1.25 * ideal);
}

TEST(SamplePatches, TakesMoreSeedsThanNodes) {
    const SurfaceGraph s = SurfaceOf(Quad());
    const Patches p = SamplePatches(s.graph, {}, {}, SamplingParam(0.5, 300));
    ExpectPartition(s.graph, {}, p);
    EXPECT_EQ(p.Size(), 4);
}

TEST(SamplePatches, TakesExtremeRadii) {
    const SurfaceGraph s = SurfaceOf(Grid(6, 6));
    for (double D : {1e-30, 1e-60, 1e30}) {
        const Patches p = SamplePatches(s.graph, {}, {}, SamplingParam(D, 4));
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
    ExpectConverged(s.graph, {}, SamplePatches(s.graph, {}, {}, SamplingParam(1)), 1);
    const Patches p = SamplePatches(many.graph, {}, {}, SamplingParam(1));
    ExpectConverged(many.graph, {}, p, 1);
    EXPECT_EQ(p.Size(), 1001);
}

TEST(SamplePatches, TakesIsolatedNodes) {
    Shape shape = Points(Grid(5, 5));
    shape.edge = {{0, 1}};
    const SurfaceGraph s = SurfaceOf(shape);
    const Patches p = SamplePatches(s.graph, {}, {}, SamplingParam(1));
    ExpectConverged(s.graph, {}, p, 1);
    EXPECT_GE(p.Size(), 24);
}

TEST(SamplePatches, DependsOnTheSeedAloneNotOnTheThreads) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(150, 150), 0.3));
    PatchParam param = SamplingParam(0.1);
    const Patches first = SamplePatches(s.graph, {}, {}, param, Threads(1));
    for (unsigned threads : Rounds({7u, 2u, 1u})) {
        const Patches again = SamplePatches(s.graph, {}, {}, param, Threads(threads));
        EXPECT_EQ(again.patchOf, first.patchOf);
        EXPECT_EQ(again.center, first.center);
        EXPECT_EQ(again.radius, first.radius);
        EXPECT_EQ(again.cost, first.cost);
    }
    param.randomSeed = 2;
    EXPECT_NE(SamplePatches(s.graph, {}, {}, param).center, first.center);
}

TEST(SamplePatches, IsAsGoodAsThePlainAlgorithm) {
    double sum = 0;
    struct Case {
        const char *name;
        Shape shape;
        double D;
    };
    const std::vector<Case> cases = Rounds<Case>({{"small grid", Jittered(Grid(100, 90), 0.3), 0.09},
                                                  {"grid", Jittered(Grid(317, 317), 0.3), 0.045},
                                                  {"tube", Jittered(Tube(400, 150), 0.01), 0.1},
                                                  {"sphere", Sphere(200, 300), 0.12},
                                                  {"sheets", TwoSheets(150, 0.5), 0.08}});
    for (const Case &c : cases) {
        SCOPED_TRACE(c.name);
        const SurfaceGraph s = SurfaceOf(c.shape);
        const PatchParam param = SamplingParam(c.D, 100);
        const Patches p = SamplePatches(s.graph, {}, {}, param);
        ExpectConverged(s.graph, {}, p, param.targetRadius);
        const PlainPatches plain = SamplePlainly(s.graph, param);
        sum += p.cost / plain.cost / double(cases.size());
        EXPECT_LT(p.Size(), 1.1 * double(plain.center.size()));
        // The cost of k patches is about proportional to 1 / k; how often patches are split is random.
        EXPECT_LT(p.cost * p.Size(), 1.02 * plain.cost * double(plain.center.size()));
    }
    EXPECT_LT(sum, 1.02) << "mean over the meshes";
}

TEST(SamplePatches, RoughOnesAreLikeTheOthers) {
    for (const Shape &shape : {Jittered(Grid(200, 200), 0.3), Sphere(200, 300), Jittered(Grid(20, 20), 0.3)}) {
        const SurfaceGraph s = SurfaceOf(shape);
        PatchParam param = SamplingParam(0.1, 30);
        const Patches fine = SamplePatches(s.graph, {}, s.nodeArea, param);
        param.rough = true;
        KeptClusters kept;
        const Patches rough = SamplePatches(s.graph, {}, s.nodeArea, param, {}, &kept);
        for (int patches : {30, 120}) { // reuse changes nothing
            PatchParam next = SamplingParam(patches == 30 ? 0.1 : 0.05, patches);
            EXPECT_EQ(SamplePatches(s.graph, {}, s.nodeArea, next, {}, &kept).patchOf,
                      SamplePatches(s.graph, {}, s.nodeArea, next).patchOf);
        }
        ExpectPartition(s.graph, {}, rough, s.nodeArea);
        if (shape.Size() < 1000) { // too few nodes for clusters
            EXPECT_EQ(rough.patchOf, fine.patchOf);
            continue;
        }
        EXPECT_NE(rough.patchOf, fine.patchOf);
        EXPECT_NEAR(rough.Size(), fine.Size(), 0.2 * fine.Size());
        EXPECT_LT(rough.cost * rough.Size(), 1.25 * fine.cost * fine.Size()); // of some 25 clusters each
    }
}

TEST(SamplePatches, IsNearlyUniform) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(317, 317), 0.3));
    for (unsigned seed : Rounds({1u, 2u, 3u})) {
        PatchParam param = SamplingParam(0.045, 100);
        param.randomSeed = seed;
        const Patches p = SamplePatches(s.graph, {}, {}, param);
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
        PatchParam param = SamplingParam(0.1, 20);
        param.maxIterations = iterations;
        SCOPED_TRACE(iterations);
        ExpectPartition(s.graph, {}, SamplePatches(s.graph, {}, {}, param));
    }
}

TEST(SamplePatches, KeepsPartsApartAmongManyNodes) {
    const SurfaceGraph s = SurfaceOf(TwoSheets(120, 0.01));
    const std::vector<Index> tag = TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] < 35.5 ? 1 : 0; });
    ExpectConverged(s.graph, tag, SamplePatches(s.graph, tag, {}, SamplingParam(0.12)), 0.12);
}

/// A sheet that is sampled finer and finer from left to right, \p n rows.
static Shape Graded(int n) {
    Shape s = Grid(4 * n, n);
    for (Eigen::Vector3d &p : s.position)
        p[0] = n * std::log1p(p[0] / n); // spacing from 1 to 0.2
    return s;
}

TEST(SamplePatches, NodesCountByTheirMass) {
    for (const Shape &shape : {Jittered(Grid(40, 40), 0.3), Graded(40), Tube(20, 12)}) {
        const SurfaceGraph s = SurfaceOf(shape);
        const Patches p = SamplePatches(s.graph, {}, s.nodeArea, SamplingParam(0.2));
        ExpectConverged(s.graph, {}, p, 0.2, s.nodeArea);
    }
}

TEST(SamplePatches, PatchesAreOfEqualAreaOnASurfaceOfUnequalDensity) {
    const SurfaceGraph s = SurfaceOf(Graded(120));
    const auto variation = [&](const std::vector<float> &mass) {
        const Patches p = SamplePatches(s.graph, {}, mass, SamplingParam(10, 100));
        ExpectPartition(s.graph, {}, p, mass);
        std::vector<double> area(p.Size(), 0);
        for (Index u = 0; u < s.graph.Size(); ++u)
            area[p.patchOf[u]] += s.nodeArea[u];
        double mean = 0, square = 0;
        for (double a : area) {
            mean += a / double(area.size());
            square += a * a / double(area.size());
        }
        return std::sqrt(square / (mean * mean) - 1);
    };
    EXPECT_LT(variation(s.nodeArea), 0.25);
    EXPECT_GT(variation({}), 0.3) << "patches of equal numbers of nodes";
}

TEST(SamplePatches, MassesMayBeScaledByAPowerOfTwo) {
    const SurfaceGraph s = SurfaceOf(Graded(40));
    std::vector<float> mass = s.nodeArea;
    const Patches first = SamplePatches(s.graph, {}, mass, SamplingParam(0.2));
    for (float &m : mass)
        m *= 1024;
    const Patches again = SamplePatches(s.graph, {}, mass, SamplingParam(0.2));
    EXPECT_EQ(again.patchOf, first.patchOf);
    EXPECT_EQ(again.cost, first.cost);
}

TEST(SamplePatches, TakesNodesWithoutMass) {
    const SurfaceGraph s = SurfaceOf(Grid(30, 30));
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const std::vector<float> some = RandomMasses(s.graph.Size(), seed), none(s.graph.Size(), 0);
        ExpectPartition(s.graph, {}, SamplePatches(s.graph, {}, some, SamplingParam(0.2)), some);
        ExpectPartition(s.graph, {}, SamplePatches(s.graph, {}, none, SamplingParam(0.2)), none);
    }
}

TEST(SamplePatches, ANodeEachDoesNotDependOnTheSeed) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(25, 20), 0.3));
    const std::vector<Index> tag = TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] < 6 ? 0 : 1; });
    PatchParam param = SamplingParam(1, 10 * s.graph.Size());
    const Patches first = SamplePatches(s.graph, tag, {}, param);
    EXPECT_EQ(first.Size(), Index(std::count(tag.begin(), tag.end(), 1)));
    for (unsigned seed : {2, 3, 77}) {
        param.randomSeed = seed;
        const Patches p = SamplePatches(s.graph, tag, {}, param);
        EXPECT_EQ(p.patchOf, first.patchOf);
        EXPECT_EQ(p.center, first.center);
        EXPECT_EQ(p.cost, 0);
    }
}

TEST(SamplePatches, WhatDoesNotTakePartIsNotRead) {
    const SurfaceGraph s = SurfaceOf(Jittered(Grid(100, 60), 0.3));
    const std::vector<Index> tag = TagNodes(s, [](const Eigen::Vector3d &p) { return p[0] < 50.5 ? 1 : 0; });
    std::vector<float> mass = s.nodeArea;
    const Patches first = SamplePatches(s.graph, tag, mass, SamplingParam(0.1));
    std::vector<Index> other = tag;
    for (Index u = 0; u < s.graph.Size(); ++u)
        if (tag[u] != 1) {
            mass[u] *= 1e6f;
            other[u] = 5;
        }
    const Patches again = SamplePatches(s.graph, other, mass, SamplingParam(0.1));
    EXPECT_EQ(again.patchOf, first.patchOf);
    EXPECT_EQ(again.center, first.center);
    EXPECT_EQ(again.radius, first.radius);
    EXPECT_EQ(again.cost, first.cost);
}

TEST(SamplePatches, CanBeCancelledAnywhere) {
    const SurfaceGraph s = SurfaceOf(Grid(100, 100));
    CallbackLog all;
    SamplePatches(s.graph, {}, {}, SamplingParam(0.15), all.Progress(1));
    EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
    const std::size_t calls = all.percent.size();
    ASSERT_GT(calls, 0u);
    for (std::size_t i = 0; i < calls; ++i) {
        CallbackLog log(i);
        EXPECT_THROW(SamplePatches(s.graph, {}, {}, SamplingParam(0.15), log.Progress(1)), Cancelled);
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
    EXPECT_EQ(p.Size(), 2) << "a sheet each";
    EXPECT_EQ(p.center[0], 5);
}

TEST(GrowPatches, GivesEachNodeANearbyCentre) {
    // On a flat convex grid a patch is nearly the Voronoi cell.
    const SurfaceGraph s = SurfaceOf(Grid(40, 40));
    const std::vector<float> mass(s.graph.Size(), 1);
    const std::vector<Index> center = vcg::fcd::detail::RandomSample(mass, 12, 1);
    const Patches p = GrowPatches(s.graph, {}, center);
    ExpectPartition(s.graph, {}, p);
    for (Index u = 0; u < s.graph.Size(); ++u) {
        double nearest = 1;
        for (Index c : center)
            nearest = std::min(nearest, Distance(s.graph, u, c));
        EXPECT_LE(Distance(s.graph, u, p.center[p.patchOf[u]]), nearest + 1.5 * s.averageEdge);
    }
}
