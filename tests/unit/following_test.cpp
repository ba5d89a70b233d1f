// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/handles/motion_text.h>
#include <vcg_ext/solve/graph_hessian.h>
#include <vcg_ext/base/words.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A tube that is twisted about its axis, bent and pressed; \p motion as ReadMotionText takes it.
struct Followed {
    Case tube = CaseOf(Tube(48, 16, 11), [](const Vector3d &p) { return p[2] < 0.7 ? 0 : p[2] > 10.3 ? 2 : 1; });
    MeshD mesh{tube.shape};
    DeformationParam param;

    Followed() { param.graph.initialPatches = 100; }

    DeformationResult operator()(const std::string &motion, double pose = 100, int steps = 1) {
        tube.handles.motion.clear();
        for (const auto &[tag, each] : ReadMotionText(motion))
            tube.handles.motion[tag] = ToMotion(each, Vector3d(0, 0, 10.6));
        param.pose = pose;
        param.steps = steps;
        return vcg::tri::DeformCentroidal(mesh, tube.handles, param);
    }
};

/// By how many degrees the middle of the tube has turned about z, -180 to 180.
static double TurnOfMiddle(const Followed &rig, const Matrix3Xd &x) {
    double sine = 0, cosine = 0;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
        const Vector3d &p = rig.tube.shape.position[std::size_t(i)];
        if (std::abs(p[2] - 5.5) > 0.3)
            continue;
        sine += p[0] * x(1, i) - p[1] * x(0, i);
        cosine += p[0] * x(0, i) + p[1] * x(1, i);
    }
    return std::atan2(sine, cosine) * 180 / M_PI;
}

TEST(Following, ATurnIsWhatIsTold) {
    Followed rig;
    for (double degrees : {-190.0, 170.0, 190.0, 330.0, 360.0, 400.0}) {
        const DeformationResult r = rig("2: rotate 0 0 1 " + detail::ToText(degrees));
        EXPECT_TRUE(r.converged) << degrees;
        EXPECT_EQ(r.pose.path.steps, int(std::ceil(std::abs(degrees) / 60))) << degrees;
        EXPECT_FALSE(r.pose.path.jumps) << degrees;
        EXPECT_LE(std::abs(std::remainder(TurnOfMiddle(rig, r.position) - degrees / 2, 360)), 10) << degrees;
    }
}

TEST(Following, FullTurnsAreNoExceptions) {
    Followed rig;
    std::vector<double> energy;
    for (double degrees : {719.0, 720.0, 721.0}) {
        const DeformationResult r = rig("2: rotate 0 0 1 " + detail::ToText(degrees));
        EXPECT_TRUE(r.converged) << degrees;
        EXPECT_FALSE(r.pose.path.jumps) << degrees;
        EXPECT_TRUE(r.pose.path.unstable) << "so slender a tube would let go";
        energy.push_back(r.energy);
    }
    EXPECT_NEAR(energy[0], energy[1], 0.01 * energy[1]);
    EXPECT_NEAR(energy[2], energy[1], 0.01 * energy[1]);
    const double once = rig("2: rotate 0 0 1 360").energy;
    EXPECT_GT(energy[1], 2 * once);
    EXPECT_GT(once, 1);
    // No motion in many steps is no motion.
    EXPECT_TRUE(SameBits(rig("2: rotate 0 0 1 720", 0).position, PositionsOf(rig.mesh)));
    EXPECT_TRUE(SameBits(rig("").position, PositionsOf(rig.mesh)));
}

TEST(Following, APercentageOfATurnIsThatTurn) {
    Followed rig;
    const Matrix3Xd typed = rig("2: rotate 0 1 0 190 about 3 0 5").position;
    EXPECT_LE((rig("2: rotate 0 1 0 380 about 3 0 5", 50).position - typed).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LE((rig("2: rotate 0 1 0 190 about 3 0 5", 100, 10).position - typed).colwise().norm().maxCoeff(), 0.02)
        << "as in more steps";
}

TEST(Following, OneStepWhereItDoes) {
    Followed rig;
    const Matrix3Xd at = rig("2: rotate 0 1 0 60").position;
    const auto deformer = PrepareDeformer(Read(rig.mesh), rig.tube.handles, rig.param);
    Matrix3Xd direct = PositionsOf(rig.mesh);
    Carrier(*deformer, deformer->Solve(deformer->MotionsOf(rig.tube.handles, 100), rig.param)).Apply(direct);
    EXPECT_TRUE(SameBits(direct, at));
    // Handles with equal turns, and nothing fixed: no turn between them.
    for (int &tag : rig.tube.handles.tag)
        tag = tag == 0 ? 3 : tag;
    EXPECT_EQ(rig("2: rotate 0 1 0 200 about 0 0 0; 3: rotate 0 1 0 200 about 0 0 0").pose.path.steps, 1);
    EXPECT_EQ(rig("2: rotate 0 1 0 100 about 0 0 0; 3: rotate 0 1 0 -100 about 0 0 0").pose.path.steps, 4);
}

TEST(Following, SaysWhereTheShapeJumps) {
    // Pulled through the fixed end, the surface must turn inside out somewhere.
    Followed rig;
    const DeformationResult r = rig("2: translate 0 0 -25", 100, 4);
    EXPECT_TRUE(r.pose.path.jumps);
}

TEST(GraphHessian, IsTheDerivativeOfTheEnergy) {
    const Rig rig(Jittered(Tube(40, 16), 0.05), 0.6, [](const Vector3d &p) { return TubeTag(p); });
    const Index k = rig.graph.Size();
    const std::vector<double> heldArea(k, 1e-3);
    const detail::GraphUnknowns unknown(rig.graph.graph.adjacency, rig.constrained, rig.constrained);
    const detail::GraphEnergy energy(rig.graph, unknown, heldArea, 0.75);
    std::mt19937 random(1);
    detail::GraphEnergy::State x{rig.graph.graph.position.cast<double>(), {}, {}, 0};
    for (Index i = 0; i < k; ++i) {
        x.position.col(i) += 0.1 * RandomVector(random);
        const Vector3d turn = RandomVector(random);
        x.rotation.push_back(Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix());
        x.quaternion.push_back(detail::ToQuaternion(x.rotation.back()));
    }
    const std::vector<Eigen::Affine3d> motion = rig.NodeMotion([](Index) { return RandomRigid(3); });
    const detail::GraphEnergy::PoseTerms given(energy, motion, x, 0.1);
    detail::GraphHessian hessian(unknown);
    hessian.Assemble(energy, x, given);
    ASSERT_TRUE(hessian.Factorise({}, hessian.Worthwhile()));
    const Eigen::VectorXd gradient = energy.Gradient(x, given);
    const Eigen::Index size = gradient.size();
    ASSERT_GT(size, 100);
    for (int n = 0; n < 10; ++n) {
        Eigen::VectorXd way = Eigen::VectorXd::NullaryExpr(
            size, [&](Eigen::Index) { return std::uniform_real_distribution<double>(-1, 1)(random); });
        for (std::size_t b = unknown.position.size(); b < unknown.rotation.size(); ++b) // their position is given
            way.segment<3>(6 * Eigen::Index(b)).setZero();
        const double h = 1e-5;
        const auto moved = [&](double by) {
            detail::GraphEnergy::State y = x;
            hessian.Move(y, by * way);
            return y;
        };
        const double slope = (energy.Of(moved(h), given) - energy.Of(moved(-h), given)) / (2 * h);
        EXPECT_NEAR(gradient.dot(way), slope, 1e-6 * std::abs(slope) + 1e-6);
        const double here = energy.Of(x, given);
        const double curvature = (energy.Of(moved(1e-3), given) - 2 * here + energy.Of(moved(-1e-3), given)) / 1e-6;
        EXPECT_NEAR(hessian.Times(way).dot(way), curvature, 1e-4 * std::abs(curvature));
        EXPECT_LE((hessian.Times(hessian.Solve(way)) - way).norm(), 1e-8 * way.norm());
    }
}
