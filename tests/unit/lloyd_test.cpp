// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/patches/lloyd.h>
#include "test_support.h"

using namespace fcd_test;
using vcg::fcd::detail::RandomSample;

static std::vector<float> Ones(Index n) { return std::vector<float>(n, 1); }

TEST(RandomSample, IsDistinctAscendingAndInRange) {
    for (Index n : {1, 2, 10, 1000})
        for (Index count : {1, 5, 300, 2000})
            for (unsigned seed = 0; seed < 5; ++seed) {
                const std::vector<Index> s = RandomSample(Ones(n), count, seed);
                ASSERT_LE(Index(s.size()), std::min(n, count));
                if (n % count == 0 || count >= 2 * n) { // whole nodes to a stretch, or a stretch in every node
                    EXPECT_EQ(Index(s.size()), std::min(n, count));
                }
                for (std::size_t i = 0; i < s.size(); ++i) {
                    ASSERT_GE(s[i], 0);
                    ASSERT_LT(s[i], n);
                    ASSERT_TRUE(i == 0 || s[i - 1] < s[i]);
                }
            }
}

TEST(RandomSample, LeavesNoGap) {
    const std::vector<Index> s = RandomSample(Ones(10000), 100, 1);
    ASSERT_EQ(s.size(), 100u);
    for (std::size_t i = 0; i < s.size(); ++i)
        EXPECT_EQ(s[i] / 100, Index(i));
}

TEST(RandomSample, StretchesAreOfEqualMass) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const Index n = 20000, count = 100;
        const std::vector<float> mass = RandomMasses(n, seed);
        const std::vector<Index> s = RandomSample(mass, count, seed);
        ASSERT_EQ(Index(s.size()), count);
        const double stretch = std::accumulate(mass.begin(), mass.end(), 0.0) / count;
        double before = 0;
        Index u = 0;
        for (Index i = 0; i < count; ++i) {
            for (; u < s[i]; ++u)
                before += mass[u];
            EXPECT_LE(before, (i + 1) * stretch * (1 + 1e-9)) << "of seed " << i;
            EXPECT_GE(before + mass[s[i]], i * stretch * (1 - 1e-9)) << "of seed " << i;
        }
    }
}

TEST(RandomSample, ANodeIsChosenAsOftenAsItsMassSays) {
    const std::vector<float> mass{1, 0, 3, 0.5f, 0, 5.5f};
    std::vector<double> chosen(mass.size(), 0);
    const int runs = 20000;
    for (int seed = 0; seed < runs; ++seed)
        for (Index u : RandomSample(mass, 1, unsigned(seed)))
            chosen[u] += 1.0 / runs;
    for (std::size_t u = 0; u < mass.size(); ++u)
        EXPECT_NEAR(chosen[u], mass[u] / 10, mass[u] > 0 ? 0.015 : 0) << u;
}

TEST(RandomSample, OfAllNodesIsAllThatHaveAMass) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        std::vector<float> mass = RandomMasses(300, seed);
        std::vector<Index> expected;
        float least = 1;
        for (Index u = 0; u < 300; ++u)
            if (mass[u] > 0) {
                expected.push_back(u);
                least = std::min(least, mass[u]);
            }
        const double sum = std::accumulate(mass.begin(), mass.end(), 0.0);
        EXPECT_EQ(RandomSample(mass, Index(2.01 * sum / least), seed), expected);
    }
    EXPECT_TRUE(RandomSample({0, 0, 0}, 5, 1).empty());
    EXPECT_TRUE(RandomSample({}, 5, 1).empty());
}

TEST(RandomSample, DependsOnTheSeedAlone) {
    EXPECT_EQ(RandomSample(Ones(1000), 50, 3), RandomSample(Ones(1000), 50, 3));
    EXPECT_NE(RandomSample(Ones(1000), 50, 3), RandomSample(Ones(1000), 50, 4));
}
