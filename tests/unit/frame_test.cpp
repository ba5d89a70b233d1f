// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/frame.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;

TEST(Frame, MeasuresInTheWorld) {
    Frame frame;
    frame.SetMetric((Eigen::Matrix3d() << 2, 0.5, 0, 0, 1, 0, 0, 0, 3).finished());
    frame.origin = Eigen::Vector3d(1, 2, 3);
    frame.scale = 4;
    const Eigen::Vector3d p(5, -6, 7);
    EXPECT_LE((frame.FromFrame(frame.ToFrame(p)) - p).norm(), 1e-14);
    Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
    motion.topRows<3>() << 0.1, 0.9, 0, 1, -0.8, 0, 0.2, 2, 0, 0, 1, 3;
    const Eigen::Vector3d moved = (motion * p.homogeneous()).head<3>();
    EXPECT_LE((frame.ToFrame(motion) * frame.ToFrame(p) - frame.ToFrame(moved)).norm(), 1e-13);
    EXPECT_LE((frame.FromFrame(frame.ToFrame(motion)) - motion).norm(), 1e-13);
    EXPECT_NE(MessageOf<Error>([&] { frame.SetMetric(Eigen::Matrix3d::Zero()); }).find("flattens"), std::string::npos);
}
