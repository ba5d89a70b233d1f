// SPDX-License-Identifier: GPL-3.0-or-later
// Ends of limbs, and pairs of them on two surfaces.
#include "test_support.h"
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_ends.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace vcg::fcd {
namespace {

using Eigen::Vector3d;

struct Places {
    std::vector<Vector3d> place, normal;
};

/// A ball with a spike in each direction. \param turned each about the z axis, degrees
Places Star(const std::vector<Vector3d> &spike, const std::vector<double> &turned = {}) {
    Places star;
    const int n = 4000;
    for (int i = 0; i < n; ++i) { // Fibonacci's lattice: even points on the ball
        const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z), a = i * detail::pi * (3 - std::sqrt(5.0));
        star.normal.emplace_back(r * std::cos(a), r * std::sin(a), z);
        star.place.emplace_back(0.15 * star.normal.back());
    }
    for (std::size_t k = 0; k < spike.size(); ++k)
        for (int i = 0; i < 300; ++i) { // and along each spike, on a thin cone
            const double along = (i + 0.5) / 300, a = i * detail::pi * (3 - std::sqrt(5.0));
            const Vector3d way = spike[k].normalized(), across = way.unitOrthogonal(),
                           out = std::cos(a) * across + std::sin(a) * way.cross(across);
            const Eigen::AngleAxisd turn(k < turned.size() ? turned[k] * detail::pi / 180 : 0, Vector3d::UnitZ());
            star.place.emplace_back(turn * (0.14 * way + 0.3 * along * way + 0.02 * (1 - along) * out));
            star.normal.emplace_back(turn * out);
        }
    return star;
}

const std::vector<Vector3d> five = {{1, 0, 0}, {0.5, 1, 0.1}, {-1, 0.4, 0}, {-0.2, -1, 0.3}, {0.1, 0.2, 1}};

TEST(FitEnds, AreThoseOfTheLimbs) {
    const Places star = Star(five);
    const std::vector<LimbEnd> ends = EndsOfLimbs(star.place, star.normal);
    ASSERT_EQ(ends.size(), five.size());
    for (const LimbEnd &end : ends) {
        EXPECT_EQ(end.at, star.place[end.place]);
        EXPECT_GT(end.at.norm(), 0.42);
        EXPECT_GT(end.remote, 0.3);
    }
}

TEST(FitEnds, ABallHasNone) {
    const Places ball = Star({});
    EXPECT_TRUE(EndsOfLimbs(ball.place, ball.normal).empty());
}

TEST(FitEnds, BelongTogetherByHowRemoteTheyAreAndWhereTheyLie) {
    // The first two spikes are turned, the first towards the old place of the second.
    const Places from = Star(five), to = Star(five, {25, 25});
    const std::vector<LimbEnd> a = EndsOfLimbs(from.place, from.normal), b = EndsOfLimbs(to.place, to.normal);
    const auto pairs = MatchEnds(a, b);
    ASSERT_EQ(pairs.size(), five.size()) << a.size() << " " << b.size();
    for (const auto &[i, j] : pairs)
        EXPECT_EQ(a[i].place, b[j].place);
}

TEST(FitEnds, WhatIsTooFarHasNone) {
    const LimbEnd here{0, Vector3d(0, 0, 0), 0.5}, beside{1, Vector3d(0.1, 0, 0), 0.5},
        far{2, Vector3d(0.5, 0, 0), 0.5}, unlike{3, Vector3d(0, 0, 0), 0.9};
    EXPECT_TRUE(MatchEnds({here}, {far}).empty());
    EXPECT_TRUE(MatchEnds({here}, {unlike}).empty());
    EXPECT_TRUE(MatchEnds({}, {here}).empty());
    EXPECT_TRUE(MatchEnds({here}, {}).empty());
    // One is left, the worse one
    const std::vector<std::pair<std::size_t, std::size_t>> one = MatchEnds({beside, here}, {here});
    ASSERT_EQ(one.size(), 1);
    EXPECT_EQ(one[0], std::make_pair(std::size_t(1), std::size_t(0)));
}

// The least sum of all possible pairings.
TEST(FitEnds, ThePairsAreTheBest) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(0, 0.2);
    for (int round = 0; round < 50; ++round) {
        std::vector<LimbEnd> a, b;
        for (std::size_t i = 0; i < 5; ++i) {
            a.push_back({i, Vector3d(any(random), any(random), any(random)), any(random)});
            b.push_back({i, Vector3d(any(random), any(random), any(random)), any(random)});
        }
        const auto cost = [&](std::size_t i, std::size_t j) {
            return (a[i].at - b[j].at).squaredNorm() + 4 * detail::Squared(a[i].remote - b[j].remote);
        };
        double sum = 0, least = 1e9;
        for (const auto &[i, j] : MatchEnds(a, b))
            sum += cost(i, j);
        std::vector<std::size_t> order = {0, 1, 2, 3, 4};
        do {
            double all = 0;
            for (std::size_t i = 0; i < 5; ++i)
                all += cost(i, order[i]);
            least = std::min(least, all);
        } while (std::next_permutation(order.begin(), order.end()));
        EXPECT_NEAR(sum, least, 1e-12);
    }
}

TEST(FitEnds, FewPlacesAreNoError) {
    EXPECT_TRUE(EndsOfLimbs({}, {}).empty());
    EXPECT_LE(EndsOfLimbs({{1, 2, 3}}, {{0, 0, 1}}).size(), 1);
    EXPECT_LE(EndsOfLimbs({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 0, 1}, {0, 0, -1}, {0, 0, 0}}).size(), 3);
    std::vector<Vector3d> line, none;
    for (int i = 0; i < 100; ++i) {
        line.emplace_back(i * 0.01, 0, 0);
        none.emplace_back(0, 0, 0);
    }
    EXPECT_EQ(EndsOfLimbs(line, none).size(), 2);
}

} // namespace
} // namespace vcg::fcd
