// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/symmetrize.h>
#include <vcg_ext/symmetry/half_pose.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace vcg::fcd;

/// A chain of nodes along x, of length 1.
DeformationGraph Chain(Index n) {
    DeformationGraph graph;
    graph.graph.position.resize(3, n);
    graph.graph.adjacency.begin.assign(1, 0);
    for (Index j = 0; j < n; ++j) {
        graph.graph.position.col(j) = Eigen::Vector3f(float(j) / float(n - 1), 0, 0);
        for (Index i : {j - 1, j + 1})
            if (i >= 0 && i < n)
                graph.graph.adjacency.item.push_back(i);
        graph.graph.adjacency.begin.push_back(std::uint32_t(graph.graph.adjacency.item.size()));
    }
    graph.weight.assign(graph.graph.adjacency.item.size(), 1.f);
    return graph;
}

double LengthOf(const GraphPose &pose) {
    double length = 0;
    for (Index j = 1; j < pose.position.cols(); ++j)
        length += (pose.position.col(j) - pose.position.col(j - 1)).norm();
    return length;
}

TEST(HalfPose, OfABendIsABendByHalf) {
    const Index n = 101;
    const DeformationGraph graph = Chain(n);
    const double angle = 2; // from end to end, radians
    GraphPose full;
    full.position.resize(3, n);
    for (Index j = 0; j < n; ++j) {
        const double turn = angle * double(j) / double(n - 1);
        full.position.col(j) = Eigen::Vector3d(std::sin(turn), 1 - std::cos(turn), 0) / angle;
        full.linear.push_back(detail::RotationBy(turn, Eigen::Vector3d::UnitZ()));
    }
    const GraphPose half = HalfPose(graph, full);
    EXPECT_NEAR(LengthOf(half), 1, 1e-3); // the middle of the positions would be shorter
    const double chord = (half.position.col(n - 1) - half.position.col(0)).norm();
    EXPECT_NEAR(chord, std::sin(angle / 4) / (angle / 4), 1e-3);
    EXPECT_LT((half.linear[100] - detail::RotationBy(angle / 2, Eigen::Vector3d::UnitZ())).norm(), 1e-12);
    // Half of the way back is the same shape.
    DeformationGraph bent = graph;
    GraphPose back = full;
    for (Index j = 0; j < n; ++j) {
        bent.graph.position.col(j) = full.position.col(j).cast<float>();
        back.position.col(j) = graph.graph.position.col(j).cast<double>();
        back.linear[std::size_t(j)] = full.linear[std::size_t(j)].transpose().eval();
    }
    EXPECT_LT((HalfPose(bent, back).position - half.position).norm(), 1e-5);
}

TEST(MirrorPlane, IsWhatPairsTell) {
    const MirrorPlane truth{Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, -2) / 3};
    const Eigen::Vector3d a(5, 1, 0), b(2, 7, 1);
    bool isTold = false;
    for (const MirrorPairs &pairs : {MirrorPairs{{a, truth(a)}}, MirrorPairs{{a, truth(a)}, {b, truth(b)}},
                                     MirrorPairs{{truth.Onto(a), truth.Onto(a)}, {b, truth(b)}}}) {
        const MirrorPlane plane = PlaneOf(pairs, {}, isTold);
        EXPECT_TRUE(isTold);
        EXPECT_NEAR(std::abs(plane.normal.dot(truth.normal)), 1, 1e-12);
        EXPECT_NEAR(truth.Above(plane.point), 0, 1e-12);
    }
    PlaneOf({{a, a}, {b, b}}, {}, isTold);
    EXPECT_FALSE(isTold); // any plane through both
}

TEST(SmoothWarp, ComesBackAndKnowsItsSlope) {
    SmoothWarp warp(Eigen::Vector3d(1, 0, 0), 2, 4);
    warp.coefficient.setRandom();
    warp.coefficient *= 0.01;
    const Eigen::Vector3d p(1.5, -0.7, 0.9), step(1e-6, 2e-6, -1e-6);
    EXPECT_LT((warp.Back(warp.At(p), warp.At(p)) - p).norm(), 1e-12);
    EXPECT_LT((warp.At(p + step) - warp.At(p) - warp.LinearAt(p) * step).norm(), 1e-11);
}

} // namespace
