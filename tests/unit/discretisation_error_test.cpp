// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/graph/coarse_graph.h>
#include <vcg_ext/solve/patch_number.h>
#include "test_support.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Sum of w e e^T over the edges between free nodes: the stiffness in each direction.
static Matrix3d CarriedBy(const DeformationGraph &graph) {
    Matrix3d sum = Matrix3d::Zero();
    for (Index i = 0; i < graph.Size(); ++i)
        for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e)
            if (!graph.IsHeld(i) || !graph.IsHeld(graph.graph.adjacency.item[e])) {
                const Vector3d way = graph.edge.col(e).cast<double>();
                sum += 0.5 * double(graph.weight[e]) * way * way.transpose();
            }
    return sum;
}

TEST(CoarseGraph, CarriesWhatTheFineOneDoesWithAFourthOfTheNodes) {
    const Rig rig(Jittered(Grid(60, 60, 0.1), 0.03), 0.25, [](const Vector3d &p) {
        return p[0] < 1 ? 0 : p[0] > 5 ? 2 : 1;
    });
    const std::vector<double> area(rig.graph.Size(), 1);
    const CoarseGraph coarse = Coarsen(rig.graph, area, rig.constrained, GraphWeights::Border);
    Index free = 0, groups = 0;
    for (Index i = 0; i < rig.graph.Size(); ++i)
        free += !rig.constrained[i];
    for (Index leader : coarse.leader)
        groups += !rig.constrained[leader];
    EXPECT_GT(free, 3 * groups);
    EXPECT_LT(free, 6 * groups);
    for (Index i = 0; i < rig.graph.Size(); ++i) {
        const Index leader = coarse.leader[coarse.groupOf[i]];
        if (rig.constrained[i]) {
            EXPECT_EQ(leader, i);
        }
        const Csr::Row row = rig.graph.graph.adjacency[leader];
        EXPECT_TRUE(leader == i || std::binary_search(row.begin(), row.end(), i));
    }
    ExpectAdjacencyInOrder(coarse.graph.graph.adjacency);
    const Matrix3d fine = CarriedBy(rig.graph), less = CarriedBy(coarse.graph);
    EXPECT_LE((less - fine).norm(), 0.05 * fine.norm());
}

/// The true and the estimated distance of a pose with \p patches from that with a node at every vertex; rms over the
/// free vertices, over the diagonal of the nodes.
static std::pair<double, double> ErrorOf(const Case &c, int patches) {
    const MeshD mesh(c.shape);
    DeformationParam param;
    param.graph.initialPatches = patches;
    const DeformationResult some = vcg::tri::DeformCentroidal(mesh, c.handles, param);
    param.graph.initialPatches = 20 * c.shape.Size();
    const DeformationResult all = vcg::tri::DeformCentroidal(mesh, c.handles, param);
    EXPECT_GT(5 * all.rest.position.cols(), 4 * all.tags.free);
    double sum = 0, free = 0;
    for (int i = 0; i < c.shape.Size(); ++i)
        if (c.handles.tag[i] == 1) {
            sum += (some.position.col(i) - all.position.col(i)).squaredNorm();
            ++free;
        }
    const auto &nodes = some.rest.position;
    return {std::sqrt(sum / free) / (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm(),
            some.discretisationError};
}

TEST(DiscretisationError, IsAThirdToThreeTimesWhatItEstimates) {
    Shape waves = Grid(50, 30, 0.2);
    for (Vector3d &p : waves.position)
        p[2] = 0.2 * std::sin(2 * p[0] + p[1]);
    const auto ends = [](int axis, double low, double high) {
        return [=](const Vector3d &p) { return p[axis] < low ? 0 : p[axis] > high ? 2 : 1; };
    };
    const Affine3d twist(Eigen::AngleAxisd(1, Vector3d::UnitX()));
    const Case tube = CaseOf(Tube(50, 40), ends(2, 0.7, 5.3)), ball = CaseOf(Sphere(40, 50), ends(2, -0.8, 0.8)),
               sheet = CaseOf(waves, ends(0, 0.8, 9), twist);
    for (int patches : {30, 100})
        for (const Case &c : {tube, ball, sheet}) {
            const auto [error, estimate] = ErrorOf(c, patches);
            EXPECT_GT(estimate, error / 3) << patches;
            EXPECT_LT(estimate, 3 * error) << patches;
        }
}

TEST(DiscretisationError, IsNothingWhereNothingMovesAndUnknownForOneNode) {
    Case c = CaseOf(Tube(24, 20), [](const Vector3d &p) { return TubeTag(p); });
    DeformationParam param;
    param.graph.initialPatches = 1;
    param.graph.targetRadius = 100;
    EXPECT_TRUE(std::isnan(vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).discretisationError));
    param = {};
    const Case nowhere = CaseOf(Moved(Tube(24, 20), Affine3d(Eigen::Scaling(0.0))), [](const Vector3d &) { return 1; });
    Handles held = nowhere.handles;
    held.tag[0] = 2;
    held.motion[2] = Motion(bend.matrix());
    EXPECT_FALSE(vcg::tri::DeformCentroidal(MeshD(nowhere.shape), held, param).discretisationError > 0);
    EXPECT_GT(vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).discretisationError, 0);
    c.handles.motion.clear();
    EXPECT_EQ(vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).discretisationError, 0);
}

/// A band that winds to and fro, as wide as a cell: few patches lie on each run.
static Case BandCase() {
    Shape band;
    std::map<std::pair<int, int>, int> number;
    const auto corner = [&](int a, int b) {
        const auto found = number.emplace(std::make_pair(a, b), band.Size());
        if (found.second)
            band.position.emplace_back(a, b, 0);
        return found.first->second;
    };
    for (int a = 0; a < 61; ++a)
        for (int b = 0; b < 31; ++b)
            if (a % 2 == 0 || b == (a % 4 == 1 ? 0 : 30)) {
                const int q[4] = {corner(a, b), corner(a + 1, b), corner(a + 1, b + 1), corner(a, b + 1)};
                band.face.push_back({q[0], q[1], q[2]});
                band.face.push_back({q[0], q[2], q[3]});
            }
    const Eigen::Translation3d middle(58, 15, 0);
    return CaseOf(
        band, [](const Vector3d &p) { return p[0] < 6    ? 0
                                             : p[0] > 55 ? 2
                                                         : 1; },
        middle * Eigen::AngleAxisd(1, Vector3d::UnitZ()) * middle.inverse());
}

static Eigen::Index NodesOf(const Case &c, const DeformationParam &param) {
    return vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).rest.position.cols();
}

TEST(AutomaticPatches, AreMoreWhereFewBendTheSurfaceOtherwise) {
    const Case c = BandCase();
    EXPECT_LT(ErrorOf(c, 0).first, ErrorOf(c, GraphParam().Patches()).first / 3);
}

TEST(AutomaticPatches, AreFewWhereNothingBends) {
    const Case held = CaseOf(Tube(50, 40), [](const Vector3d &p) { return p[2] > 5.3 ? 2 : 1; }),
               bent = CaseOf(Tube(50, 40), [](const Vector3d &p) { return p[2] < 0.7   ? 0
                                                                          : p[2] > 5.3 ? 2
                                                                                       : 1; });
    DeformationParam few, many;
    few.graph.initialPatches = fewPatches;
    many.graph.initialPatches = mostPatches;
    EXPECT_EQ(NodesOf(held, {}), NodesOf(held, few)); // one motion moves all of it
    EXPECT_GT(NodesOf(bent, {}), NodesOf(bent, few));
    EXPECT_LT(NodesOf(bent, {}), NodesOf(bent, many));
}

/// \p n rows of a wavy sheet, its ends held.
static Case SheetCase(int n) {
    Shape sheet = Grid(8 * n / 5, n, 5.0 / n);
    for (Vector3d &p : sheet.position)
        p[2] = 0.03 * std::sin(2 * p[0] + p[1]);
    return CaseOf(sheet, [](const Vector3d &p) { return p[0] < 0.4 ? 0 : p[0] > 7.6 ? 2 : 1; });
}

TEST(AutomaticPatches, AreAsManyHoweverDenselyASurfaceIsSampled) {
    std::vector<double> nodes;
    for (int n : Rounds({80, 160, 320}))
        nodes.push_back(double(NodesOf(SheetCase(n), {})));
    const auto [least, most] = std::minmax_element(nodes.begin(), nodes.end());
    EXPECT_LT(*most, 1.6 * *least); // estimates of graphs of a hundred nodes differ by a third
}

static int samplings = 0;
static std::string stageBefore;

static bool CountSamplings(const int, const char *stage) {
    samplings += stage != stageBefore && stage == std::string("Sampling patches");
    stageBefore = stage;
    return true;
}

TEST(AutomaticPatches, AreSampledAsOftenForAnySeed) {
    const Case c = CaseOf(Tube(50, 40), [](const Vector3d &p) { return p[2] < 0.7 ? 0 : p[2] > 5.3 ? 2 : 1; });
    for (unsigned seed : {1, 5}) {
        DeformationParam param;
        param.graph.randomSeed = seed;
        samplings = 0;
        stageBefore.clear();
        vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param, Progress(CountSamplings));
        EXPECT_EQ(samplings, 2) << "few, and as many as are wanted";
    }
}

TEST(AutomaticPatches, AreAsManyForAnyPoseAndSeedAndAnyThreads) {
    Case c = BandCase();
    DeformationParam param;
    const Eigen::Index many = NodesOf(c, param);
    param.graph.randomSeed = 2;
    EXPECT_LT(std::abs(double(NodesOf(c, param) - many)), 0.1 * double(many));
    param.graph.randomSeed = 1;
    Progress one;
    one.threads = 1;
    const MeshD mesh(c.shape);
    EXPECT_EQ(vcg::tri::DeformCentroidal(mesh, c.handles, param, one).position,
              vcg::tri::DeformCentroidal(mesh, c.handles, param).position);
    c.handles.motion.clear();
    EXPECT_EQ(NodesOf(c, param), many);
}

TEST(AutomaticPatches, AreThoseThatArePickedOnceANumberARadiusOrThePaperIs) {
    const Case c = BandCase();
    const Eigen::Index many = NodesOf(c, {});
    DeformationParam param;
    param.graph.initialPatches = GraphParam().Patches();
    const Eigen::Index few = NodesOf(c, param);
    EXPECT_LT(few, many / 2 + 100);
    param.graph.initialPatches = 0;
    param.graph.targetRadius = 4;
    EXPECT_LE(NodesOf(c, param), few);
    param.graph.targetRadius = 0;
    param.graphWeights = GraphWeights::Printed;
    EXPECT_LE(NodesOf(c, param), few);
}
