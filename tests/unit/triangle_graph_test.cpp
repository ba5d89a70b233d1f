// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/triangle_graph.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;

TEST(TriangleGraph, JoinsMoreNodesThanAThousandBlocksOfTheSmallestSizeHold) {
    const Index n = 5000000;
    const std::vector<Index> corner{0, 1, n - 1, n / 2, n / 2 + 1, n - 1};
    const vcg::fcd::detail::TriangleGraph g =
        vcg::fcd::detail::ConnectTriangles(Eigen::Matrix3Xf::Zero(3, n), corner.data(), 2, Threads(2));
    ASSERT_EQ(g.adjacency.Size(), n);
    EXPECT_EQ(g.adjacency.item,
              (std::vector<Index>{1, n - 1, 0, n - 1, n / 2 + 1, n - 1, n / 2, n - 1, 0, 1, n / 2, n / 2 + 1}));
    const std::vector<std::pair<Index, std::uint32_t>> firstItemOf{
        {0, 0}, {1, 2}, {2, 4}, {n / 2, 4}, {n / 2 + 1, 6}, {n / 2 + 2, 8}, {n - 1, 8}, {n, 12}};
    for (const auto &[node, item] : firstItemOf)
        EXPECT_EQ(g.adjacency.begin[node], item) << node;
}
