// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/solve/graph_parts.h>
#include <vcg_ext/solve/graph_deformer.h>
#include "test_support.h"

#include <map>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Vector3d;

/// A sheet that is held at both ends and, by \p middle, across its middle.
static Rig SheetRig(int middle = 0) {
    return Rig(Jittered(Grid(61, 21, 0.1), 0.02), 0.4, [&](const Vector3d &p) {
        return p[0] < 0.5 ? 2 : p[0] > 5.5 ? 3 : std::abs(p[0] - 3) < 0.3 ? middle : 1;
    });
}

static const Affine3d lift = Eigen::Translation3d(0, 0.5, 1) * Eigen::AngleAxisd(0.7, Vector3d::UnitX());

static GraphPose SolveParts(const DeformationGraph &graph, const std::vector<double> &area,
                            const NodeConstraints &given, const SolverParam &param) {
    return PartsDeformer(graph, area, given).Solve(given, param);
}

/// Handle 2 moves, what else is held does not.
static NodeConstraints ConstraintsOf(const Rig &rig, const Affine3d &second = lift,
                                     const Affine3d &third = Affine3d::Identity()) {
    return {rig.constrained, rig.constrained,
            std::vector<double>(rig.graph.Size(), std::numeric_limits<double>::infinity()),
            rig.NodeMotion([&](Index t) { return t == 2   ? second
                                                 : t == 3 ? third
                                                          : Affine3d::Identity(); })};
}

static std::vector<double> AreasOf(const Rig &rig) {
    std::vector<double> area(rig.graph.Size(), 0);
    for (Index u = 0; u < rig.surface.graph.Size(); ++u)
        if (rig.patches.patchOf[u] >= 0)
            area[rig.patches.patchOf[u]] += rig.surface.nodeArea[u];
    return area;
}

TEST(SeparateParts, AreTheFreeComponentsWithWhatHoldsThem) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        DeformationGraph graph;
        const Index k = 80;
        graph.held.resize(k);
        std::vector<bool> constrained(k);
        std::mt19937 random(seed);
        for (Index i = 0; i < k; ++i) {
            graph.held[i] = random() % 3 == 0;
            constrained[i] = graph.held[i] || random() % 30 == 0;
        }
        EdgeSet edges;
        for (int e = 0; e < 60 + 5 * int(seed); ++e) {
            const Index a = Index(random() % k), b = Index(random() % k);
            if (!graph.held[a] || !graph.held[b])
                Insert(edges, a, b);
        }
        graph.graph.adjacency = CsrOf(k, edges);
        UnionFind sets =
            ComponentsWhere(graph.graph.adjacency, [&](Index u, Index v) { return !graph.held[u] && !graph.held[v]; });
        std::map<Index, std::set<Index>> expected; // by the root
        for (Index i = 0; i < k; ++i)
            if (!graph.held[i]) {
                expected[sets.Root(i)].insert(i);
                for (Index j : graph.graph.adjacency[i])
                    if (graph.held[j])
                        expected[sets.Root(i)].insert(j);
            }
        std::set<std::vector<Index>> wanted;
        for (const auto &each : expected)
            if (std::any_of(each.second.begin(), each.second.end(), [&](Index i) { return constrained[i]; }))
                wanted.emplace(each.second.begin(), each.second.end());
        const std::vector<std::vector<Index>> parts = SeparateParts(graph, constrained);
        EXPECT_EQ(parts.size(), wanted.size());
        EXPECT_EQ(std::set<std::vector<Index>>(parts.begin(), parts.end()), wanted);
    }
}

TEST(SeparateParts, OfAGraphWithoutHeldNodesAreItsComponents) {
    DeformationGraph graph;
    graph.graph.adjacency = CsrOf(6, {{0, 1}, {1, 2}, {4, 5}});
    std::vector<bool> constrained(6, false);
    EXPECT_TRUE(SeparateParts(graph, constrained).empty());
    constrained[1] = true;
    EXPECT_EQ(SeparateParts(graph, constrained), (std::vector<std::vector<Index>>{{0, 1, 2}}));
    EXPECT_TRUE(SeparateParts({}, {}).empty());
}

TEST(PartOf, KeepsTheEdgesBetweenItsNodes) {
    const Rig rig = SheetRig();
    const DeformationGraph &g = rig.graph;
    std::vector<Index> all(g.Size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::vector<Index>> parts = SeparateParts(g, rig.constrained);
    EXPECT_EQ(parts.size(), 2u);
    parts.push_back(all);
    parts.push_back({0, 5, 6, 20});
    for (const std::vector<Index> &nodes : parts) {
        const DeformationGraph part = PartOf(g, nodes);
        ASSERT_EQ(part.Size(), Index(nodes.size()));
        ExpectAdjacencyInOrder(part.graph.adjacency);
        EdgeSet expected;
        for (Index i = 0; i < part.Size(); ++i) {
            EXPECT_EQ(part.radius[i], g.radius[nodes[i]]);
            EXPECT_EQ(part.IsHeld(i), g.IsHeld(nodes[i]));
            EXPECT_EQ(part.graph.position.col(i), g.graph.position.col(nodes[i]));
            for (Index j = 0; j < part.Size(); ++j) {
                const Csr::Row row = g.graph.adjacency[nodes[i]];
                const auto whole = std::lower_bound(row.begin(), row.end(), nodes[j]);
                if (whole == row.end() || *whole != nodes[j])
                    continue;
                Insert(expected, i, j);
                const Csr::Row own = part.graph.adjacency[i];
                const auto e = std::lower_bound(own.begin(), own.end(), j) - part.graph.adjacency.item.data();
                EXPECT_EQ(part.weight[e], g.weight[whole - g.graph.adjacency.item.data()]);
                EXPECT_EQ(part.edge.col(e), g.edge.col(whole - g.graph.adjacency.item.data()));
            }
        }
        EXPECT_EQ(EdgesOf(part.graph.adjacency), expected);
    }
}

TEST(PartsDeformer, OfOnePartIsTheGraphDeformers) {
    const Rig rig = SheetRig(1);
    const std::vector<double> area = AreasOf(rig);
    double A = 0;
    for (double a : area)
        A += a;
    const NodeConstraints given = ConstraintsOf(rig);
    ASSERT_EQ(SeparateParts(rig.graph, given.constrained).size(), 1u);
    const GraphPose pose = SolveParts(rig.graph, area, given, {}),
                    whole = GraphDeformer(rig.graph, given.constrained, A, given.compliant, given.heldArea)
                                .Solve(given.motion, {});
    EXPECT_TRUE(pose.converged);
    EXPECT_TRUE(SameBits(pose.position, whole.position));
    EXPECT_EQ(pose.linear, whole.linear);
    EXPECT_EQ(pose.nodeEnergy, whole.nodeEnergy);
    EXPECT_EQ(pose.energy, whole.energy);
    EXPECT_EQ(pose.iterations, whole.iterations);
}

TEST(PartsDeformer, HeldNodesKeepPartsApart) {
    const Rig rig = SheetRig();
    const std::vector<double> area = AreasOf(rig);
    const Eigen::Matrix3Xd rest = rig.graph.graph.position.cast<double>();
    const GraphPose pulled = SolveParts(rig.graph, area, ConstraintsOf(rig), {}),
                    both = SolveParts(rig.graph, area, ConstraintsOf(rig, lift, lift.inverse()), {});
    const double middle = rig.surface.frame.ToFrame(Vector3d(3, 0, 0))[0];
    int left = 0, right = 0;
    for (Index i = 0; i < rig.graph.Size(); ++i) {
        EXPECT_EQ(pulled.rests[i] != 0, !rig.constrained[i] && rest(0, i) > middle);
        EXPECT_FALSE(both.rests[i]);
        if (rig.constrained[i])
            continue;
        if (rest(0, i) < middle) {
            ++left;
            EXPECT_TRUE(SameBits(Vector3d(pulled.position.col(i)), Vector3d(both.position.col(i))));
            EXPECT_TRUE(SameBits(pulled.linear[i], both.linear[i]));
            EXPECT_NE(pulled.position.col(i), rest.col(i));
        } else {
            ++right;
            EXPECT_TRUE(SameBits(Vector3d(pulled.position.col(i)), Vector3d(rest.col(i)))) << "nothing pulls it";
            EXPECT_GT((both.position.col(i) - rest.col(i)).norm(), 1e-6);
        }
    }
    EXPECT_GT(left, 3);
    EXPECT_GT(right, 3);
    EXPECT_GT(both.energy, pulled.energy);
}

TEST(PartsDeformer, APartIsSolvedAsIfThereWereNoOthers) {
    const Rig rig = SheetRig();
    const std::vector<double> area = AreasOf(rig);
    const NodeConstraints given = ConstraintsOf(rig, lift, lift.inverse());
    const GraphPose pose = SolveParts(rig.graph, area, given, {});
    std::vector<bool> seen(rig.graph.Size(), false);
    double energy = 0;
    int iterations = 0;
    for (const std::vector<Index> &nodes : SeparateParts(rig.graph, given.constrained)) {
        NodeConstraints here;
        std::vector<double> areas;
        for (Index i : nodes) {
            here.constrained.push_back(given.constrained[i]);
            here.compliant.push_back(given.compliant[i]);
            here.heldArea.push_back(given.heldArea[i]);
            here.motion.push_back(given.motion[i]);
            areas.push_back(area[i]);
        }
        const GraphPose alone = SolveParts(PartOf(rig.graph, nodes), areas, here, {});
        energy += alone.energy;
        iterations = std::max(iterations, alone.iterations);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (seen[nodes[i]])
                continue;
            seen[nodes[i]] = true;
            EXPECT_TRUE(SameBits(Vector3d(alone.position.col(Index(i))), Vector3d(pose.position.col(nodes[i]))));
            EXPECT_TRUE(SameBits(alone.linear[i], pose.linear[nodes[i]]));
        }
    }
    EXPECT_EQ(pose.energy, energy);
    EXPECT_EQ(pose.iterations, iterations);
    EXPECT_NEAR(std::accumulate(pose.nodeEnergy.begin(), pose.nodeEnergy.end(), 0.0), energy, 1e-9 * energy);
}

TEST(PartsDeformer, WhatNothingHoldsRests) {
    const Rig rig(TwoSheets(10, 1), 2, [](const Vector3d &p) { return p[2] < 0.5 && p[0] < 2 ? 2 : 1; });
    const NodeConstraints given = ConstraintsOf(rig);
    const GraphPose pose = SolveParts(rig.graph, AreasOf(rig), given, {});
    const Eigen::Matrix3Xd rest = rig.graph.graph.position.cast<double>();
    int loose = 0;
    for (Index i = 0; i < rig.graph.Size(); ++i)
        if (rest(2, i) > 0) {
            ++loose;
            EXPECT_EQ(pose.position.col(i), rest.col(i));
            EXPECT_EQ(pose.linear[i], Eigen::Matrix3d::Identity());
            EXPECT_EQ(pose.nodeEnergy[i], 0);
        } else {
            const Vector3d expected = rig.surface.frame.ToFrame(lift.matrix()) * Vector3d(rest.col(i));
            EXPECT_LE((pose.position.col(i) - expected).norm(), 1e-4);
        }
    EXPECT_GT(loose, 0);
    EXPECT_EQ(SolveParts({}, {}, {}, {}).position.cols(), 0);
}

TEST(PartsDeformer, CanBeCancelledAnywhere) {
    const Rig rig = SheetRig();
    const NodeConstraints given = ConstraintsOf(rig, lift, lift);
    const auto solve = [&](const CallbackLog &log) {
        PartsDeformer(rig.graph, AreasOf(rig), given).Solve(given, {}, log.Progress(1));
    };
    CallbackLog all;
    solve(all);
    EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
    const std::size_t calls = all.percent.size();
    ASSERT_GT(calls, 1u);
    for (std::size_t i = 0; i < calls; ++i) {
        CallbackLog log(i);
        EXPECT_THROW(solve(log), Cancelled);
    }
}
