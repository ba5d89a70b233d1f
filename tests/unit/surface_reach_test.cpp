// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h>
#include "test_support.h"

#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;

TEST(SurfaceReach, FindsWhatTheShortestWayReaches) {
    Graph graph;
    const Index n = 120;
    graph.adjacency = RandomGraph(n, 200, 3);
    graph.position = Eigen::Matrix3Xf::Random(3, n);
    // Bellman-Ford, as the oracle.
    std::vector<double> distance(std::size_t(n), std::numeric_limits<double>::infinity());
    distance[7] = distance[90] = 0;
    for (Index round = 0; round < n; ++round)
        for (Index u = 0; u < n; ++u)
            for (Index v : graph.adjacency[u])
                distance[std::size_t(v)] =
                    std::min(distance[std::size_t(v)],
                             distance[std::size_t(u)] + double((graph.position.col(v) - graph.position.col(u)).norm()));
    for (double radius : {0.0, 0.7, 2.0, 100.0}) {
        std::vector<double> distances;
        const std::vector<Index> found = NodesWithin(graph, {7, 90, 7}, radius, Ways::Edges, &distances);
        ASSERT_GE(found.size(), 2U);
        ASSERT_EQ(found.size(), distances.size());
        std::vector<char> isIn(std::size_t(n), 0);
        double last = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
            const Index u = found[k];
            EXPECT_FALSE(isIn[std::size_t(u)]) << "once";
            isIn[std::size_t(u)] = 1;
            EXPECT_GE(distance[std::size_t(u)], last) << "nearest first";
            EXPECT_EQ(distances[k], distance[std::size_t(u)]);
            last = distance[std::size_t(u)];
        }
        for (Index u = 0; u < n; ++u)
            EXPECT_EQ(bool(isIn[std::size_t(u)]), distance[std::size_t(u)] <= radius) << u;
        std::size_t left = (found.size() + 1) / 2;
        const auto isMore = [&](Index u, double far) {
            EXPECT_EQ(far, distance[std::size_t(u)]);
            return --left > 0;
        };
        std::vector<double> few;
        const std::vector<Index> first = NodesWithin(graph, {7, 90, 7}, radius, Ways::Edges, &few, isMore);
        EXPECT_EQ(first, std::vector<Index>(found.begin(), found.begin() + std::ptrdiff_t(found.size() + 1) / 2));
        EXPECT_EQ(few.size(), first.size());
    }
}

TEST(SurfaceReach, AcrossTrianglesItHardlyDependsOnTheMesh) {
    // A sheet whose squares all have the same diagonal.
    const int side = 41, middle = side / 2 * side + side / 2;
    const SurfaceGraph sheet = BuildSurfaceGraph(Read(MeshD(Grid(side, side))).View(), nullptr, {});
    const auto farthestOff = [&](Ways ways) {
        std::vector<double> distances;
        const Index from = sheet.nodeOf[std::size_t(middle)];
        const std::vector<Index> found = NodesWithin(sheet.graph, {from}, 1, ways, &distances);
        EXPECT_EQ(found.size(), std::size_t(side * side));
        double most = 0;
        for (std::size_t k = 1; k < found.size(); ++k) {
            const double straight = (sheet.graph.position.col(found[k]) - sheet.graph.position.col(from)).norm();
            EXPECT_GE(distances[k], 0.9999 * straight);
            EXPECT_GE(distances[k], distances[k - 1]);
            most = std::max(most, distances[k] / straight - 1);
        }
        return most;
    };
    EXPECT_GT(farthestOff(Ways::Edges), 0.35);
    EXPECT_LT(farthestOff(Ways::Surface), 0.05);
}
