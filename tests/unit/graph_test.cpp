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

static void ExpectQuotient(const Csr &graph, const std::vector<Index> &groupOf, Index groups) {
    std::map<std::pair<Index, Index>, Index> crossings; // both directions
    for (const auto &e : EdgesOf(graph)) {
        const Index a = groupOf[e.first], b = groupOf[e.second];
        if (a != b) {
            ++crossings[{a, b}];
            ++crossings[{b, a}];
        }
    }
    const Quotient dual = QuotientGraph(graph, groupOf, groups);
    ASSERT_EQ(dual.adjacency.Size(), groups);
    ASSERT_EQ(dual.adjacency.item.size(), crossings.size());
    ASSERT_EQ(dual.crossings.size(), crossings.size());
    ExpectAdjacencyInOrder(dual.adjacency);
    for (Index g = 0; g < groups; ++g)
        for (std::uint32_t e = dual.adjacency.begin[g]; e < dual.adjacency.begin[g + 1]; ++e) {
            const auto found = crossings.find({g, dual.adjacency.item[e]});
            ASSERT_NE(found, crossings.end());
            EXPECT_EQ(dual.crossings[e], found->second);
        }
    for (unsigned threads : {1u, 2u, 7u}) {
        const Quotient same = QuotientGraph(graph, groupOf, groups, fcd_test::Threads(threads));
        EXPECT_EQ(same.adjacency.begin, dual.adjacency.begin);
        EXPECT_EQ(same.adjacency.item, dual.adjacency.item);
        EXPECT_EQ(same.crossings, dual.crossings);
    }
}

TEST(QuotientGraph, IsTheBruteForceOne) {
    for (unsigned seed = 1; seed <= 20; ++seed)
        ExpectQuotient(RandomGraph(60, 30 * (seed % 8), seed), RandomGroups(60, 1 + seed, seed), 1 + seed);
}

TEST(QuotientGraph, IsTheBruteForceOneOverSeveralRanges) {
    ExpectQuotient(RandomGraph(40000, 60000, 1), RandomGroups(40000, 50, 1), 50);
}

TEST(QuotientGraph, OfNothingIsNothing) {
    const Quotient dual = QuotientGraph({}, {}, 0);
    EXPECT_EQ(dual.adjacency.Size(), 0);
    EXPECT_TRUE(dual.crossings.empty());
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

TEST(ConnectedComponents, OfNothingIsNothing) {
    std::vector<Index> componentOf{1, 2};
    EXPECT_EQ(ConnectedComponents({}, componentOf), 0);
    EXPECT_TRUE(componentOf.empty());
}
