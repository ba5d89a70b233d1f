// SPDX-License-Identifier: GPL-3.0-or-later
#include "test_support.h"

#include <map>

using namespace vcg::fcd;
using namespace fcd_test;

TEST(Csr, EmptyHasNoRows) {
    EXPECT_EQ(Csr().Size(), 0);
    EXPECT_EQ(Graph().Size(), 0);
}

TEST(Csr, RowsAreTheItemsBetweenTheOffsets) {
    Csr csr;
    csr.begin = {0, 2, 2, 3};
    csr.item = {7, 9, 4};
    ASSERT_EQ(csr.Size(), 3);
    EXPECT_EQ(std::vector<Index>(csr[0].begin(), csr[0].end()), (std::vector<Index>{7, 9}));
    EXPECT_EQ(csr[1].size(), 0u);
    EXPECT_EQ(csr[2][0], 4);
}

TEST(GroupMembers, InvertsTheMap) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Index groups = 1 + seed % 7;
        std::vector<Index> groupOf = RandomGroups(100, groups, seed);
        for (std::size_t i = 0; i < groupOf.size(); i += 9)
            groupOf[i] = -1;
        const Csr members = GroupMembers(groupOf, groups);
        ASSERT_EQ(members.Size(), groups);
        for (Index g = 0; g < groups; ++g) {
            std::vector<Index> expected;
            for (Index i = 0; i < Index(groupOf.size()); ++i)
                if (groupOf[i] == g)
                    expected.push_back(i);
            EXPECT_EQ(std::vector<Index>(members[g].begin(), members[g].end()), expected);
        }
    }
}

TEST(GroupMembers, AcceptsEmptyGroupsAndNoItems) {
    const Csr members = GroupMembers({2, 2}, 4);
    EXPECT_EQ(members.begin, (std::vector<std::uint32_t>{0, 0, 0, 2, 2}));
    EXPECT_EQ(GroupMembers({}, 0).Size(), 0);
    EXPECT_EQ(GroupMembers({}, 3).Size(), 3);
}

static const auto countOne = [](Index, Index, Index &value) {
    value = 1;
    return true;
};

static void ExpectQuotient(const Csr &graph, const std::vector<Index> &groupOf, Index groups) {
    std::map<std::pair<Index, Index>, Index> crossings; // both directions
    for (const auto &e : EdgesOf(graph)) {
        const Index a = groupOf[e.first], b = groupOf[e.second];
        if (a != b && a >= 0 && b >= 0) {
            ++crossings[{a, b}];
            ++crossings[{b, a}];
        }
    }
    const Quotient<Index> dual = QuotientGraph<Index>(graph, groupOf, groups, countOne);
    ASSERT_EQ(dual.adjacency.Size(), groups);
    ASSERT_EQ(dual.adjacency.item.size(), crossings.size());
    ASSERT_EQ(dual.value.size(), crossings.size());
    ExpectAdjacencyInOrder(dual.adjacency);
    for (Index g = 0; g < groups; ++g)
        for (std::uint32_t e = dual.adjacency.begin[g]; e < dual.adjacency.begin[g + 1]; ++e) {
            const auto found = crossings.find({g, dual.adjacency.item[e]});
            ASSERT_NE(found, crossings.end());
            EXPECT_EQ(dual.value[e], found->second);
        }
    for (unsigned threads : {1u, 2u, 7u}) {
        const Quotient<Index> same = QuotientGraph<Index>(graph, groupOf, groups, countOne, fcd_test::Threads(threads));
        EXPECT_EQ(same.adjacency.begin, dual.adjacency.begin);
        EXPECT_EQ(same.adjacency.item, dual.adjacency.item);
        EXPECT_EQ(same.value, dual.value);
    }
}

static std::vector<Index> SomeInNone(std::vector<Index> groupOf, unsigned seed) {
    std::mt19937 random(seed);
    for (Index &g : groupOf)
        g = random() % 4 ? g : -1;
    return groupOf;
}

TEST(QuotientGraph, IsTheBruteForceOne) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Csr graph = RandomGraph(60, 30 * (seed % 8), seed);
        const std::vector<Index> groupOf = RandomGroups(60, 1 + seed, seed);
        ExpectQuotient(graph, groupOf, 1 + seed);
        ExpectQuotient(graph, SomeInNone(groupOf, seed), 1 + seed);
    }
}

TEST(QuotientGraph, IsTheBruteForceOneOverSeveralRanges) {
    const std::vector<Index> groupOf = RandomGroups(40000, 50, 1);
    ExpectQuotient(RandomGraph(40000, 60000, 1), groupOf, 50);
    ExpectQuotient(RandomGraph(40000, 60000, 2), SomeInNone(groupOf, 2), 50);
}

TEST(QuotientGraph, ValuesAreAskedForFromTheSmallerGroupToTheLarger) {
    const std::vector<Index> groupOf = RandomGroups(500, 9, 5);
    QuotientGraph<Index>(RandomGraph(500, 2000, 5), groupOf, 9, [&](Index u, Index v, Index &value) {
        EXPECT_LT(groupOf[u], groupOf[v]);
        EXPECT_EQ(value, 0);
        return true;
    });
}

TEST(QuotientGraph, EdgesMayBeLeftOut) {
    const std::vector<Index> groupOf{0, 0, 1, 1, 2};
    const Csr graph = CsrOf(5, {{0, 2}, {1, 3}, {3, 4}, {0, 1}});
    const Quotient<Index> dual = QuotientGraph<Index>(graph, groupOf, 3, [](Index u, Index v, Index &value) {
        value = 10 * u + v;
        return u != 3 && u != 0;
    });
    EXPECT_EQ(dual.adjacency.begin, (std::vector<std::uint32_t>{0, 1, 2, 2}));
    EXPECT_EQ(dual.adjacency.item, (std::vector<Index>{1, 0}));
    EXPECT_EQ(dual.value, (std::vector<Index>{13, 13}));
}

TEST(QuotientGraph, OfNothingIsNothing) {
    const Quotient<Index> dual = QuotientGraph<Index>({}, {}, 0, countOne);
    EXPECT_EQ(dual.adjacency.Size(), 0);
    EXPECT_TRUE(dual.value.empty());
}

TEST(ConnectedComponents, AreThoseOfUnionFind) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Csr graph = RandomGraph(100, 10 * seed, seed);
        UnionFind sets = ComponentsWhere(graph, [](Index, Index) { return true; });
        std::vector<Index> componentOf;
        ASSERT_EQ(ConnectedComponents(graph, componentOf), sets.Count());
        Index next = 0; // numbered in the order of their first nodes
        for (Index u = 0; u < graph.Size(); ++u) {
            ASSERT_LE(componentOf[u], next);
            next += componentOf[u] == next;
            for (Index v = 0; v < u; ++v)
                ASSERT_EQ(componentOf[u] == componentOf[v], sets.Root(u) == sets.Root(v));
        }
    }
}

TEST(ConnectedComponents, AreTheSameOverSeveralRangesAndOnAnyThreads) {
    const Index n = 50000; // several blocks, joined by edges of any length
    for (int edges : {1000, 20000, 60000}) {
        const Csr graph = RandomGraph(n, edges, unsigned(edges));
        UnionFind sets = ComponentsWhere(graph, [](Index, Index) { return true; });
        std::vector<Index> expected(n, -1), numberOf(n, -1);
        Index next = 0;
        for (Index u = 0; u < n; ++u) {
            Index &number = numberOf[sets.Root(u)];
            if (number < 0)
                number = next++;
            expected[u] = number;
        }
        for (unsigned threads : {1u, 2u, 7u}) {
            std::vector<Index> componentOf;
            EXPECT_EQ(ConnectedComponents(graph, componentOf, fcd_test::Threads(threads)), next);
            EXPECT_EQ(componentOf, expected);
        }
    }
}

TEST(ConnectedComponents, OfNothingIsNothing) {
    std::vector<Index> componentOf{1, 2};
    EXPECT_EQ(ConnectedComponents({}, componentOf), 0);
    EXPECT_TRUE(componentOf.empty());
}
