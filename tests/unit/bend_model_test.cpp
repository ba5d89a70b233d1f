// SPDX-License-Identifier: GPL-3.0-or-later
#include <edit_fcd/bend/model/handles.h>
#include <edit_fcd/bend/model/model.h>
#include <edit_fcd/bend/model/named_poses.h>
#include <edit_fcd/bend/panel/frame_scale.h>
#include <edit_fcd/bend/tool/drag.h>
#include <edit_fcd/kit/history.h>
#include <layer_fcd/bend_state.h>
#include "test_support.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <random>
#include <set>

using namespace vcg::fcd;
using namespace fcd_test;

// Marks, handles and motions of FCD: Bend, without a window and a layer.

namespace {

/// A model on a shape at rest.
struct Bent {
    explicit Bent(const Shape &shape)
        : position(shape.position),
          arrays(std::make_shared<const SurfaceArrays>(Read(MeshOf<VertexD, EdgeD, FaceD>(shape)))),
          reach([this] { return std::make_pair(arrays, Eigen::Matrix3d(Eigen::Matrix3d::Identity())); }) {
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d &p : position)
            box.extend(p);
        model.ground.vertexSlots = position.size();
        model.ground.diagonal = box.diagonal().norm();
        model.ground.middle = box.center();
        model.ground.at = [this](std::size_t i) { return position[i]; };
        model.ground.normalAt = [](std::size_t) { return Eigen::Vector3d(0, 0, 1); };
        model.ground.reach = &reach;
        update();
    }
    Bent(const Bent &) = delete;
    Bent &operator=(const Bent &) = delete;

    void update() { model.influence = influenceOf(model.state, model.ground, model.influence.tags); }
    std::size_t nearest(const Eigen::Vector3d &p) const {
        const auto isNearer = [&](const auto &a, const auto &b) { return (a - p).norm() < (b - p).norm(); };
        return std::size_t(std::min_element(position.begin(), position.end(), isNearer) - position.begin());
    }
    /// The extent of a handle that turns a limb. \param root its vertex
    auto turnedAt(std::size_t root, double usual, double hair = 0.01) {
        return reach.whole({root}, reach.radiusAt(root, usual), hair);
    }
    void addPoint(int tag, const Eigen::Vector3d &p, double radius, bool isGrip = false) {
        model.state.points[tag] = {nearest(p), radius, isGrip};
        update();
    }
    int tagAt(const Eigen::Vector3d &p) const { return (*model.influence.tags)[nearest(p)]; }
    /// Marks the vertices that \p isIn tells, with a rim, as the tool does.
    template <class IsIn>
    std::set<int> mark(int tag, double rim, const IsIn &isIn) {
        BendTags marks = model.state.marks ? *model.state.marks : BendTags(position.size(), 1);
        std::vector<std::size_t> marked;
        for (std::size_t i = 0; i < position.size(); ++i)
            if (isIn(position[i])) {
                marks[i] = tag;
                marked.push_back(i);
            }
        const std::set<int> added = takeMarks(model.state, marks, marked, rim, model.influence.center);
        update();
        return added;
    }

    std::vector<Eigen::Vector3d> position;
    std::shared_ptr<const SurfaceArrays> arrays;
    BendReach reach;
    BendModel model;
};

/// A closed tube along x, from -1 to 1.
Shape Limb(double radius = 0.08, int rings = 120, const Eigen::Vector3d &at = {0, 0, 0}, double half = 1,
           int columns = 16) {
    Shape s;
    for (int r = 0; r < rings; ++r)
        for (int c = 0; c < columns; ++c) {
            const double turn = c * 2 * EIGEN_PI / columns;
            s.position.push_back(at + Eigen::Vector3d(half * (2.0 * r / (rings - 1) - 1), radius * std::cos(turn),
                                                      radius * std::sin(turn)));
        }
    for (const double end : {-half, half})
        s.position.push_back(at + Eigen::Vector3d(end, 0, 0));
    const int left = rings * columns;
    for (int c = 0; c < columns; ++c) {
        const int next = (c + 1) % columns, last = (rings - 1) * columns;
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * columns + c, b = r * columns + next;
            s.face.push_back({a, b, a + columns});
            s.face.push_back({b, b + columns, a + columns});
        }
        s.face.push_back({left, next, c});
        s.face.push_back({left + 1, last + c, last + next});
    }
    return s;
}

const double radius = 0.3;

} // namespace

TEST(BendModel, AHandleAloneBendsWhatIsAroundIt) {
    Bent bent(Limb(0.25));
    EXPECT_FALSE(bent.model.influence.isLocal);
    bent.addPoint(2, {0, 0.25, 0}, radius);
    EXPECT_TRUE(bent.model.influence.isLocal);
    EXPECT_EQ(bent.tagAt({0, 0.25, 0}), 2);
    EXPECT_EQ(bent.tagAt({0.15, 0.25, 0}), 1);
    for (const double x : {-0.6, 0.6})
        EXPECT_EQ(bent.tagAt({x, 0.25, 0}), 0);
    setRadiusOf(bent.model.state, 2, 2 * radius);
    bent.update();
    EXPECT_EQ(bent.tagAt({0.45, 0.25, 0}), 1);
    EXPECT_EQ(radiusOf(bent.model, 2), 2 * radius);
}

TEST(BendModel, APullTakesATipAlongAndAGripHoldsIt) {
    Bent bent(Limb());
    bent.addPoint(2, {0.5, 0.08, 0}, radius);
    EXPECT_EQ(bent.tagAt({0.95, 0.08, 0}), 1) << "bends, and is not fixed";
    EXPECT_EQ(bent.tagAt({-0.5, 0.08, 0}), 0);
    bent.addPoint(2, {0.5, 0.08, 0}, radius, true);
    EXPECT_EQ(bent.tagAt({0.95, 0.08, 0}), 2) << "turns with it";
    EXPECT_EQ(bent.tagAt({0.5 - 0.75 * radius, 0.08, 0}), 1) << "is left to bend";
    EXPECT_EQ(bent.tagAt({-0.5, 0.08, 0}), 0);
    EXPECT_TRUE(isAlong(bent.model, bent.nearest({0.95, 0.08, 0})));
    EXPECT_TRUE(canBecomePoint(bent.model, bent.nearest({0.95, 0.08, 0})));
    EXPECT_FALSE(canBecomePoint(bent.model, bent.nearest({0.5, 0.08, 0})));
}

TEST(BendModel, AGripOnALimbTurnsAboutItsJoint) {
    // The tube reaches twice the radius to the right of the handle and three times to the left, at an angle.
    const Eigen::AngleAxisd turned(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    Shape limb = Limb();
    for (Eigen::Vector3d &p : limb.position)
        p = turned * p;
    Bent bent(limb);
    const Eigen::Vector3d place = turned * Eigen::Vector3d(0.4, 0.08, 0);
    bent.addPoint(2, place, radius);
    EXPECT_FALSE(jointOf(bent.model, 2)) << "what is pulled only has none";
    bent.addPoint(2, place, radius, true);
    ASSERT_TRUE(jointOf(bent.model, 2));
    const Eigen::Vector3d joint = turned.inverse() * *jointOf(bent.model, 2);
    EXPECT_LT(std::hypot(joint[1], joint[2]), 0.2 * 0.08) << "in the middle of the limb: " << joint.transpose();
    EXPECT_GT(joint[0], 0.4 - radius) << "between what stays";
    EXPECT_LT(joint[0], 0.4 - radius / 3) << "and what turns";
    EXPECT_EQ(pivotOf(bent.model, 2), *jointOf(bent.model, 2));
    setMotion(bent.model, {{2, {MotionStep::Translate({0, 1, 0})}}});
    EXPECT_LT((pivotOf(bent.model, 2) - *jointOf(bent.model, 2) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
    setRadiusOf(bent.model.state, 2, 2 * radius);
    bent.update();
    EXPECT_LT((turned.inverse() * *jointOf(bent.model, 2))[0], 0.4 - radius) << "the wheel moves it";
    setPivot(bent.model, 2, Eigen::Vector3d(1, 2, 3));
    EXPECT_LT((pivotOf(bent.model, 2) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12) << "P says otherwise";
    setPivot(bent.model, 2, {});
    EXPECT_LT((pivotOf(bent.model, 2) - *jointOf(bent.model, 2) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);

    Bent thick(Limb(0.5)); // no limb if the radius reaches less than half around
    thick.addPoint(2, {0, 0.5, 0}, radius, true);
    EXPECT_FALSE(jointOf(thick.model, 2));
    EXPECT_EQ(pivotOf(thick.model, 2), dotOf(thick.model, 2));
}

TEST(BendModel, WhatWouldMoveIsSeenBefore) {
    Bent bent(
        Join(Limb(0.08, 500, {0, 0, 0}, 1, 64), Limb(0.08, 500, {0, 0.165, 0}, 1, 64))); // two fingers, nearly touching
    const std::size_t slot = bent.nearest({0.4, 0, 0.08});
    bent.reach.begin();
    bent.reach.lookAt(slot);
    BendReach &glance = bent.reach.glance();
    EXPECT_TRUE(bent.reach.isRead());
    ASSERT_NE(&glance, &bent.reach) << "there are many vertices";
    const double exact = bent.reach.radiusAt(slot, 0.3), about = glance.radiusAt(slot, 0.3);
    EXPECT_NEAR(about, exact, 0.15 * exact);
    const auto is = bent.reach.whole({slot}, exact, 0.01), seems = glance.whole({slot}, exact, 0.01);
    ASSERT_TRUE(is->joint && seems->joint);
    EXPECT_LT((*is->joint - *seems->joint).norm(), 0.2 * 0.3)
        << "ways along edges are longer on the one than on the other";
    std::vector<float> share(bent.position.size(), 0);
    for (const auto &extent : {seems, is}) {
        std::vector<float> own(bent.position.size(), 0);
        ASSERT_EQ(extent->share.size(), extent->around.size());
        for (std::size_t k = 0; k < extent->around.size(); ++k)
            own[extent->around[k]] = extent->share[k];
        for (const std::size_t i : extent->beyond)
            own[i] = 1;
        double off = 0;
        for (std::size_t i = 0; i < own.size(); ++i)
            off += std::abs(own[i] - share[i]) / double(own.size());
        if (extent == is)
            EXPECT_LT(off, 0.02);
        share = std::move(own);
    }
    EXPECT_EQ(share[bent.nearest({0.4, 0.165, 0.08})], 0) << "the other finger";
    EXPECT_EQ(share[bent.nearest({0.9, 0, 0.08})], 1);
    const float near = share[bent.nearest({0.3, 0, 0.08})], far = share[bent.nearest({0.2, 0, 0.08})];
    EXPECT_GT(near, far);
    EXPECT_GT(far, 0.1);
    EXPECT_EQ(share[bent.nearest({0, 0, 0.08})], 0);
}

TEST(BendModel, ALimbBeginsWhereItGetsThicker) {
    // A limb 0.16 thick, from x = 0 to the right, on a body three times as thick.
    Shape figure = Limb(0.08, 400, {0, 0, 0}, 1, 48);
    for (Eigen::Vector3d &p : figure.position) {
        const double thick = p[0] < 0 ? 3 : p[0] < 0.05 ? 3 - 40 * p[0] : 1;
        p[1] *= thick;
        p[2] *= thick;
    }
    Bent bent(figure);
    const double usual = 0.3;
    for (const double x : {0.5, 0.7}) {
        const auto root = bent.reach.rootOfLimb(bent.nearest({x, 0, 0.08}), usual, 0.01);
        ASSERT_TRUE(root);
        EXPECT_NEAR(bent.position[*root][0], 0.05 + 0.16, 0.1) << "its thickness from there";
        const auto joint = bent.turnedAt(*root, usual)->joint;
        ASSERT_TRUE(joint);
        EXPECT_NEAR((*joint)[0], 0.05, 0.12);
        EXPECT_LT(std::hypot((*joint)[1], (*joint)[2]), 0.25 * 0.16) << "a quarter of its thickness";
    }
    const std::size_t near = bent.nearest({0.2, 0, 0.08});
    const auto nearRoot = bent.reach.rootOfLimb(near, usual, 0.01);
    ASSERT_TRUE(nearRoot);
    EXPECT_NEAR(bent.position[*nearRoot][0], 0.05 + 0.16, 0.1) << "it begins there";
    EXPECT_FALSE(bent.reach.rootOfLimb(bent.nearest({-0.5, 0, 0.24}), usual, 0.01)) << "the body is no limb";
    for (const double x : {0.9, 1.0}) { // near its end, with nothing beyond
        const auto root = bent.reach.rootOfLimb(bent.nearest({x, 0, 0.08}), usual, 0.01);
        ASSERT_TRUE(root) << x;
        EXPECT_NEAR(bent.position[*root][0], 0.05 + 0.16, 0.16) << x;
    }
}

namespace {

/// A body of revolution about x, from -1 to 1. \param thick tells its radius at a place
template <class Thick>
Shape TurnedBody(const Thick &thick) {
    Shape s = Limb(1, 100, {0, 0, 0}, 1, 48);
    for (Eigen::Vector3d &p : s.position) {
        const double x = p[0];
        p = {x, thick(x) * p[1], thick(x) * p[2]};
    }
    return s;
}

} // namespace

TEST(BendModel, AllOfALimbTurnsAtOneJoint) {
    // A tail that gets thinner, from x = 0.05 to the right, on a body.
    const auto thick = [](double x) {
        return x < 0      ? 0.24
               : x < 0.05 ? 0.24 - 3.2 * x
               : x < 0.97 ? 0.08 - 0.05 * (x - 0.05)
                          : 0.034 * std::sqrt((1 - x) / 0.03);
    };
    Bent bent(TurnedBody([&](double x) { return std::max(thick(x), 1e-3); }));
    const double usual = 0.3;
    const auto jointFrom = [&](const Eigen::Vector3d &p, std::size_t nearer) {
        const std::size_t slot = bent.nearest(p);
        const auto root = bent.reach.rootOfLimb(slot, usual, 0.01, nearer);
        EXPECT_TRUE(root) << p.transpose();
        const auto extent = bent.turnedAt(root.value_or(0), usual);
        EXPECT_TRUE(extent->joint) << p.transpose();
        EXPECT_GT(extent->shareOf(slot), 0.5f);
        return extent->joint ? (*extent->joint)[0] : -1.;
    };
    std::vector<double> joints;
    for (const double x : {0.3, 0.35, 0.45, 0.6, 0.75, 0.9, 0.96, 1.0})
        for (const double turn : {0.0, 2.0, 4.0})
            joints.push_back(jointFrom({x, thick(x) * std::cos(turn), thick(x) * std::sin(turn)}, 0));
    const auto [least, most] = std::minmax_element(joints.begin(), joints.end());
    EXPECT_LT(*most - *least, 0.1) << "from any side; it was 0.4";
    EXPECT_LT(*most, 0.25) << "where it begins";
    std::vector<double> nearer;
    for (const std::size_t steps : {0, 1, 2, 3})
        nearer.push_back(jointFrom({0.8, 0, thick(0.8)}, steps));
    EXPECT_TRUE(std::is_sorted(nearer.begin(), nearer.end(), std::less_equal<>())) << "each one is another joint";
    EXPECT_NEAR(nearer[3] - nearer[1], 2 * 0.1, 0.08) << "by its thickness each";
    EXPECT_LT(jointFrom({0.8, 0, thick(0.8)}, 50), 0.8) << "not beyond the mouse";
}

TEST(BendModel, ALimbMayWidenSlowlyIntoTheBody) {
    // A head on a neck 0.1 thick, on shoulders that slope by 17 degrees to the side.
    const auto thick = [](double x) {
        const double head = std::sqrt(std::max(1e-6, 0.04 - std::pow(x - 0.8, 2))) / 2;
        return x < 0.4 ? std::min(0.2, 0.05 + 0.3 * (0.4 - x)) : x < 0.8 ? std::max(0.05, head) : head;
    };
    Bent bent(TurnedBody(thick));
    for (const double x : {0.65, 0.8, 0.95}) {
        const std::size_t slot = bent.nearest({x, 0, thick(x)});
        const auto root = bent.reach.rootOfLimb(slot, 0.3, 0.01);
        ASSERT_TRUE(root) << x;
        const auto extent = bent.turnedAt(*root, 0.3);
        ASSERT_TRUE(extent->joint) << x;
        EXPECT_LT(thick((*extent->joint)[0]), 0.1) << "half as thick as the body: it was 0.13";
    }
}

namespace {

/// An arm 0.16 thick that is bent in its middle, on a body three times as thick. \param isRound it is bent all along
Shape BentArm(double degrees, bool isRound) {
    Shape figure = Limb(1, 300, {0, 0, 0}, 1, 32);
    const double bend = degrees * EIGEN_PI / 180, middle = 0.5, width = isRound ? 0.9 : 0.06;
    for (Eigen::Vector3d &p : figure.position) {
        const double x = p[0], thick = x < 0 ? 0.24 : x < 0.05 ? 0.24 - 3.2 * x : 0.08;
        Eigen::Vector3d at(std::min(x, 0.), 0, 0);
        double turn = 0;
        const int steps = 200;
        for (int k = 0; k < steps && x > 0; ++k) {
            turn = bend * std::clamp(((k + 0.5) * x / steps - middle) / width + 0.5, 0., 1.);
            at += x / steps * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0);
        }
        p = at + thick * (p[1] * Eigen::Vector3d(-std::sin(turn), std::cos(turn), 0) + p[2] * Eigen::Vector3d::UnitZ());
    }
    return figure;
}

} // namespace

TEST(BendModel, ABentLimbTurnsWhereItIsBent) {
    const double usual = 0.3;
    const auto fromRoot = [&](double degrees, bool isRound, int nearer, double x) {
        const Shape arm = BentArm(degrees, isRound);
        Bent bent(arm);
        const auto slot = std::size_t((x + 1) / 2 * 299) * 32;
        const auto root = bent.reach.rootOfLimb(slot, usual, 0.01, nearer);
        EXPECT_TRUE(root) << degrees << ", " << x;
        const auto joint = bent.turnedAt(root.value_or(0), usual)->joint;
        EXPECT_TRUE(joint) << degrees << ", " << x;
        return joint.value_or(Eigen::Vector3d::Zero()).norm();
    };
    for (const double x : {0.75, 0.85, 0.95}) {
        for (const double degrees : {40., 60.})
            EXPECT_NEAR(fromRoot(degrees, false, 0, x), 0.5, 0.1) << degrees << " from " << x << ": the elbow";
        EXPECT_LT(fromRoot(60, false, BendReach::wholeLimb, x), 0.25) << "the shoulder";
        EXPECT_LT(fromRoot(0, false, 0, x), 0.25) << "straight";
        EXPECT_LT(fromRoot(60, true, 0, x), 0.25) << "a tail has no joint";
    }
    EXPECT_LT(fromRoot(60, false, 0, 0.3), 0.25) << "the upper arm";
}

TEST(BendModel, AStraightLimbWithAHandOrAFootHasAnElbow) {
    // Arms from x = 0.05 on, .12 thick, without a hand, with one as wide as 1.5 or 1.23 of it, and with a foot to the
    // side. A leg .08 thick with a foot of twice that and a half.
    enum class End { None, Hand, SmallHand, Foot, LongFoot };
    const auto jointFrom = [](End end, double x, int nearer = 0) {
        const double radius = end == End::LongFoot ? 0.04 : 0.06, ankle = end == End::LongFoot ? 0.8 : 0.85;
        const double hand = end == End::Hand ? 0.5 : end == End::SmallHand ? 0.23 : 0;
        const auto thick = [&](double at) {
            const double body = at < 0 ? 4 : at < 0.05 ? 4 - 60 * at : 1;
            return radius * (at > 0.82 && at < 0.98 ? body + hand : body);
        };
        Shape figure = Limb(1, 400, {0, 0, 0}, 1, 32);
        for (Eigen::Vector3d &p : figure.position) {
            const double across = thick(p[0]), beyond = p[0] - ankle; // the foot goes along y
            const bool isFoot = beyond > 0 && (end == End::Foot || end == End::LongFoot);
            p = isFoot ? Eigen::Vector3d(ankle + across * p[1], -beyond, across * p[2])
                       : Eigen::Vector3d(p[0], across * p[1], across * p[2]);
        }
        Bent bent(figure);
        const auto slot = std::size_t((x + 1) / 2 * 399) * 32;
        const auto root = bent.reach.rootOfLimb(slot, 0.3, 0.01, nearer);
        EXPECT_TRUE(root) << x;
        const auto extent = bent.turnedAt(root.value_or(0), 0.3);
        EXPECT_TRUE(extent->joint) << x;
        return extent->joint ? (*extent->joint)[0] : -1.;
    };
    for (const double x : {0.55, 0.65, 0.75, 0.9}) {
        EXPECT_LT(jointFrom(End::None, x), 0.2) << x << ": a tail";
        EXPECT_NEAR(jointFrom(End::Hand, x), 0.05 + 3. / 7 * 0.95, 0.1) << x << ": the elbow";
        EXPECT_NEAR(jointFrom(End::SmallHand, x), 0.05 + 3. / 7 * 0.95, 0.1) << x << ": the elbow";
        EXPECT_LT(jointFrom(End::Hand, x, BendReach::wholeLimb), 0.2) << x << ": the shoulder";
    }
    for (const double x : {0.55, 0.65, 0.75}) {
        EXPECT_NEAR(jointFrom(End::Foot, x), 0.05 + 3. / 7 * 0.95, 0.1) << x << ": the knee";
        EXPECT_NEAR(jointFrom(End::LongFoot, x), 0.05 + 3. / 7 * 0.95, 0.1) << x << ": the knee";
    }
    EXPECT_NEAR(jointFrom(End::LongFoot, 0.95), 0.8, 0.1) << "the ankle";
    EXPECT_LT(jointFrom(End::Hand, 0.25), 0.2) << "the upper arm";
    EXPECT_LT(jointFrom(End::SmallHand, 0.25), 0.2) << "the upper arm";
    EXPECT_LT(jointFrom(End::Foot, 0.25), 0.2) << "the thigh";
}

TEST(BendModel, AFarTurnOfALimbFlipsNothing) {
    Bent bent(Limb(0.08, 200, {0, 0, 0}, 1, 32));
    const std::size_t slot = bent.nearest({0.4, 0.08, 0});
    bent.addPoint(2, bent.position[slot], bent.reach.radiusAt(slot, radius), true);
    ASSERT_TRUE(jointOf(bent.model, 2));
    const Eigen::Vector3d joint = *jointOf(bent.model, 2);
    Handles handles;
    handles.tag = *bent.model.influence.tags;
    const auto deformer = PrepareDeformer(bent.arrays->View(), handles, {});
    for (const double degrees : {60., 90.})
        for (int way = 0; way < 6; ++way) {
            const double a = way * EIGEN_PI / 3;
            const Eigen::AngleAxisd turn(degrees * EIGEN_PI / 180, Eigen::Vector3d(0, std::cos(a), std::sin(a)));
            handles.motion[2] = Motion((Eigen::Translation3d(joint) * turn * Eigen::Translation3d(-joint)).matrix());
            const Deformer::Pose pose = deformer->Solve(handles, {});
            Eigen::Matrix3Xd position = bent.arrays->View().Positions();
            Carrier(*deformer, pose).Apply(position, nullptr);
            EXPECT_EQ(CheckPose(bent.arrays->View(), handles, *deformer, pose, position).flipped, 0)
                << degrees << " degrees, to side " << way;
        }
}

TEST(BendModel, AnswersDoNotDependOnEarlierQuestions) {
    const Shape limb = Limb(0.08, 200, {0, 0, 0}, 1, 24);
    Bent used(limb);
    for (const double reach : {0.4, 0.2, 0.1, 0.3})
        for (const double x : {0.5, -0.5}) {
            Bent fresh(limb);
            const std::size_t slot = used.nearest({x, 0, 0.08});
            const auto is = used.reach.whole({slot}, reach, 0.01), expected = fresh.reach.whole({slot}, reach, 0.01);
            EXPECT_EQ(is->around, expected->around);
            EXPECT_EQ(is->core, expected->core);
            EXPECT_EQ(is->share, expected->share);
            EXPECT_EQ(used.reach.of({slot}, reach / (expected->joint ? 4 : 2)), expected->core);
        }
}

TEST(BendModel, AHeadAsThickAsItsNeckIsALimb) {
    // A body 0.9 thick, from x = 0.2 on a neck and head 0.4 thick, with a round end: nothing can lie beyond a handle.
    const auto round = [](double x) { return std::sqrt(std::max(0.0, 0.04 - std::pow(std::max(0.0, x - 0.8), 2))); };
    Bent bent(TurnedBody([&](double x) { return x < 0.2 ? 0.45 : x < 0.25 ? 1.45 - 5 * x : round(x); }));
    const double usual = 0.4;
    const std::size_t nose = bent.nearest({1, 0, 0});
    for (const double x : {1.0, 0.7, 0.55}) {
        SCOPED_TRACE(x);
        const std::size_t slot = bent.nearest({x, 0, x < 1 ? round(x) : 0});
        const auto root = bent.reach.rootOfLimb(slot, usual, 0.01);
        ASSERT_TRUE(root);
        EXPECT_LT((bent.position[*root] - bent.position[nose]).norm(), 0.1);
        const auto extent = bent.turnedAt(*root, usual);
        ASSERT_TRUE(extent->joint);
        EXPECT_NEAR((*extent->joint)[0], 0.4, 0.15) << "in the neck";
        EXPECT_LT(std::hypot((*extent->joint)[1], (*extent->joint)[2]), 0.05);
        EXPECT_GT(extent->shareOf(slot), 0.5);
        EXPECT_EQ(extent->shareOf(bent.nearest({0, 0, 0.35})), 0) << "the body stays";
    }
    EXPECT_NEAR(bent.reach.radiusAt(nose, usual), 0.85, 0.15) << "so far a pull reaches, too";
    for (const double x : {-1.0, -0.5})
        EXPECT_FALSE(bent.reach.rootOfLimb(bent.nearest({x, 0, 0.35}), usual, 0.01)) << x;

    Bent ball(TurnedBody([](double x) { return std::sqrt(1 - x * x); }));
    for (const double x : {1.0, 0.0})
        for (const double reach : {0.3, 0.8}) {
            const std::size_t slot = ball.nearest({x, 0, std::sqrt(1 - x * x)});
            EXPECT_FALSE(ball.reach.rootOfLimb(slot, reach, 0.01)) << x;
            EXPECT_EQ(ball.reach.radiusAt(slot, reach), reach);
        }
}

TEST(BendModel, AFingerIsALimbOfItsOwn) {
    // A body, from x = 0 on an arm of 0.16, and from 0.6 to 0.75 a finger of 0.04.
    Shape figure = Limb(1, 500, {0, 0, 0}, 1, 48);
    for (Eigen::Vector3d &p : figure.position) {
        const double x = p[0] > 0 ? 0.75 * p[0] : p[0];
        const double thick = x < 0 ? 0.24 : x < 0.05 ? 0.24 - 3.2 * x : x < 0.6 ? 0.08 : x < 0.63 ? 0.68 - x : 0.02;
        p = {x, thick * p[1], thick * p[2]};
    }
    Bent bent(figure);
    const double usual = 0.3;
    for (const double x : {0.67, 0.70, 0.72, 0.75}) { // up to its end
        const std::size_t slot = bent.nearest({x, 0, 0.02});
        bent.reach.lookAt(slot);
        for (BendReach *reach : {&bent.reach, &bent.reach.glance()}) {
            SCOPED_TRACE(testing::Message() << "from " << x << (reach == &bent.reach ? "" : ", at a glance"));
            const auto root = reach->rootOfLimb(slot, usual, 0.01);
            ASSERT_TRUE(root);
            const double radius = reach->radiusAt(*root, usual);
            EXPECT_NEAR(radius, 2 * 0.04, 0.03) << "twice the finger's thickness";
            const auto joint = reach->whole({*root}, radius, 0.01)->joint;
            ASSERT_TRUE(joint);
            EXPECT_NEAR((*joint)[0], 0.63, 0.04) << "one thickness from where it begins";
        }
    }
    for (const double x : {0.3, 0.45, 0.55}) {
        const auto root = bent.reach.rootOfLimb(bent.nearest({x, 0, 0.08}), usual, 0.01);
        ASSERT_TRUE(root) << x;
        EXPECT_NEAR(bent.position[*root][0], 0.05 + 0.16, 0.1) << "the arm turns as before";
    }
    EXPECT_FALSE(bent.reach.rootOfLimb(bent.nearest({-0.5, 0, 0.24}), usual, 0.01));
}

namespace {

/// The faces of cubes of a grid, of those in which a body is. \param isIn tells that of a cube's middle
template <class IsIn>
Shape BlocksOf(double size, const Eigen::AlignedBox3d &box, const IsIn &isIn) {
    using Cube = std::array<int, 3>;
    std::set<Cube> inside;
    const Eigen::Vector3i from = (box.min() / size).cast<int>(), to = (box.max() / size).cast<int>();
    for (int x = from[0]; x < to[0]; ++x)
        for (int y = from[1]; y < to[1]; ++y)
            for (int z = from[2]; z < to[2]; ++z)
                if (isIn(Eigen::Vector3d((x + 0.5) * size, (y + 0.5) * size, (z + 0.5) * size)))
                    inside.insert({x, y, z});
    Shape s;
    std::map<Cube, int> corners;
    const auto corner = [&](const Cube &at) {
        const auto [found, isNew] = corners.insert({at, int(s.position.size())});
        if (isNew)
            s.position.emplace_back(size * at[0], size * at[1], size * at[2]);
        return found->second;
    };
    for (const Cube &own : inside)
        for (std::size_t side = 0; side < 6; ++side) {
            const std::size_t axis = side / 2, one = (axis + 1) % 3, two = (axis + 2) % 3;
            Cube other = own, at = own;
            other[axis] += side % 2 ? 1 : -1;
            if (inside.count(other) > 0)
                continue;
            at[axis] += int(side % 2);
            std::array<int, 4> v{};
            for (std::size_t k = 0; k < 4; ++k) {
                Cube c = at;
                c[one] += k == 1 || k == 2;
                c[two] += k >= 2;
                v[k] = corner(c);
            }
            if (side % 2 == 0)
                std::swap(v[1], v[3]);
            s.face.push_back({v[0], v[1], v[2]});
            s.face.push_back({v[0], v[2], v[3]});
        }
    return s;
}

/// Whether a point is within \p thick of the line from \p a to \p b.
bool isNear(const Eigen::Vector3d &p, const Eigen::Vector3d &a, const Eigen::Vector3d &b, double thick) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm() < thick;
}

} // namespace

TEST(BendModel, ALimbTurnsWithoutTheNextOne) {
    // A trunk with a head, that is thicker than its neck, and two arms.
    const auto isIn = [&](const Eigen::Vector3d &p) {
        const Eigen::Vector3d half(std::abs(p[0]), p[1], p[2]);
        return isNear(p, {0, -0.9, 0}, {0, 0, 0}, 0.19) || isNear(p, {0, 0, 0}, {0, 0.3, 0}, 0.08) ||
               isNear(p, {0, 0.36, 0}, {0, 0.42, 0}, 0.14) || isNear(half, {0.1, 0.05, 0}, {0.9, -0.5, 0}, 0.08);
    };
    Bent bent(BlocksOf(0.02, {Eigen::Vector3d(-1, -1.1, -0.2), Eigen::Vector3d(1, 0.6, 0.2)}, isIn));
    const double usual = 0.15 * bent.model.ground.diagonal, hair = usual / 5;
    const std::array<std::size_t, 3> ends = {bent.nearest({0, 0.56, 0}), bent.nearest({0.95, -0.5, 0}),
                                             bent.nearest({-0.95, -0.5, 0})}; // head, arms
    std::array<int, 3> turned{};
    const auto numberOf = [](const Eigen::Vector3d &p) {
        return p[1] > 0.24 ? 0 : p[0] > 0.35 ? 1 : p[0] < -0.35 ? 2 : 3;
    };
    for (std::size_t slot = 0; slot < bent.position.size(); slot += 151) {
        const auto root = bent.reach.rootOfLimb(slot, usual, hair);
        if (!root)
            continue;
        const auto extent = bent.turnedAt(*root, usual, hair);
        SCOPED_TRACE(testing::Message() << "from " << bent.position[slot].transpose());
        EXPECT_GT(extent->shareOf(slot), 0.5f) << "what is dragged goes along";
        const int own = numberOf(bent.position[slot]);
        int limbs = 0;
        for (int k = 0; k < 3; ++k) {
            const bool isTurned = extent->shareOf(ends[std::size_t(k)]) > 0.5f;
            limbs += isTurned;
            turned[std::size_t(k)] += isTurned && own == k;
        }
        EXPECT_LE(limbs, 1);
    }
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_GT(turned[k], 3) << k;
}

TEST(BendModel, AShortPointedEndIsALimb) {
    // A tail like a cone, which is no longer than the reach, on a body 0.9 thick.
    Bent bent(TurnedBody([](double x) { return x < 0.5 ? 0.45 : 0.25 - 0.5 * (x - 0.5); }));
    const double usual = 0.5;
    for (const double x : {1.0, 0.8}) {
        const std::size_t slot = bent.nearest({x, 0, 0.25 - 0.5 * (x - 0.5)});
        const auto root = bent.reach.rootOfLimb(slot, usual, 0.01);
        ASSERT_TRUE(root) << x;
        const auto extent = bent.turnedAt(*root, usual);
        ASSERT_TRUE(extent->joint) << x;
        EXPECT_NEAR((*extent->joint)[0], 0.6, 0.15) << "in the tail";
        EXPECT_LT(std::hypot((*extent->joint)[1], (*extent->joint)[2]), 0.05);
        EXPECT_GT(extent->shareOf(slot), 0.5);
    }
    // The corners of boxes, of which the second one is a plate, are pulled.
    for (const double thick : {0.8, 0.1}) {
        const Eigen::AlignedBox3d box(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.8, 0.8, thick));
        Bent corners(BlocksOf(0.05, {box.min(), box.max() + Eigen::Vector3d::Constant(0.01)},
                              [](const Eigen::Vector3d &) { return true; }));
        for (const double reach : {0.2, 0.3})
            EXPECT_FALSE(corners.reach.rootOfLimb(corners.nearest(box.max()), reach, 0.01)) << thick << ", " << reach;
    }
}

TEST(BendModel, HornsAreNoLimbsOfTheirOwnAndArmsAre) {
    const double cell = 0.03;
    for (const double longer : {0.0, 0.8}) {
        const auto isIn = [&](const Eigen::Vector3d &p) {
            const Eigen::Vector3d half(std::abs(p[0]), p[1], p[2]);
            return isNear(p, {0, -0.9, 0}, {0, -0.2, 0}, 0.45) || isNear(p, {0, 0, 0}, {0, 0.6, 0}, 0.2) ||
                   isNear(half, {0.15, 0.3, 0}, {0.5 + longer, 0.3, 0}, 0.035 + 0.05 * longer);
        };
        Bent bent(BlocksOf(cell, {Eigen::Vector3d(-1.4, -1.4, -0.5), Eigen::Vector3d(1.4, 0.9, 0.5)}, isIn));
        const auto extent = bent.reach.extent({bent.nearest({0, 0.8, 0})}, 0.85);
        EXPECT_FALSE(extent->tips.empty());
        EXPECT_EQ(extent->isOneLimb, longer == 0);
    }
}

TEST(BendModel, LegsOnBothSidesHoldTheSame) {
    // The sides of an animal mirror each other in z, but the diagonals of their squares do not.
    const double cell = 0.025;
    const auto isIn = [](const Eigen::Vector3d &p) {
        const Eigen::Vector3d half(std::abs(p[0]), p[1], std::abs(p[2]));
        return isNear(p, {-0.6, 0, 0}, {0.6, 0, 0}, 0.19) || isNear(half, {0.5, -0.05, 0.13}, {0.5, -0.75, 0.13}, 0.07);
    };
    Bent bent(BlocksOf(cell, {Eigen::Vector3d(-0.9, -0.9, -0.3), Eigen::Vector3d(0.9, 0.3, 0.3)}, isIn));
    const double usual = 0.17 * bent.model.ground.diagonal, hair = usual / 5;
    const auto cellOf = [cell](const Eigen::Vector3d &p) {
        return std::array<long, 3>{std::lround(p[0] / cell), std::lround(p[1] / cell), std::lround(p[2] / cell)};
    };
    std::map<std::array<long, 3>, std::size_t> slotAt;
    for (std::size_t i = 0; i < bent.position.size(); ++i)
        slotAt[cellOf(bent.position[i])] = i;
    std::vector<std::size_t> twin;
    for (const Eigen::Vector3d &p : bent.position)
        twin.push_back(slotAt.at(cellOf({p[0], p[1], -p[2]})));
    int turned = 0;
    for (const double y : {-0.5, -0.35})
        for (const Eigen::Vector3d &side : {Eigen::Vector3d(0.07, 0, 0), {-0.05, 0, -0.05}}) {
            const auto root = bent.reach.rootOfLimb(bent.nearest(Eigen::Vector3d(0.5, y, 0.13) + side), usual, hair);
            if (!root)
                continue;
            bent.model.state = BendState();
            for (const auto &[tag, slot] : {std::pair{2, *root}, {3, twin[*root]}})
                bent.model.state.points[tag] = {slot, bent.reach.radiusAt(*root, usual), true};
            bent.update();
            const BendTags &tags = *bent.model.influence.tags;
            int differ = 0, held = 0;
            for (std::size_t i = 0; i < twin.size(); ++i) {
                const int other = tags[twin[i]];
                held += tags[i] >= 2;
                differ += tags[i] != (other == 2 ? 3 : other == 3 ? 2 : other);
            }
            ++turned;
            EXPECT_LT(differ, 0.05 * held) << "from " << y << ", " << side.transpose() << "; it was a quarter";
        }
    EXPECT_GT(turned, 2);
}

TEST(BendModel, TheStripThatBendsIsAboutAsWideOnAllSides) {
    const double thickness = 0.16, step = 2. / 119;
    const int columns = 32;
    Bent bent(Limb(thickness / 2, 120, {0, 0, 0}, 1, columns));
    const double reach = bent.reach.radiusAt(bent.nearest({0.44, 0, 0.08}), 0.3);
    EXPECT_NEAR(reach, 2 * thickness, step);
    bent.addPoint(2, {0.44, 0, 0.08}, reach, true);
    for (int c = 0; c < columns; ++c) {
        const double turn = c * 2 * EIGEN_PI / columns;
        double fixed = -1, held = 1;
        for (std::size_t i = 0; i < bent.position.size(); ++i) {
            const Eigen::Vector3d &p = bent.position[i];
            if ((Eigen::Vector2d(std::cos(turn), std::sin(turn)) * thickness / 2 - p.tail<2>()).norm() > 1e-6)
                continue;
            const int tag = (*bent.model.influence.tags)[i];
            if (tag == 0)
                fixed = std::max(fixed, p[0]);
            else if (tag == 2)
                held = std::min(held, p[0]);
        }
        EXPECT_NEAR(held - fixed, 1.5 * thickness, thickness / 2) << turn;
    }
}

TEST(BendModel, ALimbOfLongFacesHasARoot) {
    // Faces are longer than the cross-sections in which the root is looked for, so that some have no vertex.
    for (const int columns : {4, 10, 16}) {
        Shape figure = Limb(0.08, 8, {0, 0, 0}, 1, columns);
        for (Eigen::Vector3d &p : figure.position)
            if (p[0] < 0)
                p = {p[0], 2 * p[1], 2 * p[2]};
        Bent bent(figure);
        int turned = 0;
        for (std::size_t i = 0; i < figure.position.size(); ++i)
            if (const auto root = bent.reach.rootOfLimb(i, 0.3, 0.01)) {
                ++turned;
                ASSERT_LT(*root, figure.position.size());
                EXPECT_GT(bent.turnedAt(*root, 0.3)->shareOf(i), 0.5f);
            }
        EXPECT_GT(turned, columns);
    }
}

TEST(BendModel, ALineHasNoCoarserSurface) {
    Shape line = Limb(0.08, 700, {0, 0, 0}, 1, 16);
    for (std::size_t i = 0; i < line.position.size(); ++i)
        line.position[i] = {2.0 * double(i) / double(line.position.size()) - 1, 0, 0};
    Bent bent(line);
    const std::size_t slot = bent.nearest({0.5, 0, 0});
    bent.reach.lookAt(slot);
    EXPECT_EQ(&bent.reach.glance(), &bent.reach);
    EXPECT_FALSE(bent.reach.rootOfLimb(slot, 0.3, 0.01));
}

TEST(BendModel, AStrokeGivesTheJointAndWhatLiesBeyond) {
    // A limb 0.16 thick on a body three times as thick, at an angle; also with many vertices, for the preview.
    const Eigen::AngleAxisd turned(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    const double usual = 0.3, hair = 0.01, thickness = 0.16;
    for (const bool isFine : {false, true}) {
        Shape figure = isFine ? Limb(0.08, 500, {0, 0, 0}, 1, 64) : Limb(0.08, 200, {0, 0, 0}, 1, 24);
        for (Eigen::Vector3d &p : figure.position) {
            const double thick = p[0] < 0 ? 3 : p[0] < 0.05 ? 3 - 40 * p[0] : 1;
            p = turned * Eigen::Vector3d(p[0], thick * p[1], thick * p[2]);
        }
        Bent bent(figure);
        bent.reach.begin();
        const auto slotAt = [&](double x, double y, double z) {
            return bent.nearest(turned * Eigen::Vector3d(x, y, z));
        };
        for (const double x : {0.3, 0.45, 0.6})
            for (const double end : {x + 0.1, x + 0.2, 0.95}) { // shorter and longer than the limb is thick
                SCOPED_TRACE(testing::Message() << isFine << " from " << x << " to " << end);
                const std::size_t from = slotAt(x, 0, 0.08), to = slotAt(end, 0.05, 0.06);
                const auto [is, isLimb] = bent.reach.beyond(from, to, usual, hair);
                bent.reach.lookAt(from);
                const auto [seems, seemsLimb] = bent.reach.glance().beyond(from, to, usual, hair);
                ASSERT_TRUE(is && isLimb && seems && seemsLimb);
                EXPECT_LT((*seems->bends - *is->bends).norm(), 0.35 * thickness);
                const Eigen::Vector3d bends = turned.inverse() * *is->bends;
                EXPECT_NEAR(bends[0], x, 0.2 * thickness);
                EXPECT_LT(std::hypot(bends[1], bends[2]), 0.15 * thickness);
                EXPECT_NEAR(is->radius, 2 * thickness, 0.4 * thickness) << "three quarters of it bend";
                EXPECT_NEAR(seems->radius, is->radius, 0.2 * is->radius);
                bent.model.state.points[2] = {is->vertices.front(), is->radius, true};
                bent.update();
                const BendExtent &extent = *bent.model.influence.extents.at(2);
                EXPECT_EQ(extent.shareOf(slotAt(0.98, 0, 0.08)), 1);
                EXPECT_EQ(extent.shareOf(slotAt(x - 1.2 * thickness, 0, 0.08)), 0);
                EXPECT_EQ((*bent.model.influence.tags)[slotAt(x + 1.6 * thickness, 0, 0.08)], 2);
                EXPECT_EQ((*bent.model.influence.tags)[slotAt(x - 1.2 * thickness, 0, 0.08)], 0);
            }
        EXPECT_FALSE(bent.reach.beyond(slotAt(0.5, 0, 0.08), slotAt(-0.5, 0, 0.24), usual, hair).first)
            << "what lies beyond is the body";
    }
}

TEST(BendModel, AStrokeAtAWristTakesTheWiderHandAlong) {
    Shape arm = Limb(0.06, 300, {0, 0, 0}, 1, 40);
    for (Eigen::Vector3d &p : arm.position) // a flat hand of twice the width
        p = {p[0], p[1] * (p[0] < 0.6 ? 1 : std::min(2.0, 1 + 8 * (p[0] - 0.6))), p[2] * (p[0] < 0.6 ? 1 : 0.7)};
    Bent bent(arm);
    for (const double y : {0.0, 0.06}) { // on the back of the hand, and at its edge
        const auto [is, isLimb] =
            bent.reach.beyond(bent.nearest({0.55, y, 0.06 - y}), bent.nearest({0.85, 2 * y, 0.04}), 0.3, 0.01);
        ASSERT_TRUE(is && isLimb);
        EXPECT_LT((*is->bends - Eigen::Vector3d(0.55, 0, 0)).norm(), 0.04) << is->bends->transpose();
        bent.model.state.points[2] = {is->vertices.front(), is->radius, true};
        bent.update();
        EXPECT_EQ(is->shareOf(bent.nearest({0.95, 0.12, 0})), 1);
        EXPECT_EQ(is->shareOf(bent.nearest({0.95, -0.12, 0})), 1);
        EXPECT_EQ(bent.tagAt({0.3, 0, 0.06}), 0);
    }
}

TEST(BendModel, AStrokeOnNoLimbReachesAsFarAsItIsLong) {
    const Shape thick = Limb(0.5, 120, {0, 0, 0}, 1, 64);
    Bent bent(Join(thick, Limb(0.02, 9, {0, 5, 0}, 0.05)));
    const double x = -0.1, length = 0.3, hair = 0.01;
    const std::size_t end = bent.nearest({x + length, 0, 0.5});
    const auto [extent, isLimb] = bent.reach.beyond(bent.nearest({x, 0, 0.5}), end, 0.2, hair);
    ASSERT_TRUE(extent);
    EXPECT_FALSE(isLimb);
    EXPECT_EQ(extent->vertices, std::vector<std::size_t>{end});
    bent.model.state.points[2] = {end, extent->radius, true};
    bent.update();
    EXPECT_EQ(bent.tagAt({x + 0.5 * length, 0, 0.5}), 2) << "turns";
    EXPECT_EQ(bent.tagAt({x, 0, 0.5}), 1) << "in the middle of what bends";
    EXPECT_EQ(bent.tagAt({x - 0.5 * length, 0, 0.5}), 0) << "stays";
    EXPECT_FALSE(bent.reach.beyond(end, bent.nearest({0, 5, 0}), 0.2, hair).first) << "another part";
    EXPECT_FALSE(bent.reach.beyond(end, end, 0.2, hair).first) << "leads nowhere";
}

TEST(BendModel, AHandleBendsAsFarAsItsLimbIsThick) {
    for (const double thickness : {0.06, 0.12, 0.16}) {
        Bent bent(Limb(thickness / 2));
        const std::size_t slot = bent.nearest({0.4, thickness / 2, 0});
        EXPECT_NEAR(bent.reach.radiusAt(slot, radius), 2 * thickness, 0.3 * thickness);
        EXPECT_EQ(bent.reach.radiusAt(slot, thickness), thickness) << "what does not reach around it knows of no limb";
    }
    Bent thick(Limb(0.5));
    EXPECT_EQ(thick.reach.radiusAt(thick.nearest({0, 0.5, 0}), radius), radius);
}

TEST(BendModel, SmallPartsGoWithWhatTheyLieOn) {
    const Shape limb = Limb();
    Bent bent(Join(Join(limb, Limb(0.02, 9, {0.5, 0.1, 0}, 0.05)),
                   Join(Limb(0.02, 9, {-0.5, 0.1, 0}, 0.05), Limb(0.08, 120, {0, 0.5, 0}))));
    bent.addPoint(2, {0.5, 0.08, 0}, radius);
    EXPECT_EQ(bent.tagAt({0.5, 0.12, 0}), 1) << "the nail on it";
    EXPECT_EQ(bent.tagAt({-0.5, 0.12, 0}), 0) << "another one";
    EXPECT_EQ(bent.tagAt({0.5, 0.42, 0}), 0) << "a large part beside it";
    const std::size_t nail = bent.nearest({0.5, 0.12, 0}),
                      carrier = bent.reach.carrierOf(nail, usualGap(bent.model.ground.diagonal));
    EXPECT_LT(carrier, limb.position.size()) << "is pulled in the nail's place";
    EXPECT_NEAR(bent.position[carrier][0], 0.5, 0.1);
}

TEST(BendModel, ALimbOfTwoJointsIsAChainUnlessTheFirstIsLocked) {
    Bent bent(Limb());
    bent.addPoint(2, {0.35, 0.08, 0}, radius, true);
    const Eigen::Vector3d hand(0.95, 0.08, 0);
    EXPECT_EQ(jointBefore(bent.model, 2, hand), 0) << "it is the only one";
    bent.addPoint(3, {0.65, 0.08, 0}, radius, true);
    EXPECT_TRUE(turnsLimb(bent.model, 2) && turnsLimb(bent.model, 3));
    EXPECT_EQ(jointBefore(bent.model, 3, hand), 2);
    EXPECT_EQ(jointBefore(bent.model, 2, hand), 0);
    EXPECT_EQ(jointBefore(bent.model, 3, {0.5, 0.08, 0}), 0) << "too near to be a bone";
    BendHandle held;
    held.isLocked = true;
    setHandle(bent.model.state, 2, held);
    EXPECT_EQ(jointBefore(bent.model, 3, hand), 0);
    bent.addPoint(2, {0.35, 0.08, 0}, radius, false);
    EXPECT_FALSE(turnsLimb(bent.model, 2)) << "it was pulled";
    setHandle(bent.model.state, 2, {});
    EXPECT_EQ(jointBefore(bent.model, 3, hand), 0);
}

TEST(BendModel, WhatLiesBeyondGoesAlongUnlessItIsLocked) {
    Bent bent(Limb());
    bent.addPoint(2, {0.8, 0.08, 0}, radius);
    bent.addPoint(3, {0.4, 0.08, 0}, radius);
    EXPECT_EQ(carriedBy(bent.model, 3), std::vector<int>{2});
    EXPECT_TRUE(carriedBy(bent.model, 2).empty());
    setHandle(bent.model.state, 2, {"hand", false, true, {}});
    EXPECT_TRUE(carriedBy(bent.model, 3).empty());
    EXPECT_EQ(nameOf(bent.model.state, 2), "hand");
    setHandle(bent.model.state, 2, {});
    EXPECT_EQ(nameOf(bent.model.state, 2), "Handle 2");
    EXPECT_TRUE(bent.model.state.handles.empty());
}

TEST(BendModel, ANewHandleLeavesWhatOthersBend) {
    Bent bent(Limb(0.25));
    bent.addPoint(2, {-0.4, 0.25, 0}, radius);
    const BendTags before = *bent.model.influence.tags;
    bent.model.state.motion[2] = {MotionStep::Translate({0, 1, 0})};
    ASSERT_EQ(rankOfNew(bent.model.state), 1);
    bent.model.state.rank[3] = 1;
    bent.addPoint(3, {0.05, 0.25, 0}, radius);
    EXPECT_TRUE(isKeptApart(bent.model, 3));
    EXPECT_FALSE(isKeptApart(bent.model, 2));
    for (std::size_t i = 0; i < before.size(); ++i)
        if (before[i] != 0)
            EXPECT_EQ((*bent.model.influence.tags)[i], before[i]) << bent.position[i].transpose();
    setRadiusOf(bent.model.state, 3, radius); // as by the user
    bent.update();
    EXPECT_FALSE(isKeptApart(bent.model, 3));
}

TEST(BendModel, FingersBesideEachOtherBendTogether) {
    // A palm with two fingers, of which the one was turned.
    const auto isIn = [](const Eigen::Vector3d &p) {
        const Eigen::Vector3d half(std::abs(p[0]), p[1], p[2]);
        return isNear(half, {0.15, -0.5, 0}, {0.15, 0, 0}, 0.2) || isNear(half, {0.11, 0, 0}, {0.16, 0.8, 0}, 0.09);
    };
    Bent bent(BlocksOf(0.02, {Eigen::Vector3d(-0.5, -0.8, -0.3), Eigen::Vector3d(0.5, 1, 0.3)}, isIn));
    const double reach = 0.36; // twice the thickness
    for (const auto &[tag, x] : {std::pair{2, -0.13}, {3, 0.13}}) {
        bent.model.state.rank[tag] = tag - 2;
        bent.addPoint(tag, {x, 0.42, 0.09}, reach, true);
        bent.model.state.motion[tag] = {MotionStep::Rotate({1, 0, 0}, 40)};
    }
    bent.update();
    const BendTags &tags = *bent.model.influence.tags;
    int fixed = 0, bends = 0;
    for (const int tag : {2, 3}) {
        const BendExtent &extent = *bent.model.influence.extents.at(tag);
        for (const std::size_t i : extent.around) {
            fixed += tags[i] == 0;
            bends += tags[i] == 1;
        }
    }
    EXPECT_EQ(fixed, 0) << "no gap cuts the strip that bends at a root";
    EXPECT_GT(bends, 100);
    EXPECT_FALSE(isKeptApart(bent.model, 3));
}

TEST(BendModel, MarksNeverTouch) {
    Bent bent(Limb(0.25));
    const double rim = 0.5, gap = gapOfRadius * rim;
    bent.mark(0, rim, [](const auto &p) { return p[0] < 0; });
    EXPECT_EQ(bent.mark(2, rim, [](const auto &p) { return p[0] >= 0; }), std::set<int>{2});
    EXPECT_FALSE(bent.model.influence.isLocal) << "something is fixed";
    EXPECT_EQ(bent.tagAt({-gap / 2, 0.25, 0}), 1) << "what is fixed yields";
    EXPECT_EQ(bent.tagAt({gap / 2, 0.25, 0}), 2);
    EXPECT_EQ(bent.tagAt({-2 * gap, 0.25, 0}), 0);
    EXPECT_EQ((*bent.model.state.marks)[bent.nearest({-gap / 2, 0.25, 0})], 0) << "the mark is as it was made";
    bent.mark(3, rim, [](const auto &p) { return p[0] > 0.7; });
    EXPECT_EQ(bent.tagAt({0.7 - gap / 2, 0.25, 0}), 1) << "the older handle yields";
    EXPECT_EQ(bent.tagAt({0.75, 0.25, 0}), 3);
    freeHandle(bent.model.state, 3);
    bent.update();
    EXPECT_EQ(bent.tagAt({0.75, 0.25, 0}), 1);
    bent.mark(1, rim, [](const auto &) { return true; });
    EXPECT_EQ(bent.model.state.marks, nullptr);
}

TEST(BendModel, AMarkThatWouldBeGoneStays) {
    Bent bent(Limb(0.25));
    bent.mark(0, 0.5, [](const auto &p) { return std::abs(p[0]) < 0.02; });
    bent.mark(2, 0.5, [](const auto &p) { return p[0] > 0.03; });
    EXPECT_EQ(bent.tagAt({0, 0.25, 0}), 0);
}

TEST(BendModel, MarksTakeThePlacesOfPoints) {
    Bent bent(Limb(0.25));
    bent.addPoint(2, {0.5, 0.25, 0}, radius);
    bent.addPoint(3, {-0.5, 0.25, 0}, radius);
    bent.model.state.motion = {{2, {MotionStep::Translate({0, 1, 0})}}, {3, {MotionStep::Translate({0, 1, 0})}}};
    bent.model.state.weights = {100};
    bent.mark(0, 0.1, [](const auto &p) { return p[0] > 0.3; });
    forgetGone(bent.model);
    EXPECT_EQ(bent.model.influence.handles(), std::vector<int>{3});
    EXPECT_EQ(bent.model.state.motion.count(2), 0U);
    EXPECT_EQ(bent.model.state.motion.count(3), 1U);
    EXPECT_TRUE(bent.model.state.weights.empty()) << "a pose without a handle is another one";
    EXPECT_EQ(bent.model.influence.unusedTag(), 2);
}

TEST(BendModel, TheMirrorHasAnotherHandleThere) {
    Bent bent(Limb(0.25));
    for (const auto &[tag, x] : {std::pair{2, 0.5}, {3, -0.5}, {4, 0.0}, {5, -0.04}})
        bent.addPoint(tag, {x, 0.25, 0}, 0.1);
    EXPECT_EQ(mirrored(bent.model, 2), 0) << "there is no mirror";
    bent.model.options.mirror = 0;
    EXPECT_EQ(mirrored(bent.model, 2), 3);
    EXPECT_EQ(mirrored(bent.model, 3), 2);
    EXPECT_EQ(mirrored(bent.model, 4), 0) << "it is in the middle, though another one is near";
    setMotion(bent.model, {{2, {MotionStep::Rotate({0, 0, 1}, 30), MotionStep::Translate({1, 2, 3})}}});
    EXPECT_EQ(motionTextOf(bent.model.state, 3), "rotate -0 -0 -1 30 translate -1 2 3");
    const Eigen::Vector3d joint(0.4, 0.1, 0.05), there(-0.4, 0.1, 0.05);
    setPivot(bent.model, 2, motionAt(bent.model, 2) * joint);
    ASSERT_TRUE(handleOf(bent.model.state, 2).pivot && handleOf(bent.model.state, 3).pivot);
    EXPECT_LT((*handleOf(bent.model.state, 2).pivot - joint).norm(), 1e-12);
    EXPECT_LT((*handleOf(bent.model.state, 3).pivot - there).norm(), 1e-12) << "at rest, as the pose is mirrored, too";
    setPivot(bent.model, 3, {});
    EXPECT_FALSE(handleOf(bent.model.state, 2).pivot || handleOf(bent.model.state, 3).pivot);
    setPivot(bent.model, 4, joint);
    EXPECT_FALSE(handleOf(bent.model.state, 5).pivot) << "it has no twin";
    setMotion(bent.model, {{4, {MotionStep::Translate({1, 0, 0})}}});
    EXPECT_EQ(motionOf(bent.model.state, 5).size(), 0U);
    setMotion(bent.model, {{2, {}}});
    BendHandle locked = handleOf(bent.model.state, 3);
    locked.isLocked = true;
    setHandle(bent.model.state, 3, locked);
    setMotion(bent.model, {{2, {MotionStep::Translate({1, 0, 0})}}});
    EXPECT_EQ(motionOf(bent.model.state, 3).size(), 0U) << "a locked handle stays where it is";
    for (const int tag : {2, 3, 4, 5})
        EXPECT_FALSE(lacksTwin(bent.model, tag)) << tag;
    bent.addPoint(6, {0.8, 0.25, 0}, 0.1);
    EXPECT_TRUE(lacksTwin(bent.model, 6));
    bent.model.options.mirror = -1;
    EXPECT_FALSE(lacksTwin(bent.model, 6));
    bent.model.options.mirror = 0;
    EXPECT_TRUE(isTwin(bent.model, bent.nearest({0.5, 0.25, 0}), bent.nearest({-0.5, 0.25, 0})));
    EXPECT_FALSE(isTwin(bent.model, bent.nearest({0.5, 0.25, 0}), bent.nearest({-0.5, -0.25, 0}))) << "a lopsided one";
}

TEST(BendModel, AHandleTurnsAboutItsPivot) {
    Bent bent(Limb());
    bent.addPoint(2, {0.5, 0.08, 0}, radius);
    EXPECT_EQ(pivotOf(bent.model, 2), bent.position[bent.nearest({0.5, 0.08, 0})]);
    setMotion(bent.model, {{2, {MotionStep::Translate({0, 1, 0})}}});
    EXPECT_LT((dotOf(bent.model, 2) - Eigen::Vector3d(0.5, 1.08, 0)).norm(), 0.02);
    setPivot(bent.model, 2, Eigen::Vector3d(0.2, 1, 0));
    EXPECT_LT((pivotOf(bent.model, 2) - Eigen::Vector3d(0.2, 1, 0)).norm(), 1e-12);
    setMotion(bent.model, {{2, {MotionStep::Translate({0, 2, 0})}}});
    EXPECT_LT((pivotOf(bent.model, 2) - Eigen::Vector3d(0.2, 2, 0)).norm(), 1e-12) << "it goes with the handle";
    setPivot(bent.model, 2, {});
    EXPECT_EQ(pivotOf(bent.model, 2), dotOf(bent.model, 2));
    bent.model.state.weights = {100};
    setPose(bent.model, 0);
    EXPECT_FALSE(isMoved(bent.model));
    EXPECT_TRUE(bent.model.state.weights.empty());
    EXPECT_THROW(setMotions(bent.model, "9: scale 2"), Error);
    EXPECT_THROW(setMotionText(bent.model, 2, "foo"), Error);
}

TEST(BendModel, AMotionIsToldInAFewWords) {
    BendState state;
    EXPECT_EQ(shortMotionOf(state, 2), "");
    state.motion[2] = {MotionStep::Rotate({0, 0, -1}, 45), MotionStep::Translate({3, 4, 0}),
                       MotionStep::Rotate({0, 0, 1}, 60)};
    EXPECT_EQ(shortMotionOf(state, 2), "turn 60\u00b0, move 5, turn -45\u00b0") << "what was done last is seen first";
    state.motion[2] = {MotionStep::Scale({1, 2, 1})};
    EXPECT_EQ(shortMotionOf(state, 2), "scale 2");
}

TEST(BendModel, UndoGoesBackAndForth) {
    History<BendState> history{3};
    BendState now;
    EXPECT_FALSE(history.undo(now));
    for (int i = 1; i < 6; ++i) {
        history.begin(now);
        history.begin(now); // without a change
        now.pose = i;
    }
    for (const double pose : {4.0, 3.0, 2.0}) {
        EXPECT_TRUE(history.undo(now));
        EXPECT_EQ(now.pose, pose);
    }
    EXPECT_FALSE(history.undo(now)) << "only so many are kept";
    EXPECT_TRUE(history.redo(now));
    EXPECT_EQ(now.pose, 3);
    history.begin(now);
    now.pose = 9;
    EXPECT_TRUE(history.cancel(now));
    EXPECT_EQ(now.pose, 3);
    EXPECT_FALSE(history.redo(now)) << "another way was taken";
    history.forget([](const BendState &state) { return state.pose < 3; });
    EXPECT_FALSE(history.undo(now));
}

TEST(BendModel, PosesHaveNamesAndTimes) {
    PoseSequence poses = withPose(withPose({}, "2: scale 2"), "2: scale 3");
    EXPECT_EQ(poses.pose[1].name, "Pose 2");
    EXPECT_EQ(poses.key.back().time, 2) << "from rest, a second each";
    EXPECT_EQ(poses.key.back().weight, (std::vector<double>{0, 100}));
    EXPECT_EQ(withPose(renamed(poses, 0, "Pose 3"), "").pose.back().name, "Pose 4") << "the name is not taken";
    poses = withoutPose(poses, 0);
    EXPECT_EQ(poses.key.size(), 2U) << "its key frame is gone";
    EXPECT_EQ(poses.key.back().time, 1) << "what came later comes earlier";
    BendState state;
    EXPECT_THROW(expectPoses(state), Error);
    state.poses = std::make_shared<const PoseSequence>(poses);
    EXPECT_THROW(withKeyFrame(state, true), Error) << "what is shown has no name";
    EXPECT_EQ(weightsOfPoses(state), std::vector<double>{0});
    state.weights = {50};
    EXPECT_EQ(withKeyFrame(state, true).key.back().weight, std::vector<double>{50});
    EXPECT_EQ(poseOfName(state, "Pose 2", 1), 0U);
    EXPECT_EQ(poseOfName(state, "Pose 2", 0), std::nullopt);
    std::vector<KeyFrame> frames = keyFrames(state);
    frames[0].time = 5;
    EXPECT_EQ(withKeyFrames(poses, frames).key.back().time, 5) << "they ascend";
}

TEST(BendModel, APartOfAnAnimationHasTheFramesOfTheWhole) {
    const PoseSequence poses = withPose(withPose({}, "2: scale 2"), "2: scale 3"); // smooth, from 0 to 2
    EXPECT_EQ(partOfAnimation(poses, 0, 2, 24).key.size(), 3U) << "all of it is as it is";
    const PoseSequence part = partOfAnimation(poses, 0.25, 1.5, 4);
    const std::vector<double> times = vcg::fcd::FrameTimes(part, 4);
    ASSERT_EQ(times, (std::vector<double>{0.25, 0.5, 0.75, 1, 1.25, 1.5}));
    for (const double time : times)
        EXPECT_EQ(part.WeightsAt(time), poses.WeightsAt(time)) << time;
    EXPECT_EQ(partOfAnimation(poses, 0.5, 0.5, 4).key.size(), 1U);
    EXPECT_THROW(partOfAnimation(poses, 1.5, 0.25, 4), Error);
    BendState state;
    EXPECT_THROW(expectAnimation(state), Error);
    state.poses = std::make_shared<const PoseSequence>(poses);
    EXPECT_EQ(expectAnimation(state).key.size(), 3U);
}

TEST(BendModel, GhostsAreTheKeyFramesBeside) {
    const std::vector<KeyFrame> keys = withPose(withPose({}, "2: scale 2"), "2: scale 3").key; // at 0, 1 and 2
    const std::vector<double> none, rest = {0, 0}, first = {100, 0}, second = {0, 100};
    const auto are = [&](double time, bool isShown, const std::vector<double> &before,
                         const std::vector<double> &after) {
        const GhostFrames ghosts = ghostFrames(keys, time, isShown);
        return ghosts.before == before && ghosts.after == after;
    };
    EXPECT_TRUE(are(0, true, none, first));
    EXPECT_TRUE(are(0.5, true, rest, first));
    EXPECT_TRUE(are(1, true, rest, second)) << "what is shown is no ghost";
    EXPECT_TRUE(are(1, false, first, second)) << "where something else is posed, it is one";
    EXPECT_TRUE(are(2, true, first, none));
    EXPECT_TRUE(are(2, false, second, none));
    EXPECT_TRUE(ghostFrames({keys.front()}, 1, true).before.empty()) << "one is no animation";
}

TEST(BendModel, AGhostHasTheShapeOfItsBlend) {
    Bent bent(Limb());
    bent.mark(0, 0, [](const Eigen::Vector3d &p) { return p[0] < -0.5; });
    bent.mark(2, 0, [](const Eigen::Vector3d &p) { return p[0] > 0.5; });
    BlendShapes shapes;
    shapes.surface = bent.arrays;
    shapes.tags = bent.model.influence.tags;
    shapes.world = Eigen::Translation3d(5, 0, 0) * Eigen::Scaling(2.0);
    const Motion up((Eigen::Matrix4d(Eigen::Affine3d(Eigen::Translation3d(0, 0.4, 0)).matrix())));
    shapes.poses = {{{2, up}}};
    const auto held = std::uint32_t(bent.nearest({0.9, 0, 0.08})), still = std::uint32_t(bent.nearest({-0.9, 0, 0.08}));
    const std::vector<float> whole = shapes.of({100}, {held, still}, {}), half = shapes.of({50}, {held}, {});
    EXPECT_NEAR(double(whole[1]), bent.position[held][1] + 0.2, 1e-5) << "layer units: its matrix makes 0.4 of that";
    EXPECT_NEAR(double(half[1]), bent.position[held][1] + 0.1, 1e-5);
    for (int d = 0; d < 3; ++d)
        EXPECT_EQ(whole[std::size_t(3 + d)], float(bent.position[still][d]));
    EXPECT_EQ(shapes.of({0}, {held}, {})[1], float(bent.position[held][1]));
    shapes.tags = std::make_shared<const BendTags>(bent.position.size(), 1);
    shapes.deformer = nullptr;
    EXPECT_THROW(shapes.of({100}, {held}, {}), Error) << "nothing is a handle";
}

TEST(BendModel, EachVertexHasItsFaces) {
    const Bent bent(Limb());
    const VertexFaces faces(bent.arrays);
    const SurfaceView surface = bent.arrays->View();
    ASSERT_EQ(faces.vertexSlots(), surface.vertexSlots);
    std::size_t corners = 0;
    for (std::size_t i = 0; i < surface.vertexSlots; ++i)
        faces.forEach(i, [&](const std::uint32_t *corner) {
            EXPECT_EQ(std::count(corner, corner + 3, i), 1);
            ++corners;
        });
    EXPECT_EQ(corners, 3 * surface.faces);
}

TEST(BendModel, StepsTellARigidMotion) {
    Eigen::Matrix3Xd from = Eigen::Matrix3Xd::Random(3, 30);
    from.colwise() -= from.rowwise().mean();
    const Eigen::Vector3d middle(4, 5, 6);
    EXPECT_TRUE(rigidSteps(from, from, middle, 1e-6).empty());
    const Eigen::Matrix3Xd to =
        (Eigen::Matrix3d(Eigen::Quaterniond(std::cos(0.25), 0, 0, std::sin(0.25))) * from).colwise() +
        Eigen::Vector3d(1, 0, 2);
    const std::vector<MotionStep> steps = rigidSteps(from, to, middle, 1e-6);
    EXPECT_EQ(steps.size(), 2u) << "a turn and a translation: " << WriteMotionText({{2, steps}});
    const Eigen::Affine3d whole(ToMotion(steps, middle).matrix);
    for (Index i = 0; i < from.cols(); ++i)
        EXPECT_LT((whole * (from.col(i) + middle) - (to.col(i) + middle)).norm(), 1e-4);
    std::vector<MotionStep> placed = {MotionStep::Translate({1, 0, 0}), MotionStep::Rotate({0, 0, 1}, 90)};
    EXPECT_TRUE(setPlaces(placed, middle));
    EXPECT_EQ(*placed[1].about, middle + Eigen::Vector3d(1, 0, 0));
    EXPECT_FALSE(setPlaces(placed, middle)) << "they say it already";
}

TEST(BendDrag, TheMouseAndNumbersMakeMotions) {
    Camera view; // 100 pixels are two units
    view.width = view.height = 100;
    BendDrag drag;
    drag.tag = 2;
    drag.pivot = {0, 0, 0};
    drag.from = drag.last = {50, 50, 0.5};
    drag.carried[3] = {MotionStep::Translate({0, 1, 0})};
    const auto text = [&](int tag) { return WriteMotionText({{tag, drag.motions(view).at(tag)}}); };
    EXPECT_FALSE(drag.step(view));
    drag.moveTo(view, {75, 50, 0.5});
    EXPECT_EQ(text(2), "2: translate 0.5 0 0");
    EXPECT_EQ(text(3), "3: translate 0.5 1 0") << "it goes along";
    drag.axis = 1;
    EXPECT_FALSE(drag.step(view)) << "along y it did not move";
    for (const auto &[typed, isRefused] : {std::pair{"1.5", false}, {"1x", true}, {"-", true}}) {
        drag.typed = typed;
        EXPECT_EQ(drag.isRefused(), isRefused) << typed;
        EXPECT_EQ(drag.step(view).has_value(), !isRefused);
    }
    drag.typed = "45";
    drag.kind = BendDrag::Turn;
    drag.axis = 2;
    EXPECT_EQ(text(2), "2: rotate 0 0 1 45");
    EXPECT_EQ(text(3), "3: translate 0 1 0 rotate 0 0 1 45 about 0 0 0") << "about the same place";
    drag.typed.clear();
    drag.angle = 33;
    drag.snap = true;
    EXPECT_EQ(std::abs(drag.step(view)->degrees), 35) << "in steps";
    drag.kind = BendDrag::Scale;
    drag.snap = false;
    drag.typed = "2";
    EXPECT_EQ(text(2), "2: scale 1 1 2");
}

TEST(BendDrag, ALimbFollowsTheMouse) {
    Camera view; // 100 pixels are two units; from z
    view.width = view.height = 100;
    BendDrag drag;
    drag.tag = 2;
    drag.kind = BendDrag::Limb;
    drag.isAbout = drag.modal = true;
    drag.pivot = {-0.5, 0, 0};
    drag.held = {0, 0, 0};
    drag.from = drag.last = {50, 50, 0.5};
    drag.carried[3] = {};
    EXPECT_EQ(drag.text(view).find("turn the limb: move the mouse"), 0U);
    const auto placeOf = [&](int tag, const Eigen::Vector3d &place) {
        const auto motions = drag.motions(view);
        return Eigen::Vector3d(Eigen::Affine3d(ToMotion(motions.at(tag), {0.3, 0.2, 0.1}).matrix) * place);
    };
    const auto to = [&](double x, double y) { // the mouse leads the held point there, world
        drag.moveTo(view, {50 + 50 * x, 50 + 50 * y, 0.5});
    };
    to(-0.5, 0.5); // a quarter of a circle
    for (const int tag : {2, 3})
        EXPECT_LT((placeOf(tag, drag.held) - Eigen::Vector3d(-0.5, 0.5, 0)).norm(), 1e-4) << tag;
    EXPECT_LT((placeOf(2, drag.pivot) - drag.pivot).norm(), 1e-4) << "it keeps its length";
    EXPECT_EQ(drag.steps(view).size(), 1U);
    to(-0.5, 0.3); // nearer to the joint: it points there, with its length
    EXPECT_LT((placeOf(2, drag.held) - Eigen::Vector3d(-0.5, 0.5, 0)).norm(), 1e-4);
    to(-0.5, 0.8); // out of reach: it keeps its length
    EXPECT_LT((placeOf(2, drag.held) - Eigen::Vector3d(-0.5, 0.5, 0)).norm(), 1e-4);
    EXPECT_EQ(drag.steps(view).size(), 1U);
    drag.typed = "30";
    drag.axis = 1;
    EXPECT_EQ(WriteMotionText({{2, drag.motions(view).at(2)}}), "2: rotate 0 1 0 30 about -0.5 0 0");
    drag.typed.clear();
    drag.axis = -1;
    drag = BendDrag();
    drag.tag = 2;
    drag.kind = BendDrag::Limb;
    drag.from = drag.last = {50, 50, 0.5};
    drag.pivot = {-0.5, 0, 0};
    drag.held = {-0.2, 0, -0.4}; // away from the eye: it turns into the view plane
    to(0.2, 0);
    const Eigen::Vector3d now = placeOf(2, drag.held);
    EXPECT_NEAR(now[0], 0, 1e-4);
    EXPECT_NEAR(std::abs(now[2]), 0, 1e-3);
    drag.snap = true;
    const double degrees = drag.step(view)->degrees;
    EXPECT_EQ(degrees, 5 * std::round(degrees / 5)) << "in steps";
}

namespace {

/// A drag of a limb, seen from z with 1000 pixels per unit, that begins at the held point.
BendDrag LimbDrag(const Eigen::Vector3d &held, const Eigen::Vector3d &joint,
                  const std::optional<Eigen::Vector3d> &before) {
    BendDrag drag;
    drag.tag = 2;
    drag.kind = BendDrag::Limb;
    drag.isAbout = true;
    drag.pivot = joint;
    drag.held = held;
    drag.from = drag.last = {1000 + 1000 * held[0], 1000 + 1000 * held[1], 0.5};
    if (before)
        drag.before = BendDrag::Before{*before, {{3, {}}, {4, {MotionStep::Translate({0, 0, 1})}}}};
    return drag;
}

Camera FromZ() {
    Camera view;
    view.width = view.height = 2000;
    return view;
}

Eigen::Affine3d MotionOf(const BendDrag &drag, int tag) {
    return Eigen::Affine3d(ToMotion(drag.motions(FromZ()).at(tag), {0.3, 0.2, 0.1}).matrix);
}

} // namespace

TEST(BendDrag, ALimbDoesNotJump) {
    // However near to the joint the mouse passes: one piece or two bones, bent or straight.
    const Eigen::Vector3d joint(-0.4, 0, 0), held(0.4, 0.03, 0.05);
    const auto before = [](double x, double y) { return std::optional(Eigen::Vector3d(x, y, 0)); };
    for (const auto &[middle, root] : {std::pair{joint, before(0, 0)},
                                       {Eigen::Vector3d(0, 0.2, 0.1), before(-0.4, 0)},
                                       {Eigen::Vector3d(0.05, 0.0, -0.05), before(-0.4, 0)},
                                       {Eigen::Vector3d(0, 0.015, 0.025), before(-0.4, -0.03)},
                                       {Eigen::Vector3d(0.1, 0.5, 0.2), before(0.3, -0.1)}}) {
        const bool isPiece = middle == joint;
        for (const double aside : {0.0, 0.002, 0.05, 0.2}) {
            BendDrag drag = LimbDrag(held, middle, isPiece ? std::nullopt : root);
            const Eigen::Vector3d goal(-1.2, aside, 0), way = 1000 * (goal - Eigen::Vector3d(held[0], held[1], 0));
            const int pixels = int(way.norm());
            Eigen::Affine3d last = MotionOf(drag, 2);
            EXPECT_TRUE(last.isApprox(Eigen::Affine3d::Identity())) << "it begins where it is";
            double most = 0;
            for (int i = 1; i <= pixels; ++i) {
                drag.moveTo(FromZ(), drag.from + double(i) / pixels * way);
                const Eigen::Affine3d now = MotionOf(drag, 2);
                most = std::max(most, (now * held - last * held).norm());
                most = std::max(most, 0.1 * (now.linear() - last.linear()).norm());
                last = now;
            }
            // A pixel is 0.001. Near the full length, bend and depth change by the root of the move.
            EXPECT_LT(most, 0.05) << "aside " << aside;
            BendDrag fast = LimbDrag(held, middle, isPiece ? std::nullopt : root);
            fast.moveTo(FromZ(), drag.from + way);
            EXPECT_LT((MotionOf(fast, 2) * held - last * held).norm(), 0.02) << "however few events tell of the way";
            drag.moveTo(FromZ(), drag.from);
            EXPECT_LT((MotionOf(drag, 2).matrix() - Eigen::Matrix4d::Identity()).norm(), 0.02) << "the way back";
        }
    }
}

TEST(BendDrag, ALimbOfTwoJointsIsAChain) {
    const Eigen::Vector3d root(-0.4, 0, 0), elbow(0, 0.2, 0.1), held(0.4, 0, 0);
    BendDrag drag = LimbDrag(held, elbow, root);
    drag.carried[5] = {};
    const auto to = [&](const Eigen::Vector3d &by) {
        drag.moveTo(FromZ(), drag.from + 1000 * by);
        return Eigen::Vector3d(MotionOf(drag, 2) * held);
    };
    for (const Eigen::Vector3d &by :
         {Eigen::Vector3d(-0.2, 0, 0), Eigen::Vector3d(-0.3, 0.2, 0), Eigen::Vector3d(-0.4, -0.4, 0)}) {
        const Eigen::Vector3d at = to(by);
        EXPECT_LT((at - held - by).norm(), 1e-4) << "it follows: " << by.transpose();
        const Eigen::Vector3d joint = MotionOf(drag, 3) * elbow;
        EXPECT_LT((joint - MotionOf(drag, 2) * elbow).norm(), 1e-4) << "the bones meet";
        EXPECT_LT((MotionOf(drag, 3) * root - root).norm(), 1e-4);
        EXPECT_LT((MotionOf(drag, 5).matrix() - MotionOf(drag, 2).matrix()).norm(), 1e-4) << "beyond the elbow";
        const Eigen::Affine3d lifted = MotionOf(drag, 3) * Eigen::Translation3d(0, 0, 1);
        EXPECT_LT((MotionOf(drag, 4).matrix() - lifted.matrix()).norm(), 1e-4) << "before it";
        EXPECT_GT(joint[1], 0.5 * at[1]) << "the elbow is on the side where it was";
    }
    EXPECT_NE(drag.text(FromZ()).find(", its middle joint by "), std::string::npos);
    to({-0.2, 0, 0});
    EXPECT_NEAR((MotionOf(drag, 3) * elbow)[2] / (MotionOf(drag, 3) * elbow)[1], 0.5, 1e-3) << "it bends in its plane";
    const double reach = (elbow - root).norm() + (held - elbow).norm();
    EXPECT_NEAR((to({0.8, 0.3, 0}) - root).norm(), reach, 1e-4) << "it is straight, and no longer";
    EXPECT_GT((to({-0.8, 0.0, 0}) - root).norm(), 0.2 * reach) << "no more bent than an elbow";
    drag.typed = "30"; // turns the last joint
    drag.axis = 2;
    EXPECT_EQ(WriteMotionText({{2, drag.motions(FromZ()).at(2)}, {3, drag.motions(FromZ()).at(3)}}),
              "2: rotate 0 0 1 30 about 0 0.2 0.1");
}

TEST(FrameScale, IsWhereFramesAndMarksAre) {
    const FrameScale bar{{1, 1.5, 3}, 24, 10, 96}; // 2 pixels a frame
    EXPECT_EQ(bar.last(), 48);
    EXPECT_EQ(bar.xOf(1), 10);
    EXPECT_EQ(bar.xOf(3), 106);
    EXPECT_EQ(bar.xOf(1.5), 34);
    EXPECT_EQ(bar.frameOf(1.5), 12);
    EXPECT_EQ(bar.frameOf(0), 0) << "before the first key frame";
    EXPECT_EQ(bar.frameOf(9), 48);
    EXPECT_EQ(bar.timeOf(12), 1.5);
    EXPECT_EQ(bar.keyAt(36, 4), 1U);
    EXPECT_EQ(bar.keyAt(30, 4), 1U) << "as far as it reaches";
    EXPECT_FALSE(bar.keyAt(39, 4));
    EXPECT_EQ(bar.timeAt(36, 4), 1.5) << "a mark is meant";
    EXPECT_EQ(bar.timeAt(36, 1), 1 + 13 / 24.);
    EXPECT_EQ(bar.timeAt(60.9, 4), 1 + 25 / 24.) << "the nearest frame";
    EXPECT_EQ(bar.timeAt(-50, 4), 1) << "beside the bar";
    EXPECT_EQ(bar.timeAt(500, 4), 3);
    const FrameScale crowded{{0, 0.01, 0.02}, 24, 0, 4};
    EXPECT_EQ(crowded.keyAt(2.5, 4), 1U) << "the nearest of several";

    EXPECT_EQ(bar.movedTo(1, 60.9), 1 + 25 / 24.) << "to the nearest frame";
    EXPECT_EQ(bar.movedTo(1, 200), 3 - 1 / 24.) << "a frame before the next";
    EXPECT_EQ(bar.movedTo(1, -50), 1 + 1 / 24.);
    EXPECT_EQ(bar.movedTo(2, 202), 5) << "beyond the bar";
    EXPECT_EQ(bar.movedTo(0, -14), 0.5);
    EXPECT_EQ(bar.movedTo(0, -500), 0) << "no animation begins before 0";
    EXPECT_EQ(crowded.movedTo(1, 3), 0.01) << "there is no room";

    const FrameScale odd{{0, 0.1}, 24, 0, 100}; // the last key frame lies between two frames
    EXPECT_EQ(odd.last(), 3) << "as FrameTimes has it";
    EXPECT_EQ(odd.timeOf(3), 0.1);
    EXPECT_EQ(odd.timeAt(98, 0), odd.timeOf(2));
    EXPECT_EQ(odd.timeAt(100, 0), 0.1);

    const FrameScale one{{2}, 24, 10, 96}, none{{}, 24, 10, 96};
    EXPECT_EQ(one.last(), 0);
    EXPECT_EQ(one.xOf(2), 10);
    EXPECT_EQ(one.timeAt(70, 4), 2);
    EXPECT_EQ(none.last(), 0);
    EXPECT_FALSE(none.keyAt(10, 4));
}

namespace {

/// A state with something in each member, and numbers of many digits.
BendState FullState(std::size_t vertexSlots) {
    BendState state;
    state.points[2] = {7, 1.0 / 3, true};
    state.points[11] = {3, 1e-7 / 3, false};
    BendHandle &handle = state.handles[2];
    handle.name = "Elbow  # left; \xc3\xa9";
    handle.isHidden = handle.isLocked = true;
    handle.pivot = Eigen::Vector3d(0.1, -1e30 / 3, 0);
    state.handles[3].name = "3";
    state.rank[11] = 2;
    BendTags marks(vertexSlots, 1);
    for (const std::size_t i : {0, 2, 4, 5})
        marks[i] = int(i) - 2;
    marks[vertexSlots - 1] = 2147483647;
    state.marks = std::make_shared<const BendTags>(marks);
    BendRims rims(vertexSlots, 0.f);
    for (const std::size_t i : {3, 4, 5, 9})
        rims[i] = 1.f / 3;
    rims[vertexSlots - 1] = 0.7f;
    state.rims = std::make_shared<const BendRims>(rims);
    state.motion[2] = {MotionStep::Rotate({1, 2, 3}, 100.0 / 3), MotionStep::Translate({1.0 / 3, 0, -0.1})};
    state.motion[2][0].about = Eigen::Vector3d(0.1, 0.2, 0.3);
    state.motion[11] = {MotionStep::Scale({1.1, 1.2, 1.3})};
    state.pose = 50;
    state.weights = {100.0 / 3, 0, -20};
    state.line = {{{3, 7, 9}, {0.2, 0.3, 0.5}, {0, 0, 0}}, {{3, 3, 3}, {0, 0, 0}, {1.0 / 3, 2, 3}}};
    return state;
}

BendOptions OtherOptions() {
    BendOptions options;
    options.smoothness = 0.01 / 3;
    options.pose = 50;
    options.falloff = Falloff::Sharp;
    options.elastic = true;
    options.rigidity = 0.25;
    options.initialPatches = 321;
    options.weights = MappingWeights::Euclidean;
    options.mirror = 2;
    options.axes = BendAxes::Surface;
    return options;
}

/// Vertex slots, some of them deleted.
std::vector<std::size_t> LiveSlots(std::size_t vertexSlots) {
    std::vector<std::size_t> live;
    for (std::size_t i = 0; i < vertexSlots; ++i)
        if (i % 5 != 1)
            live.push_back(i);
    return live;
}

} // namespace

TEST(BendText, HasAllThatIsKnown) {
    const BendState state = FullState(20);
    const BendOptions options = OtherOptions();
    const std::vector<std::size_t> live = LiveSlots(20);
    const std::string text = bendText(state, options, live);
    auto [read, how] = readBendText(text, "text", live, 20);
    ASSERT_TRUE(read.rims && read.marks);
    EXPECT_EQ(*read.rims, *state.rims);
    EXPECT_EQ(*read.marks, *state.marks);
    read.rims = state.rims; // compared by pointer
    read.marks = state.marks;
    EXPECT_TRUE(read == state) << text;
    EXPECT_TRUE(how.givesSameShape(options));
    EXPECT_EQ(how.mirror, 2);
    EXPECT_EQ(how.axes, BendAxes::Surface);

    // Without the deleted ones, the same vertices have other slots.
    const std::vector<std::size_t> packed = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const BendState there = readBendText(text, "text", packed, 16).first;
    EXPECT_EQ(live[there.points.at(2).slot], 7U);
    EXPECT_EQ(live[there.line[0].corner[2]], 9U);
    EXPECT_EQ((*there.rims)[3], (*state.rims)[live[3]]);
    EXPECT_EQ(bendText(there, how, packed), text);

    BendState named;
    named.handles[2].name = "two\nlines";
    EXPECT_EQ(readBendText(bendText(named, {}, packed), "text", packed, 16).first.handles.at(2).name, "two lines");
    const auto [none, usual] = readBendText(bendText({}, {}, packed), "text", packed, 16);
    EXPECT_TRUE(none == BendState() && usual.givesSameShape({}));
}

TEST(BendText, WhatIsWrongIsSaid) {
    const std::vector<std::size_t> live = LiveSlots(20); // 16 of them
    const auto messageOf = [&](const std::string &text) {
        return MessageOf<BadInput>([&] { readBendText(text, "s.fcd", live, 20); });
    };
    const auto refused = [&](const std::string &line, const std::string &what) {
        const std::string message = messageOf("FCD bend 1\n" + line);
        EXPECT_EQ(message.find("'s.fcd', line 2: " + what), 0U) << message;
        EXPECT_EQ(message.find(".."), std::string::npos) << message;
    };
    EXPECT_EQ(messageOf("FCD bend 2\nmore"),
              "'s.fcd', line 1: expected 'FCD bend 1': this is of another version of the tool.");
    refused("colour 3", "expected an option, or what is known of a handle, found 'colour'.");
    refused("axes 1 2", "expected the end of the line, found '2'.");
    refused("axes 4", "expected 0, 1, 2 or 3, found '4'.");
    refused("symmetry 3", "expected -1, 0, 1 or 2, found '3'.");
    refused("falloff 4", "expected 0, 1, 2 or 3, found '4'.");
    refused("elastic 2", "expected 0 or 1, found '2'.");
    refused("rigidity 2", "expected a rigidity from 0 to 1, found '2'.");
    refused("distances 2", "expected 0 or 1, found '2'.");
    refused("detail 1e3", "expected a number of patches from 0 to 20000, found '1e3'.");
    refused("smoothness nan", "expected a smoothness from 0 to 10, found 'nan'.");
    refused("pose 201", "expected a percentage from 0 to 200, found '201'.");
    refused("point 1 0 1", "expected the tag of a handle, from 2, found '1'.");
    refused("point 2 16 1", "expected a vertex of the layer, found '16'.");
    refused("point 2 -1 1", "expected a vertex of the layer, found '-1'.");
    refused("point 2 0 0", "expected a radius greater than 0, found '0'.");
    refused("point 2 0 inf", "expected a radius greater than 0, found 'inf'.");
    refused("point 2 0 1 grap", "expected 'grip', found 'grap'.");
    EXPECT_EQ(messageOf("FCD bend 1\npoint 2 0 1\npoint 3 0 1"),
              "'s.fcd', line 3: the vertex has another handle already.");
    refused("rank 2 2000000", "expected a rank from 1 to 1000000, found '2000000'.");
    refused("pivot 2 0 0", "expected a number of a place, found ''.");
    refused("motions 2: rotate 0 0 0 1", "motions that cannot be: The motions, character 4: ");
    refused("motions 2: matrix -1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "motions that cannot be: ");
    refused("rim 1e-60 0 1", "expected a radius greater than 0, found '1e-60'.");
    refused("rim 1 2 1", "expected a vertex of the layer, found '1'.");
    refused("rim 1 0 3 2 2", "vertex 2 has a mark, or a rim, already.");
    refused("mark 0 3 4 4 5", "vertex 4 has a mark, or a rim, already.");
    refused("mark 0.5 3 4", "expected a tag, found '0.5'.");
    refused("weights 1 inf", "expected a percentage, found 'inf'.");
    refused("line 0 1 2 0.5 0.5 x", "expected a weight, found 'x'.");
}

TEST(BendText, WhateverItSaysIsRefusedOrOfTheLayer) {
    const std::vector<std::size_t> live = LiveSlots(20);
    const std::string text = bendText(FullState(20), OtherOptions(), live), letters = "0123456789-.e \n:;abc\xff";
    std::mt19937 random(7);
    int read = 0, wrong = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string changed = text;
        for (unsigned k = 0; k <= random() % 3; ++k)
            changed[random() % changed.size()] = letters[random() % letters.size()];
        if (i % 7 == 0)
            changed.resize(random() % changed.size());
        try {
            const BendState state = readBendText(changed, "text", live, 20).first;
            ++read;
            const auto isLive = [&](std::size_t slot) { return std::binary_search(live.begin(), live.end(), slot); };
            for (const auto &[tag, point] : state.points)
                EXPECT_TRUE(tag >= 2 && isLive(point.slot) && point.radius > 0) << changed;
            for (const BendLinePoint &point : state.line)
                EXPECT_TRUE(isLive(point.corner[0]) && point.weight.allFinite() && point.place.allFinite()) << changed;
            EXPECT_TRUE(!state.rims || state.rims->size() == 20) << changed;
            EXPECT_TRUE(!state.marks || state.marks->size() == 20) << changed;
        } catch (const BadInput &) {
            ++wrong;
        }
    }
    EXPECT_GT(read, 1000);
    EXPECT_GT(wrong, 1000);
}
