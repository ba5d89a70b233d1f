// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/compensate.h>
#include <vcg_ext/surface/read_surface.h>
#include <vcg_ext/symmetrize.h>
#include <vcg_ext/symmetry/half_pose.h>
#include <vcg_ext/warp/smooth_warp.h>

#include "test_mesh.h"
#include "test_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>
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
    // Half-way back is the same shape.
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

// x + x^2 / 4, scaled: it turns back at x = -2. What it never reaches stays where it is.
TEST(SmoothWarp, StaysWhereItCannotComeBack) {
    SmoothWarp warp(Eigen::Vector3d::Zero(), 1, 2);
    warp.coefficient(0, 4) = 0.25;
    const Eigen::Vector3d p(0.8, 0.1, 0.2), never(-1.2, 0, 0), fold(-2, 0, 0);
    ASSERT_NEAR(warp.At(p)[0], 0.96, 1e-12);
    EXPECT_LT((warp.Back(warp.At(p), warp.At(p)) - p).norm(), 1e-12);
    EXPECT_EQ(warp.Back(never, never), never);
    EXPECT_LT((warp.LinearBack(p) * warp.LinearAt(p) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_EQ(warp.LinearBack(fold), Eigen::Matrix3d::Identity());
}

TEST(SmoothWarp, RestsWhereNoiseIsLeft) {
    // Places that stray as far as their neighbours are apart: matches with the nearest target go on changing.
    std::uint32_t state = 1;
    const auto random = [&state] {
        Eigen::Vector3d p;
        for (int d = 0; d < 3; ++d) {
            state = 1664525 * state + 1013904223;
            p[d] = double(state >> 8) / (1 << 24);
        }
        return p;
    };
    std::vector<Eigen::Vector3d> target(300);
    std::generate(target.begin(), target.end(), random);
    WarpGoal goal;
    goal.place.resize(150);
    std::generate(goal.place.begin(), goal.place.end(), random);
    goal.normal.assign(goal.place.size(), Eigen::Vector3d::Zero());
    goal.weight.assign(goal.place.size(), 1);
    std::atomic<int> asked{0};
    goal.match = [&](std::size_t, const Eigen::Vector3d &at) {
        ++asked;
        return WarpMatch{
            *std::min_element(target.begin(), target.end(), [&](const Eigen::Vector3d &a, const Eigen::Vector3d &b) {
                return (a - at).squaredNorm() < (b - at).squaredNorm();
            })};
    };
    WarpReport full, rough;
    FitWarp(goal, {}, &full);
    const int fully = asked.exchange(0);
    goal.rest = 0.1;
    FitWarp(goal, {}, &rough);
    EXPECT_LT(3 * asked, 2 * fully);
    EXPECT_NEAR(rough.misfit, full.misfit, 0.1 * full.misfit);
}

/// A sheet with bumps.
struct Sheet {
    std::vector<double> position;
    std::vector<std::uint32_t> corner;

    explicit Sheet(int n) {
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double x = double(i) / n, y = double(j) / n;
                position.insert(position.end(), {x, y, 0.1 * std::sin(5 * x) * std::cos(4 * y)});
            }
        for (int j = 0; j + 1 < n; ++j)
            for (int i = 0; i + 1 < n; ++i) {
                const auto a = std::uint32_t(j * n + i), b = a + std::uint32_t(n);
                corner.insert(corner.end(), {a, a + 1, b, a + 1, b + 1, b});
            }
    }
    SurfaceView View() const {
        SurfaceView view;
        view.position = position.data();
        view.vertexSlots = position.size() / 3;
        view.corner = corner.data();
        view.faces = corner.size() / 3;
        return view;
    }
};

TEST(Compensation, TellsWhatIsOutOfRange) {
    const Sheet sheet(20);
    CompensateParam param;
    const auto message = [&] {
        return fcd_test::MessageOf<BadInput>([&] { Compensation(sheet.View(), sheet.View(), {}, param); });
    };
    EXPECT_NO_THROW(Compensation(sheet.View(), sheet.View(), {}, param));
    param.degree = 8;
    EXPECT_NE(message().find("degree of the warp must be from 1 to 7"), std::string::npos);
    param = {};
    param.samples = 99;
    EXPECT_NE(message().find("At least 100 places"), std::string::npos);
    param = {};
    param.largestDistance = 0;
    EXPECT_NE(message().find("largest distance of matches must be positive"), std::string::npos);
    Sheet far(20);
    for (double &each : far.position)
        each += 100;
    param.largestDistance = 0.1;
    EXPECT_NE(fcd_test::MessageOf<BadInput>([&] {
                  Compensation(sheet.View(), far.View(), {}, param);
              }).find("counterpart on the scan"),
              std::string::npos);
    Sheet broken(20);
    broken.position[3] = std::nan("");
    EXPECT_NE(fcd_test::MessageOf<BadInput>([&] {
                  Compensation(broken.View(), sheet.View(), {}, CompensateParam());
              }).find("Vertex 1 of the nominal part has a coordinate that is not finite"),
              std::string::npos);
    SurfaceView points = sheet.View();
    points.faces = 0;
    EXPECT_NE(fcd_test::MessageOf<BadInput>([&] {
                  Compensation(points, sheet.View(), {}, param);
              }).find("no triangles with an area"),
              std::string::npos);
    const auto ofScan = [&](std::size_t count, double out) { // the first ones lie on a line
        Sheet few(20);
        few.position.resize(3 * count);
        for (std::size_t i = 0; i < count; ++i)
            few.position[3 * i + 2] = 0;
        few.position[1] += out;
        SurfaceView scan = few.View();
        scan.faces = 0;
        scan.isCloud = true;
        scan.vertexSlots = count;
        return fcd_test::MessageOf<BadInput>([&] { Compensation(sheet.View(), scan, {}, CompensateParam()); });
    };
    for (std::size_t count : {1, 2, 15})
        EXPECT_NE(ofScan(count, 0).find("The whole scan lies at one point or on one line"), std::string::npos);
    EXPECT_NE(ofScan(9, 0.3).find("The scan has 9 points, too few"), std::string::npos);
}

TEST(Symmetrize, FindsThePlaneOfASheetThatWasSheared) {
    Sheet sheet(16);
    for (std::size_t i = 0; i < sheet.position.size(); i += 3) {
        const double x = sheet.position[i] - 0.5, y = sheet.position[i + 1];
        sheet.position[i + 2] = 0.8 * x * x + 0.15 * std::sin(3 * y) + 0.15 * std::cos(9 * x) * y;
        sheet.position[i] += 0.2 * sheet.position[i + 2];
    }
    const NormalOf none = [](std::size_t) { return Eigen::Vector3d::Zero(); };
    for (const bool isCloud : {false, true}) {
        SurfaceView view = sheet.View();
        view.isCloud = isCloud;
        view.faces = isCloud ? 0 : view.faces;
        Handles handles;
        handles.tag.assign(view.vertexSlots, 1);
        const Fitter fitter(view, none, handles, FitParam());
        SymmetryReport report;
        const SymmetricPose pose = Symmetrize(fitter, view, none, Eigen::Affine3d::Identity(), {}, report);
        EXPECT_TRUE(!report.isGiven && !report.isOfLandmarks);
        EXPECT_GT(std::abs(report.plane.normal.x()), 0.98) << isCloud;
        EXPECT_GT(report.moved, 0.01);
        EXPECT_LT(report.fit.nearest, 0.2 * report.moved);
    }
}

TEST(Symmetrize, TakesThePlaneThatAllPointsAgreeWith) {
    // A body that is about as much its own mirror image along y as along x, but for feet at one end.
    fcd_test::Shape body = fcd_test::Sphere(50, 50);
    for (Eigen::Vector3d &p : body.position) {
        const double wide = 0.3 * (1 + 0.3 * p[2]), feet = std::max(0., -0.9 - p[2]);
        p = {wide * p[0], 0.5 * wide * p[1] + 3 * feet, p[2]};
    }
    const auto mesh = fcd_test::MeshOf<fcd_test::VertexD, fcd_test::EdgeD, fcd_test::FaceD>(body);
    const SurfaceArrays arrays = vcg::tri::ReadSurface(mesh);
    const NormalOf none = [](std::size_t) { return Eigen::Vector3d::Zero(); };
    Handles handles;
    handles.tag.assign(body.position.size(), 1);
    const Fitter fitter(arrays.View(), none, handles, FitParam());
    SymmetryReport report;
    Symmetrize(fitter, arrays.View(), none, Eigen::Affine3d::Identity(), {}, report);
    EXPECT_GT(std::abs(report.plane.normal.x()), 0.9) << report.plane.normal.transpose();
}

TEST(Symmetrize, TellsWhichLandmarkIsWrong) {
    const Sheet sheet(20);
    Handles handles;
    handles.tag.assign(sheet.View().vertexSlots, 1);
    const Fitter fitter(sheet.View(), {}, handles, FitParam());
    const auto message = [&](const SymmetryGoal &goal) {
        SymmetryReport report;
        return fcd_test::MessageOf<BadInput>(
            [&] { Symmetrize(fitter, sheet.View(), {}, Eigen::Affine3d::Identity(), goal, report); });
    };
    const auto mark = [&](std::size_t i) { return SymmetryMark{i, Eigen::Vector3d::Zero()}; };
    SymmetryGoal goal;
    goal.midline = {mark(400)};
    EXPECT_NE(message(goal).find("Vertex 400 of the pairs or the midline is no vertex"), std::string::npos);
    goal.midline = {mark(1), mark(1)};
    EXPECT_NE(message(goal).find("Vertex 1 is named twice"), std::string::npos);
    goal.midline.clear();
    goal.plane = MirrorPlane{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    EXPECT_NE(message(goal).find("The plane has no direction"), std::string::npos);
}

} // namespace
