// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/deformer.h>
#include <vcg_ext/solve/affine_deformer.h>
#include "test_support.h"

#include <algorithm>
#include <numeric>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using vcg::fcd::detail::RotationOf;

namespace {

Rig AffineRig() {
    return Rig(Jittered(Tube(40, 16), 0.05), 0.6, [](const Vector3d &p) { return TubeTag(p); });
}

Affine3d BendRig(Index tag) { return tag == 0 ? Affine3d::Identity() : bend; }

SolverParam WithRigidity(double rigidity) {
    SolverParam param;
    param.rigidity = rigidity;
    return param;
}

GraphPose SolvedBy(const Rig &rig, const std::vector<Affine3d> &motion, const SolverParam &param) {
    return AffineDeformer(rig.graph, rig.constrained, rig.surface.area, {}, {}, 0.75, param).Solve(motion, param);
}

/// Eq. 2 with affine maps, each edge's difference of maps counted once, plus the cost of their stretch.
double AffineEnergy(const Rig &rig, const std::vector<Affine3d> &motion, const GraphPose &pose, double smooth,
                    double rigidity) {
    const DeformationGraph &g = rig.graph;
    const Csr &adjacency = g.graph.adjacency;
    double energy = 0;
    for (Index i = 0; i < g.Size(); ++i) {
        double mass = 0;
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
            const Index j = adjacency.item[e];
            const Vector3d edge = g.edge.col(e).cast<double>();
            const Vector3d rest[2] = {g.graph.position.col(i).cast<double>(), g.graph.position.col(j).cast<double>()};
            Vector3d from = pose.position.col(i), to = pose.position.col(j);
            if (rig.constrained[i] && !rig.constrained[j])
                from = motion[i] * Vector3d(rest[1] + edge);
            else if (rig.constrained[j] && !rig.constrained[i])
                to = motion[j] * Vector3d(rest[0] - edge);
            energy += g.weight[e] * (from - to - pose.linear[i] * edge).squaredNorm();
            energy += g.weight[e] * smooth * 0.5 * (pose.linear[i] - pose.linear[j]).squaredNorm();
            mass += g.weight[e] * edge.squaredNorm();
        }
        if (!rig.constrained[i])
            energy += rigidity / (1 - rigidity) * mass * (pose.linear[i] - RotationOf(pose.linear[i])).squaredNorm();
    }
    return energy;
}

Affine3d RandomAffine(unsigned seed) {
    std::mt19937 random(seed);
    Affine3d affine(RandomRotation(random));
    for (int d = 0; d < 3; ++d)
        affine.linear().col(d) += 0.3 * RandomVector(random);
    affine.translation() = RandomVector(random);
    return affine;
}

/// Landmarks all over a shape, with targets by \p place.
template <class Place>
Handles PointsAt(const Shape &shape, int count, const Place &place) {
    Handles handles;
    handles.tag.assign(shape.position.size(), 1);
    for (int i = 0; i < count; ++i) {
        const std::size_t vertex = std::size_t(i) * 7919 % shape.position.size();
        handles.point.push_back({vertex, place(shape.position[vertex])});
    }
    return handles;
}

DeformationResult RigidityPose(const Shape &shape, const Handles &handles, double rigidity, unsigned threads = 2) {
    DeformationParam param;
    param.rigidity = rigidity;
    const Arrays arrays = Read(MeshD(shape));
    return DeformSurface(SurfaceView(arrays), {}, handles, param, Threads(threads));
}

template <class Place>
double LargestOff(const Shape &shape, const Matrix3Xd &position, const Place &place) {
    double off = 0;
    for (std::size_t i = 0; i < shape.position.size(); ++i)
        off = std::max(off, (position.col(Eigen::Index(i)) - place(shape.position[i])).norm());
    return off;
}

} // namespace

TEST(AffineDeformer, ReportsTheEnergyAndIsWhereItIsLeast) {
    const Rig rig = AffineRig();
    const std::vector<Affine3d> motion = rig.NodeMotion(BendRig);
    for (double rigidity : {0.0, 0.3, 0.9}) {
        SolverParam param = WithRigidity(rigidity);
        param.tolerance = 1e-9;
        const GraphPose pose = SolvedBy(rig, motion, param);
        EXPECT_TRUE(pose.converged);
        EXPECT_TRUE(pose.affine);
        const double smooth = param.smoothness * rig.surface.area,
                     energy = AffineEnergy(rig, motion, pose, smooth, rigidity);
        EXPECT_NEAR(pose.energy, energy, 1e-6 * energy) << rigidity;
        EXPECT_NEAR(std::accumulate(pose.nodeEnergy.begin(), pose.nodeEnergy.end(), 0.0), energy, 1e-6 * energy);
        std::mt19937 random(1);
        for (int n = 0; n < 30; ++n) { // more energy elsewhere
            GraphPose other = pose;
            for (Index i = 0; i < rig.graph.Size(); ++i)
                if (!rig.constrained[i]) {
                    other.position.col(i) += 1e-4 * RandomVector(random);
                    for (int d = 0; d < 3; ++d)
                        other.linear[i].col(d) += 1e-3 * RandomVector(random);
                }
            EXPECT_GT(AffineEnergy(rig, motion, other, smooth, rigidity), energy) << rigidity;
        }
        for (Index i = 0; i < rig.graph.Size(); ++i)
            if (rig.constrained[i])
                EXPECT_TRUE(SameBits(Vector3d(pose.position.col(i)),
                                     Vector3d(motion[i] * rig.graph.graph.position.col(i).cast<double>())));
    }
}

TEST(AffineDeformer, ComesToRestToTheToleranceOrSaysItDidNot) {
    const Rig rig = AffineRig();
    const std::vector<Affine3d> motion = rig.NodeMotion(BendRig);
    for (double rigidity : {0.1, 0.5, 0.9, 0.99}) {
        SolverParam tight = WithRigidity(rigidity), few = tight;
        tight.tolerance = 1e-10;
        tight.maxIterations = 100000;
        few.maxIterations = 5;
        const GraphPose truth = SolvedBy(rig, motion, tight), usual = SolvedBy(rig, motion, WithRigidity(rigidity));
        EXPECT_TRUE(truth.converged);
        EXPECT_TRUE(usual.converged);
        EXPECT_LT(usual.iterations, 700) << rigidity;
        EXPECT_LE((usual.position - truth.position).colwise().norm().maxCoeff(), 20 * SolverParam().tolerance)
            << rigidity; // of a diagonal of 1
        const GraphPose begun = SolvedBy(rig, motion, few);
        EXPECT_FALSE(begun.converged);
        EXPECT_EQ(begun.iterations, 5);
        SolverParam plain = WithRigidity(rigidity);
        plain.accelerated = false;
        plain.maxIterations = 100000;
        EXPECT_LE((SolvedBy(rig, motion, plain).position - truth.position).colwise().norm().maxCoeff(), 1e-3)
            << rigidity;
    }
}

TEST(AffineDeformer, MeetsOneMotionOfAll) {
    const Rig rig = AffineRig();
    for (unsigned seed = 1; seed <= 3; ++seed)
        for (double rigidity : {0.0, 0.2, 0.8}) {
            const Affine3d all = rigidity > 0 ? RandomRigid(seed) : RandomAffine(seed);
            const std::vector<Affine3d> motion = rig.NodeMotion([&](Index) { return all; });
            const GraphPose pose = SolvedBy(rig, motion, WithRigidity(rigidity));
            for (Index j = 0; j < rig.graph.Size(); ++j) {
                EXPECT_LE((pose.position.col(j) - motion[j] * rig.graph.graph.position.col(j).cast<double>()).norm(),
                          1e-7);
                EXPECT_LE((pose.linear[j] - motion[j].linear()).norm(), 1e-5);
            }
        }
}

TEST(AffineDeformer, IsLinearInTheMotionsAtZero) {
    const Rig rig = AffineRig();
    const auto posed = [&](double share) {
        Affine3d part = bend;
        part.matrix() = share * bend.matrix() + (1 - share) * Eigen::Matrix4d::Identity();
        return SolvedBy(rig, rig.NodeMotion([&](Index tag) { return tag == 0 ? Affine3d::Identity() : part; }),
                        WithRigidity(0));
    };
    const GraphPose whole = posed(1), half = posed(0.5);
    const Matrix3Xd rest = rig.graph.graph.position.cast<double>();
    EXPECT_EQ(whole.iterations, 1);
    EXPECT_LE((2 * (half.position - rest) - (whole.position - rest)).cwiseAbs().maxCoeff(), 1e-5);
    // A pose does not depend on earlier ones.
    const AffineDeformer deformer(rig.graph, rig.constrained, rig.surface.area, {}, {}, 0.75, WithRigidity(0));
    const std::vector<Affine3d> motion = rig.NodeMotion(BendRig);
    EXPECT_TRUE(SameBits(deformer.Solve(motion, WithRigidity(0), {}, &half, motion).position, whole.position));
}

TEST(AffineDeformer, GoesOnFromTheLastPose) {
    const Rig rig = AffineRig();
    const std::vector<Affine3d> motion = rig.NodeMotion(BendRig);
    const AffineDeformer deformer(rig.graph, rig.constrained, rig.surface.area, {}, {}, 0.75, WithRigidity(0.5));
    const GraphPose first = deformer.Solve(motion, WithRigidity(0.5)),
                    again = deformer.Solve(motion, WithRigidity(0.5), {}, &first, motion);
    EXPECT_TRUE(again.converged && again.followed);
    EXPECT_LT(again.iterations, first.iterations);
    EXPECT_LE((again.position - first.position).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(AffineDeformer, CanBeCancelled) {
    const Rig rig = AffineRig();
    const std::vector<Affine3d> motion = rig.NodeMotion(BendRig);
    SolverParam param = WithRigidity(0.9);
    const AffineDeformer deformer(rig.graph, rig.constrained, rig.surface.area, {}, {}, 0.75, param);
    param.tolerance = 0;
    param.maxIterations = 100;
    CallbackLog all;
    deformer.Solve(motion, param, all.Progress());
    ASSERT_GT(all.percent.size(), 3u);
    for (std::size_t i = 0; i < all.percent.size(); ++i) {
        CallbackLog log(i);
        EXPECT_THROW(deformer.Solve(motion, param, log.Progress()), Cancelled);
    }
}

TEST(Rigidity, PointHandlesMeetAnAffineMapAtZero) {
    for (const Shape &shape : {Sphere(40, 40), Jittered(Tube(40, 30), 0.02), Join(Sphere(20, 20), Tube(30, 20))})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            const Affine3d all = RandomAffine(seed);
            const auto place = [&](const Vector3d &p) { return Vector3d(all * p); };
            const Handles handles = PointsAt(shape, 12, place);
            EXPECT_LE(LargestOff(shape, RigidityPose(shape, handles, 0).position, place), 1e-6);
            EXPECT_GT(LargestOff(shape, RigidityPose(shape, handles, 1).position, place), 0.01);
        }
}

TEST(Rigidity, PointHandlesMeetARigidMotion) {
    const Shape shape = Sphere(40, 40);
    for (double rigidity : {0.0, 0.1, 0.5, 0.9}) {
        const Affine3d all = RandomRigid(3);
        const auto place = [&](const Vector3d &p) { return Vector3d(all * p); };
        const DeformationResult result = RigidityPose(shape, PointsAt(shape, 12, place), rigidity);
        EXPECT_LE(LargestOff(shape, result.position, place), 1e-3) << rigidity; // the tolerance
        EXPECT_TRUE(result.converged);
    }
}

TEST(Rigidity, HandlesThatStretchAreMetUpToTheirBorders) {
    const Shape tube = Tube(60, 30, 10);
    const Affine3d all = RandomAffine(4);
    Handles handles;
    handles.tag = TagsOf(tube, [](const Vector3d &p) { return p[2] < 2 ? 3 : p[2] > 8 ? 2 : 1; });
    handles.motion[2] = handles.motion[3] = Motion(all.matrix());
    const auto place = [&](const Vector3d &p) { return Vector3d(all * p); };
    EXPECT_LE(LargestOff(tube, RigidityPose(tube, handles, 0).position, place), 1e-5);
}

TEST(Rigidity, HeldPartsStayToTheBitAndThreadsChangeNone) {
    const Shape tube = Tube(60, 30, 10);
    Handles handles;
    handles.tag = TagsOf(tube, [](const Vector3d &p) { return p[2] < 2 ? 0 : p[2] > 8 ? 2 : 1; });
    handles.motion[2] = Motion(bend.matrix());
    handles.point.push_back({30 * 30, tube.position[30 * 30] + Vector3d(0.8, 0.3, -0.2)});
    for (double rigidity : {0.0, 0.4}) {
        const DeformationResult one = RigidityPose(tube, handles, rigidity, 1),
                                four = RigidityPose(tube, handles, rigidity, 4);
        EXPECT_TRUE(SameBits(one.position, four.position));
        EXPECT_TRUE(one.converged);
        for (std::size_t i = 0; i < tube.position.size(); ++i)
            if (handles.tag[i] == 0)
                EXPECT_TRUE(SameBits(Vector3d(one.position.col(Eigen::Index(i))), tube.position[i]));
            else if (handles.tag[i] == 2)
                EXPECT_LE((one.position.col(Eigen::Index(i)) - bend * tube.position[i]).norm(), 1e-12);
        EXPECT_LE((one.position.col(30 * 30) - handles.point[0].target).norm(), 1e-6);
        EXPECT_GT(one.discretisationError, 0);
    }
}

TEST(Rigidity, OneDeformerHasPosesOfAny) {
    const Shape tube = Tube(40, 20, 10);
    Handles handles;
    handles.tag = TagsOf(tube, [](const Vector3d &p) { return p[2] < 2 ? 0 : p[2] > 8 ? 2 : 1; });
    handles.motion[2] = Motion(bend.matrix());
    DeformationParam param;
    const Arrays arrays = Read(MeshD(tube));
    const SurfaceView view(arrays);
    const auto deformer = PrepareDeformer(view, handles, param, Threads(2));
    for (double rigidity : {1.0, 0.0, 0.5, 0.0, 1.0}) {
        param.rigidity = rigidity;
        const Deformer::Pose pose = deformer->Solve(handles, param, Threads(2));
        Matrix3Xd position = view.Copy();
        Carrier(*deformer, pose).Apply(position);
        EXPECT_TRUE(SameBits(position, RigidityPose(tube, handles, rigidity).position)) << rigidity;
    }
}

TEST(Rigidity, IsRefusedOutOfRangeAndWhereItContradicts) {
    const auto message = [](const auto &change) {
        DeformationParam param;
        change(param);
        return MessageOf<BadInput>([&] { param.Validate(); });
    };
    for (double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(message([&](DeformationParam &p) { p.rigidity = bad; }), "The rigidity must be from 0 to 1.");
    EXPECT_NE(message([](DeformationParam &p) { p.rigidity = 0.9999; }).find("hardly comes to rest"),
              std::string::npos);
    DeformationParam stiff;
    stiff.rigidity = 0.999;
    EXPECT_NO_THROW(stiff.Validate());
    EXPECT_EQ(message([](DeformationParam &p) {
                  p.rigidity = 0.5;
                  p.elastic = true;
              }),
              "A rigidity below 1 lets the surface stretch, and elastic keeps its volume; take one of them.");
    EXPECT_EQ(message([](DeformationParam &p) {
                  p.rigidity = 0.5;
                  p.graphWeights = GraphWeights::Printed;
              }),
              "A rigidity below 1 does not go with the method as printed; take other graph weights.");
    SolverParam high = WithRigidity(0);
    high.smoothness = 1e307;
    const Rig rig = AffineRig();
    const double area = 100; // the product overflows
    EXPECT_EQ(
        MessageOf<Unsolvable>([&] { AffineDeformer(rig.graph, rig.constrained, area, {}, {}, 0.75, high); }),
        "The deformation graph's system cannot be factorised with a rigidity below 1. Take a smoothness nearer to "
        "its default.");
}

TEST(Rigidity, SaysWhereItTakesTooLong) {
    const Index k = 9000; // fine for rigidity 1
    DeformationGraph g;
    g.graph.adjacency = RandomGraph(k, 5 * k, 1);
    std::mt19937 random(2);
    g.graph.position.resize(3, k);
    for (Index i = 0; i < k; ++i)
        g.graph.position.col(i) = RandomVector(random).cast<float>();
    g.edge.setOnes(3, Eigen::Index(g.graph.adjacency.item.size()));
    g.weight.assign(g.graph.adjacency.item.size(), 1);
    g.held.assign(std::size_t(k), false);
    std::vector<bool> constrained(std::size_t(k), false);
    constrained[0] = true;
    EXPECT_EQ(MessageOf<Unsolvable>([&] { AffineDeformer(g, constrained, 1, {}, {}, 0.75, WithRigidity(0)); }),
              "The deformation graph of 9000 nodes takes minutes to solve with a rigidity below 1. Take fewer patches, "
              "or a rigidity of 1.");
}
