// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/solve/graph_deformer.h>
#include <vcg_ext/solve/graph_pose.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(FitLinear, FindsTheMapOfTheGraph) {
    const Rig rig(Grid(20, 20, 0.2), 0.6, [](const Vector3d &p) { return p[0] < 1 ? 0 : 1; });
    Matrix3d map; // in the plane
    map << 1.3, 0.2, 0, -0.1, 0.9, 0, 0, 0, 1;
    GraphPose pose;
    pose.position = map * rig.graph.graph.position.cast<double>();
    pose.linear.assign(rig.graph.Size(), Matrix3d::Identity());
    GraphPose fitted = pose;
    FitLinear(rig.graph, rig.constrained, fitted);
    for (Index j = 0; j < rig.graph.Size(); ++j) {
        if (rig.constrained[j]) {
            EXPECT_EQ(fitted.linear[j], pose.linear[j]);
        } else {
            EXPECT_LT((fitted.linear[j] - map).norm(), 0.3 * (pose.linear[j] - map).norm());
            EXPECT_LE((fitted.linear[j].col(2) - Vector3d::UnitZ()).norm(), 1e-6) << "open across the plane";
        }
    }
    const Matrix3d rotation = RandomRigid(1).linear();
    pose.position = rotation * rig.graph.graph.position.cast<double>();
    pose.linear.assign(rig.graph.Size(), rotation);
    FitLinear(rig.graph, std::vector<bool>(rig.graph.Size()), pose);
    for (const Matrix3d &linear : pose.linear)
        EXPECT_LE((linear - rotation).norm(), 1e-6);
}

TEST(FitLinear, KeepsTheRotationWhereThereAreNoEdges) {
    Rig rig(Jittered(Tube(40, 16), 0.05), 0.6, [](const Vector3d &p) { return TubeTag(p); });
    rig.graph.graph.position.setZero();
    GraphPose pose;
    pose.position = rig.graph.graph.position.cast<double>();
    pose.linear.assign(rig.graph.Size(), RandomRigid(2).linear());
    const std::vector<Matrix3d> before = pose.linear;
    FitLinear(rig.graph, std::vector<bool>(rig.graph.Size()), pose);
    EXPECT_EQ(pose.linear, before);
}

TEST(MeasureEnergy, IsWhatTheSolverMinimises) {
    const Rig rig(Jittered(Tube(40, 16), 0.05), 0.6, [](const Vector3d &p) { return TubeTag(p); });
    const Eigen::Affine3d bend = RandomRigid(3);
    const std::vector<Eigen::Affine3d> motion =
        rig.NodeMotion([&](Index tag) { return tag == 0 ? Eigen::Affine3d::Identity() : bend; });
    const SolverParam param;
    const double area = 3;
    GraphPose pose = GraphDeformer(rig.graph, rig.constrained, area).Solve(motion, param);
    const GraphPose solved = pose;
    ASSERT_GT(solved.energy, 0);
    MeasureEnergy(rig.graph, param.smoothness * area, pose);
    EXPECT_NEAR(pose.energy, solved.energy, 1e-6 * solved.energy);
    for (Index j = 0; j < rig.graph.Size(); ++j)
        EXPECT_NEAR(pose.nodeEnergy[std::size_t(j)], solved.nodeEnergy[std::size_t(j)], 1e-6 * solved.energy);

    pose.position = bend * rig.graph.graph.position.cast<double>();
    pose.linear.assign(std::size_t(rig.graph.Size()), bend.linear());
    MeasureEnergy(rig.graph, param.smoothness * area, pose);
    EXPECT_LE(pose.energy, 1e-12 * solved.energy) << "one motion of all";
}
