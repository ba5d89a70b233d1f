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

TEST(Frame, BoxWithoutStraysIsThatOfARasterWhateverItsShape) {
    const auto boxOf = [](std::size_t rows, std::size_t columns, const std::vector<Eigen::Vector3d> &strays) {
        const std::size_t n = rows * columns;
        const auto at = [&](std::size_t i) {
            return i < n ? Eigen::Vector3d(double(i % columns), double(i / columns), 0) : strays[i - n];
        };
        Eigen::AlignedBox3d box(at(0));
        box.extend(at(n - 1));
        for (const Eigen::Vector3d &stray : strays)
            box.extend(stray);
        return detail::WithoutStrays(box, n + strays.size(), at);
    };
    for (const auto &[rows, columns] : {std::pair<std::size_t, std::size_t>(8192, 512),
                                        {512, 8192},
                                        {4096, 256},
                                        {1000, 1000},
                                        {3, 100000},
                                        {100000, 3},
                                        {2, 2}}) {
        const Eigen::Vector3d last(double(columns - 1), double(rows - 1), 0);
        const Eigen::AlignedBox3d box = boxOf(rows, columns, {});
        EXPECT_EQ(box.min(), Eigen::Vector3d::Zero()) << rows << " x " << columns;
        EXPECT_EQ(box.max(), last) << rows << " x " << columns;
    }
    for (const double far : {1e3, 1e6, 1e9}) {
        const Eigen::AlignedBox3d box =
            boxOf(8192, 512, {{far * 1e4, 0, 0}, {0, -far * 1e4, far}, {far, far, 1e4 * far}});
        EXPECT_LE(box.diagonal().norm(), 16 * std::hypot(8191, 511)) << far;
        EXPECT_TRUE(box.contains(Eigen::Vector3d::Zero()) && box.contains(Eigen::Vector3d(511, 8191, 0))) << far;
    }
}
