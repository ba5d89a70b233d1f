// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/field_sampling.h>
#include <vcg_ext/line/line_jitter.h>
#include <vcg_ext/line/line_points.h>
#include <vcg_ext/straighten.h>
#include <vcg_ext/straighten/line_places.h>
#include "test_support.h"

#include <limits>
#include <random>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

constexpr double pi = double(EIGEN_PI);

Matrix3Xd Points(const std::vector<Vector3d> &points) {
    Matrix3Xd all(3, Eigen::Index(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        all.col(Eigen::Index(i)) = points[i];
    return all;
}

/// A tube about the x axis, with an oval cross-section; (x, angle) in a grid.
Shape Tube(double length, double wide, double high, int rings, int around) {
    Shape shape;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const double a = 2 * pi * j / around;
            shape.position.emplace_back(length * i / (rings - 1), wide * std::cos(a), high * std::sin(a));
            if (i + 1 < rings) {
                const int here = i * around + j, next = i * around + (j + 1) % around;
                shape.face.push_back({here, here + around, next});
                shape.face.push_back({next, here + around, next + around});
            }
        }
    return shape;
}

/// The same shape at two places.
Shape Twice(const Shape &shape, const Vector3d &apart) {
    Shape both = shape;
    for (const Vector3d &p : shape.position)
        both.position.emplace_back(p + apart);
    for (const auto &f : shape.face)
        both.face.push_back({f[0] + shape.Size(), f[1] + shape.Size(), f[2] + shape.Size()});
    return both;
}

/// Along an arc in the plane of x and y, of so many radians from end to end.
Vector3d Bent(const Vector3d &p, double length, double radians) {
    const double radius = length / radians, a = p[0] / radius;
    return {(radius - p[1]) * std::sin(a), radius - (radius - p[1]) * std::cos(a), p[2]};
}

Matrix3Xd BentLine(double length, double radians, int count, double begin = 0, double end = 1,
                   Vector3d off = {0, 0, 0}) {
    std::vector<Vector3d> points;
    for (int i = 0; i < count; ++i)
        points.push_back(
            Bent(off + Vector3d(length * (begin + (end - begin) * i / (count - 1)), 0, 0), length, radians));
    return Points(points);
}

struct Straight {
    Matrix3Xd position;
    StraightenReport report;
    std::vector<Eigen::Matrix3f> linear;
};

Straight Along(const Shape &shape, const LineGoal &goal, const Affine3d &world = Affine3d::Identity(),
               unsigned threads = 0) {
    const MeshD mesh(shape);
    const Arrays arrays = Read(mesh);
    StraightenParam param;
    param.graph.initialPatches = 200;
    Progress progress;
    progress.threads = threads;
    const auto deformer = PrepareDeformer(arrays.View(), AllFree(shape.position.size(), world), param, progress);
    Straight made;
    const LineMotion motion = MotionTo(goal, *deformer, world, made.report, progress);
    const Deformer::Pose pose = vcg::fcd::Straighten(*deformer, world, motion, param, made.report, progress);
    made.position = arrays.View().Copy();
    Carrier(*deformer, pose).Apply(made.position, &made.linear);
    return made;
}

/// Root mean square of the distances after the best rigid motion.
double RmsApart(const Matrix3Xd &a, const Matrix3Xd &b) {
    const Eigen::Matrix4d best = Eigen::umeyama(a, b, false);
    return std::sqrt(((Affine3d(best) * a) - b).squaredNorm() / double(a.cols()));
}

} // namespace

TEST(FramedLine, IsTheCircleThroughPointsOfACircle) {
    const double radius = 3, whole = 2;
    std::vector<Vector3d> points;
    for (double a : {0.0, 0.3, 0.5, 1.1, 1.4, whole})
        points.emplace_back(radius * std::cos(a), radius * std::sin(a), 7);
    const FramedLine line(Points(points));
    EXPECT_NEAR(line.Length(), radius * whole, 1e-4);
    for (double s = 0.1; s < line.Length() - 0.1; s += 0.37) {
        const FramedLine::Frame frame = line.At(s);
        EXPECT_NEAR((frame.point - Vector3d(0, 0, 7)).norm(), radius, 2e-4);
        EXPECT_NEAR(frame.point[2], 7, 1e-12);
        EXPECT_NEAR(frame.bend.norm(), 1 / radius, 5e-3);
        EXPECT_LT((frame.axes.transpose() * frame.axes - Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_NEAR(frame.axes.determinant(), 1, 1e-12);
        EXPECT_NEAR(line.Nearest(frame.point + 0.5 * frame.axes.col(1) - 0.4 * frame.axes.col(2), 0, line.Length()), s,
                    1e-6);
    }
    // Beyond its ends it goes on straight.
    const FramedLine::Frame end = line.At(line.Length()), beyond = line.At(line.Length() + 2);
    EXPECT_LT((beyond.point - end.point - 2 * end.axes.col(0)).norm(), 1e-12);
    EXPECT_NEAR(line.Nearest(beyond.point + beyond.axes.col(1), 0, line.Length()), line.Length() + 2, 1e-9);
    EXPECT_NEAR(line.Nearest(line.At(-1).point, 0, line.Length()), -1, 1e-9);
}

TEST(FramedLine, FindsTheNearestOfAllPlaces) {
    std::vector<Vector3d> points; // of turns that lie beside each other
    for (int i = 0; i <= 60; ++i)
        points.emplace_back((2 + 0.02 * i) * std::cos(0.4 * i), (2 + 0.02 * i) * std::sin(0.4 * i), 0.01 * i);
    const FramedLine line(Points(points));
    const int places = 20000;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-4, 4), part(0, 1);
    for (int n = 0; n < 100; ++n) {
        const Vector3d p(any(random), any(random), 0.3 * any(random));
        double from = 0, to = line.Length();
        if (n % 2 == 1) {
            from = part(random) * line.Length();
            to = from + 0.1 * part(random) * line.Length();
        }
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= places; ++i)
            if (const double s = line.Length() * i / places; s >= from && s <= to)
                least = std::min(least, (line.At(s).point - p).norm());
        const double s = line.Nearest(p, from, to);
        EXPECT_LE((line.At(s).point - p).norm(), least + line.Length() / 4000);
        EXPECT_GE(s, from - 0.01 * line.Length());
        EXPECT_LE(s, s > line.Length() ? s : to + 0.01 * line.Length());
    }
}

TEST(FramedLine, DoesNotTurnAboutItself) {
    // On a helix, what a rotation-minimising frame turns against the Frenet frame is the torsion times the length.
    const double radius = 2, rise = 0.5, torsion = rise / (radius * radius + rise * rise);
    std::vector<Vector3d> points;
    for (int i = 0; i <= 200; ++i)
        points.emplace_back(radius * std::cos(i * 0.05), radius * std::sin(i * 0.05), rise * i * 0.05);
    const FramedLine line(Points(points));
    const auto angle = [&](double s) {
        const FramedLine::Frame frame = line.At(s);
        const Vector3d inward = -Vector3d(frame.point[0], frame.point[1], 0).normalized();
        return std::atan2(inward.dot(frame.axes.col(2)), inward.dot(frame.axes.col(1)));
    };
    for (double s = 2; s + 1 < line.Length() - 1; s += 1.7)
        EXPECT_NEAR(std::remainder(angle(s + 1) - angle(s) - torsion, 2 * pi), 0, 2e-3);
}

TEST(FramedLine, SmoothsStepsButNotBends) {
    std::vector<Vector3d> stairs, arc;
    for (int i = 0; i <= 200; ++i) {
        const double a = i * 0.01, radius = 10;
        arc.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
        stairs.emplace_back(arc.back() + Vector3d(0, 0, i % 2 ? 0.03 : -0.03));
    }
    const FramedLine line(Points(stairs), 0.02);
    double off = 0, tilt = 0;
    for (double s = 1; s < line.Length() - 1; s += 0.1) {
        const Vector3d p = line.At(s).point;
        off = std::max({off, std::abs(std::hypot(p[0], p[1]) - 10), std::abs(p[2])});
        tilt = std::max(tilt, std::abs(line.At(s).axes(2, 0)));
    }
    EXPECT_LT(off, 2e-3);
    EXPECT_LT(tilt, 0.01);
    EXPECT_GT(FramedLine(Points(stairs)).Length(), 1.02 * line.Length());
    EXPECT_LT((line.At(0).point - stairs.front()).norm(), 1e-12);
}

TEST(FramedLine, RefusesWhatIsNoOpenLine) {
    const auto of = [](const std::vector<Vector3d> &points, double smoothing = 0) {
        return MessageOf<BadInput>([&] { FramedLine(Points(points), smoothing); });
    };
    const Vector3d o(0, 0, 0), x(1, 0, 0), y(1, 1, 0);
    EXPECT_NE(of({}).find("no point"), std::string::npos);
    EXPECT_NE(of({o}).find("one point only"), std::string::npos);
    EXPECT_NE(of({o, o, o}).find("no extent"), std::string::npos);
    EXPECT_NE(of({o, x, x, y}).find("Points 2 and 3 of the line are at one place"), std::string::npos);
    EXPECT_NE(of({o, x, y, o}).find("is closed"), std::string::npos);
    EXPECT_NE(of({o, x, 0.5 * x, y}).find("turns back on itself at point 2"), std::string::npos);
    EXPECT_NE(of({o, x, Vector3d(std::nan(""), 0, 0)}).find("is not finite"), std::string::npos);
    EXPECT_NE(of({o, x, Vector3d(1e101, 0, 0)}).find("beyond 1e100"), std::string::npos);
    EXPECT_NE(of({o, 1e-101 * x}).find("no extent"), std::string::npos);
    EXPECT_NE(of({o, x}, 0.3).find("0 to 25 percent"), std::string::npos);
    EXPECT_NO_THROW(FramedLine(Points({o, x})));
}

TEST(LinePoints, FollowsEdges) {
    using Edges = std::vector<std::array<Index, 2>>;
    EXPECT_EQ(PathOfEdges(Edges{{4, 2}, {7, 4}, {2, 9}, {9, 2}}, "It"), (std::vector<Index>{7, 4, 2, 9}));
    const auto of = [](const Edges &edges) { return MessageOf<BadInput>([&] { PathOfEdges(edges, "It"); }); };
    EXPECT_NE(of({}).find("It has no edges"), std::string::npos);
    EXPECT_NE(of({{1, 1}}).find("It has no edges"), std::string::npos);
    EXPECT_NE(of({{0, 1}, {1, 2}, {1, 3}}).find("It has a branch at vertex 1, where 3 edges"), std::string::npos);
    EXPECT_NE(of({{0, 1}, {1, 2}, {2, 0}}).find("It is closed"), std::string::npos);
    EXPECT_NE(of({{0, 1}, {2, 3}, {3, 4}}).find("the first has 2 of the 5 vertices"), std::string::npos);
    EXPECT_NE(of({{0, 1}, {2, 3}, {3, 4}, {4, 2}}).find("several separate lines"), std::string::npos);
}

TEST(LinePoints, ReadsALineForEachPoint) {
    const Matrix3Xd points = ReadLineText("x,y,z\n# begin\n1, 2;3\n\n4 5 6e1 # end", "f");
    EXPECT_EQ(points, Points({{1, 2, 3}, {4, 5, 60}}));
    const auto of = [](const std::string &text) { return MessageOf<BadInput>([&] { ReadLineText(text, "f"); }); };
    EXPECT_NE(of("1 2 3\n1 2\n").find("line 2: found 2 numbers; expected the x, y and z"), std::string::npos);
    EXPECT_NE(of("1 2 3 4\n").find("found 4 numbers"), std::string::npos);
    EXPECT_NE(of("1,,2\n").find("one is missing"), std::string::npos);
    EXPECT_NE(of("1 2 three\n").find("a number"), std::string::npos);
    EXPECT_NE(of("# nothing\n").find("holds no points"), std::string::npos);
}

/// Points with a \p jitter in each direction.
static Matrix3Xd Jittered(Matrix3Xd points, double jitter, unsigned seed = 1) {
    std::mt19937 random(seed);
    for (auto each : points.colwise())
        for (double &x : each) { // a sum of twelve is nearly normal, and the same on all systems
            double sum = -6;
            for (int k = 0; k < 12; ++k)
                sum += double(random() >> 8) * 0x1p-24;
            x += jitter * sum;
        }
    return points;
}

static Matrix3Xd SpiralLine(int count) {
    std::vector<Vector3d> points;
    for (int i = 0; i < count; ++i) {
        const double a = 6 * pi * i / (count - 1), r = 4 + 2 * a / pi;
        points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
    return Points(points);
}

TEST(LineJitter, LeavesPointsThatAreMeant) {
    for (int count : {2, 8, 21, 101, 700})
        for (const Matrix3Xd &line : {BentLine(100, 2, count), SpiralLine(9 * count)}) {
            const SteadyPoints steady = WithoutJitter(line, 5);
            EXPECT_EQ(steady.point, line) << count;
            EXPECT_EQ(steady.jitter, 0);
        }
    // Jitter too small to show, points farther apart than the body is thick, and very few points.
    for (const auto &[count, jitter, thickness] :
         {std::make_tuple(200, 1e-4, 3.0), std::make_tuple(12, 0.3, 1.0), std::make_tuple(7, 0.5, 20.0)}) {
        const Matrix3Xd line = Jittered(BentLine(100, 2, count), jitter);
        EXPECT_EQ(WithoutJitter(line, thickness).point, line) << count;
    }
}

TEST(LineJitter, TakesOutByWhatPointsAreOff) {
    for (int count : {26, 50, 200, 1000})
        for (double jitter : {0.1, 0.3})
            for (unsigned seed : {1u, 2u, 3u}) {
                const Matrix3Xd meant = BentLine(100, 2, count), line = Jittered(meant, jitter, seed);
                const SteadyPoints steady = WithoutJitter(line, 3);
                const auto off = [&](const Matrix3Xd &points) { // across
                    const FramedLine truth(meant);
                    double squares = 0;
                    for (const auto &p : points.colwise())
                        squares += (truth.At(truth.Nearest(p, 0, truth.Length())).point - p).squaredNorm();
                    return std::sqrt(squares / (2 * count));
                };
                EXPECT_NEAR(steady.jitter, jitter, (count > 100 ? 0.2 : 0.5) * jitter) << count << " " << seed;
                EXPECT_NEAR(FramedLine(steady.point).Length(), 100, 4 * jitter) << count << " " << seed;
                EXPECT_LT(off(steady.point), (count > 100 ? 0.5 : 0.9) * off(line)) << count << " " << seed;
                if (count >= 200) {
                    EXPECT_GT(FramedLine(line).Length(), 101);
                }
            }
}

TEST(LineMotion, MovesCrossSectionsRigidlyAndTellsItsGradient) {
    LineGoal goal;
    goal.line = BentLine(10, 1.5, 12);
    goal.target = Points({{0, 0, 1}, {2, 1, 1}, {4, 1, 2}, {7, -1, 2}, {12, -2, 5}});
    goal.length = 11;
    LineMotion motion = MotionTo(goal);
    EXPECT_EQ(motion.Length(), 11);
    motion.twist = [](double s) { return LineMotion::Twist{0.02 * s * s, 0.04 * s}; };
    for (double s : {1.234, 4.321, 7.777}) {
        const FramedLine::Frame frame = motion.From().At(s);
        const Vector3d p = frame.point + 0.3 * frame.axes.col(1) - 0.5 * frame.axes.col(2);
        const LineMotion::Moved moved = motion.At(s, p);
        EXPECT_NEAR((moved.position - motion.At(s, frame.point).position).norm(), (p - frame.point).norm(), 1e-12);
        Matrix3d gradient;
        const double h = 1e-3;
        for (int d = 0; d < 3; ++d) {
            const auto at = [&](double step) {
                const Vector3d q = p + step * Vector3d::Unit(d);
                return motion.At(motion.From().Nearest(q, s - 0.1, s + 0.1), q).position;
            };
            gradient.col(d) = (at(h) - at(-h)) / (2 * h);
        }
        EXPECT_LT((gradient - moved.linear).norm(), 0.02) << gradient << "\n\n" << moved.linear;
    }
    // Beyond the ends, all moves with them.
    const LineMotion::Moved end = motion.At(motion.From().Length(), motion.From().At(motion.From().Length()).point);
    const double far = motion.From().Length() + 3;
    EXPECT_LT((motion.At(far, motion.From().At(far).point).position - end.position -
               3 * end.turn * motion.From().At(far).axes.col(0))
                  .norm(),
              1e-9);
}

TEST(LineMotion, TakesDirectionsOfAnyLength) {
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}});
    goal.arc.degrees = 90;
    const auto end = [&](double size) {
        goal.arc.direction = Vector3d(0, 0, 1) * size;
        goal.arc.towards = Vector3d(1, 0, 1) * size;
        const LineMotion motion = MotionTo(goal);
        const double length = motion.From().Length();
        return Vector3d(motion.At(length, motion.From().At(length).point).position);
    };
    for (double size : {1e-310, 1e-200, 1e200, 1e307})
        EXPECT_LT((end(size) - end(1)).norm(), 1e-9) << size;
}

TEST(LineMotion, RefusesLinesThatLeadNowhere) {
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}});
    const auto of = [&] { return MessageOf<BadInput>([&] { MotionTo(goal); }); };
    goal.length = -1;
    EXPECT_NE(of().find("length of the line must be a positive number"), std::string::npos);
    goal.length = 0;
    goal.target = Points({{1, 1, 1}});
    EXPECT_NE(of().find("The target line is wrong. The line has one point only"), std::string::npos);
    goal.target.resize(3, 0);
    goal.arc.degrees = 360;
    EXPECT_NE(of().find("less than 360 degrees"), std::string::npos);
    goal.arc.degrees = 90;
    goal.arc.direction = {1, 2, 3};
    goal.arc.towards = {-2, -4, -6};
    EXPECT_NE(of().find("cannot bend in its own direction"), std::string::npos);
    goal.arc.towards = {0, std::nan(""), 0};
    EXPECT_NE(of().find("must be finite"), std::string::npos);
    goal.arc.towards.setZero();
    EXPECT_NO_THROW(MotionTo(goal));
}

TEST(Straighten, MakesABentTubeStraight) {
    const double length = 10, radians = 2;
    const Shape straight = Tube(length, 0.6, 0.6, 101, 24);
    Shape bent = straight;
    for (Vector3d &p : bent.position)
        p = Bent(p, length, radians);
    LineGoal goal;
    goal.line = BentLine(length, radians, 9);
    const Straight made = Along(bent, goal);
    EXPECT_LT(RmsApart(made.position, Points(straight.position)), 1e-3 * length);
    EXPECT_NEAR(made.report.length, length, 1e-3);
    EXPECT_EQ(made.report.released, 0);
    EXPECT_GT(made.report.largest, 0);
    EXPECT_LT(made.report.rms, 1e-3 * length);
    // From a line on the surface, with the middles of the cross-sections; without them, the outer side keeps its
    // length.
    goal.line = BentLine(length, radians, 9, 0, 1, {0, -0.6, 0});
    const Straight outer = Along(bent, goal);
    EXPECT_NEAR(outer.report.length, length + 0.6 * radians, 1e-2);
    goal.middle = true;
    const Straight through = Along(bent, goal);
    EXPECT_NEAR(through.report.length, length, 0.01 * length);
    EXPECT_LT(RmsApart(through.position, Points(straight.position)), 3e-3 * length);
    // The same bits with one thread.
    const Straight alone = Along(bent, goal, Affine3d::Identity(), 1);
    EXPECT_EQ(alone.position, through.position);
}

TEST(Straighten, TellsTheLineThatIsUsed) {
    const double length = 10;
    const Shape shape = Tube(length, 0.6, 0.6, 101, 24);
    const MeshD mesh(shape);
    const Arrays arrays = Read(mesh);
    const Affine3d world = Affine3d::Identity();
    const auto deformer = PrepareDeformer(arrays.View(), AllFree(shape.position.size(), world), StraightenParam());
    LineGoal goal;
    goal.line = Points({{1, 0.5, 0.3}, {5, 0.6, 0}, {9, 0.3, 0.5}});
    EXPECT_EQ(LineOf(goal, *deformer, world), goal.line);
    goal.middle = true;
    StraightenReport report, again;
    MotionTo(goal, *deformer, world, report);
    const Matrix3Xd line = LineOf(goal, *deformer, world);
    for (const auto &each : line.colwise())
        EXPECT_LT(each.tail<2>().norm(), 0.06); // 0.6 is where the surface is
    EXPECT_EQ(FramedLine(line).Length(), report.length);
    goal.line = line; // used as it is, with the same bits
    goal.middle = false;
    MotionTo(goal, *deformer, world, again);
    EXPECT_EQ(again.length, report.length);
    goal.middle = true;
    EXPECT_THROW(LineOf(goal, *deformer, world, Progress([](const int, const char *) { return false; })), Cancelled);
}

TEST(Straighten, DoesNotDependOnHowManyPointsAreGiven) {
    const double length = 100, radians = 2, jitter = 0.1;
    const Shape straight = Tube(length, 3, 3, 301, 24);
    Shape bent = straight;
    for (Vector3d &p : bent.position)
        p = Bent(p, length, radians);
    for (int count : {8, 12, 26, 34, 80, 200}) {
        LineGoal goal;
        goal.line = Jittered(BentLine(length, radians, count, 0.01, 0.99), jitter, unsigned(count));
        const Straight made = Along(bent, goal);
        EXPECT_NEAR(made.report.length, 98, 4 * jitter) << count; // its ends jitter, too
        EXPECT_LT(RmsApart(made.position, Points(straight.position)), 2 * jitter) << count;
        EXPECT_EQ(made.report.jitter > 0, count > 20) << count;
        goal.smoothing = 1e-4; // replaces the removal of jitter
        EXPECT_EQ(Along(bent, goal).report.jitter, 0);
    }
    // The target may jitter, too.
    LineGoal goal;
    goal.line = BentLine(length, 0.01, 9);
    goal.target = Jittered(BentLine(length, radians, 300, 0, 1.1), jitter);
    EXPECT_LT(RmsApart(Along(straight, goal).position, Points(bent.position)), 4 * jitter);
}

/// A flat body with a guard across, bent to an S, and points picked on it.
struct Blade {
    static constexpr double length = 90;
    Shape straight = Tube(length, 1, 1, 400, 32), bent;
    std::vector<Vector3d> middle; ///< 0.01 of the length apart

    explicit Blade(double guard) {
        Vector3d at(0, 0, 0);
        const int steps = 9000;
        std::vector<std::pair<Vector3d, double>> way;
        for (int i = 0; i <= steps; ++i) {
            const double angle = 0.45 * std::sin(2 * pi * i / steps);
            way.emplace_back(at, angle);
            if (i % 90 == 0)
                middle.push_back(at);
            at += length / steps * Vector3d(std::cos(angle), 0, std::sin(angle));
        }
        for (Vector3d &p : straight.position)
            p = Vector3d(p[0], 2.5 * p[1] * (1 + guard * std::exp(-std::pow((p[0] - 20) / 0.8, 2))), 0.6 * p[2]);
        bent = straight;
        for (Vector3d &p : bent.position) {
            const auto &[on, angle] = way[std::size_t(std::lround(p[0] / length * steps))];
            p = on + Vector3d(-p[2] * std::sin(angle), p[1], p[2] * std::cos(angle));
        }
    }
    Matrix3Xd Picked(double jitter, unsigned seed) const {
        std::vector<Vector3d> points;
        for (std::size_t i = 1; i < middle.size(); i += 7)
            points.push_back(middle[i] + Vector3d(0, 0, 0.6));
        Matrix3Xd line = Points(points), off = Jittered(0 * line, jitter, seed);
        line.row(1) += off.row(1);
        return line;
    }
};

TEST(Straighten, FindsTheMiddleBesideAGuard) {
    for (double guard : {0.0, 3.0}) {
        const Blade blade(guard);
        for (double jitter : {0.0, 0.4})
            for (unsigned seed : {1u, 2u}) {
                LineGoal goal;
                goal.line = blade.Picked(jitter, seed);
                const Straight given = Along(blade.bent, goal);
                goal.middle = true;
                const Straight through = Along(blade.bent, goal);
                const double off = RmsApart(through.position, Points(blade.straight.position));
                const double without = RmsApart(given.position, Points(blade.straight.position));
                if (guard > 0 && jitter > 0) {
                    EXPECT_LE(off, without) << seed; // too much jitter beside a guard stays
                } else {
                    EXPECT_FALSE(through.report.leftMiddle);
                    EXPECT_LT(off, without) << guard << " " << jitter;
                    EXPECT_LT(off, 0.0015 * Blade::length) << guard << " " << jitter;
                }
                EXPECT_NEAR(through.report.length, given.report.length, 0.02 * Blade::length);
            }
    }
}

TEST(Straighten, LeavesTheMiddleThatWouldStretchMore) {
    // A fin as high as a third of the body's length: the middle of the cross-sections is drawn into it.
    Shape straight = Tube(100, 3, 3, 300, 64);
    for (Vector3d &p : straight.position)
        if (p[2] > 2.8)
            p[2] += 30 * std::exp(-std::pow((p[0] - 60) / 6, 2));
    Shape bent = straight;
    for (Vector3d &p : bent.position)
        p = Bent(p, 100, 1.5);
    LineGoal goal;
    goal.line = BentLine(100, 1.5, 9, 0.01, 0.99);
    const Straight given = Along(bent, goal);
    EXPECT_FALSE(given.report.leftMiddle);
    goal.middle = true;
    const Straight through = Along(bent, goal);
    EXPECT_TRUE(through.report.leftMiddle);
    EXPECT_EQ(through.position, given.position);
}

TEST(Straighten, AFinIsNoReasonToMoveTheLine) {
    Shape bent = Tube(100, 3, 3, 300, 64); // with a fin on the outer side of the bend, high against the body
    for (Vector3d &p : bent.position) {
        if (p[1] < -2.8)
            p[1] -= 30 * std::exp(-std::pow((p[0] - 60) / 6, 2));
        p = Bent(p, 100, 1.5);
    }
    LineGoal goal;
    goal.line = BentLine(100, 1.5, 9, 0.01, 0.99);
    const Straight given = Along(bent, goal);
    EXPECT_GT(given.report.lengthening, 0.03);
    EXPECT_FALSE(given.report.isBeside);
}

TEST(Straighten, WhoHasAskedForTheMiddleIsNotToldTo) {
    Shape bent = Tube(100, 3, 3, 300, 64); // with a fin on the inner side, and a line on the outer one
    for (Vector3d &p : bent.position) {
        if (p[1] > 2.6)
            p[1] += 30 * std::exp(-std::pow((p[0] - 60) / 6, 2));
        p = Bent(p, 100, 1.5);
    }
    LineGoal goal;
    goal.line = BentLine(100, 1.5, 9, 0.01, 0.99, {0, -3, 0});
    goal.middle = true;
    const Straight through = Along(bent, goal);
    EXPECT_FALSE(through.report.leftMiddle);
    EXPECT_GT(through.report.lengthening, 0.03);
    EXPECT_FALSE(through.report.isBeside);
}

TEST(Straighten, TellsALineToOneSide) {
    const double length = 100, turn = 1.5, radius = 3;
    const Shape straight = Tube(length, radius, radius, 200, 48);
    Shape bent = straight;
    for (Vector3d &p : bent.position)
        p = Bent(p, length, turn);
    LineGoal goal;
    goal.line = BentLine(length, turn, 9, 0, 1);
    const Straight middle = Along(bent, goal);
    EXPECT_LT(middle.report.lengthening, 0.005);
    EXPECT_FALSE(middle.report.isBeside);
    goal.line = BentLine(length, turn, 9, 0, 1, {0, radius, 0});
    const Straight given = Along(bent, goal);
    EXPECT_NEAR(given.report.lengthening, turn * radius / length, 0.005);
    EXPECT_TRUE(given.report.isBeside);
    goal.middle = true;
    const Straight moved = Along(bent, goal);
    EXPECT_LT(moved.report.lengthening, 0.005);
    EXPECT_FALSE(moved.report.isBeside);
    goal = {};
    goal.line = Points({{0, radius, 0}, {length, radius, 0}}); // bends instead
    goal.arc.degrees = turn * 180 / pi;
    goal.arc.towards = {0, 1, 0};
    const Straight arc = Along(straight, goal);
    EXPECT_NEAR(arc.report.lengthening, turn * radius / length, 0.005);
    EXPECT_TRUE(arc.report.isBeside);
}

TEST(Straighten, BendsAndComesBack) {
    const double length = 10;
    const Shape tube = Tube(length, 0.6, 0.6, 101, 24);
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {length, 0, 0}});
    goal.arc.degrees = 100;
    goal.arc.towards = {0, 1, 0};
    const Straight made = Along(tube, goal);
    Shape truth = tube;
    for (Vector3d &p : truth.position)
        p = Bent(p, length, 100 * pi / 180);
    EXPECT_LT(RmsApart(made.position, Points(truth.position)), 1e-3 * length);
    EXPECT_GT(made.position.row(1).maxCoeff(), 1); // its ends went there

    std::vector<Eigen::Matrix3f> back = made.linear;
    EXPECT_EQ(Invert(back), 0);
    const MeshD mesh(tube);
    const Arrays arrays = Read(mesh);
    const SampledField field = SampleField(arrays.View(), made.position, arrays.View().Copy(), back);
    const DeformationField inverse(field.samples);
    double off = 0;
    for (std::size_t i = 0; i < tube.position.size(); ++i) {
        const Vector3d p = made.position.col(Eigen::Index(i));
        off = std::max(off, (p + inverse(p) - tube.position[i]).norm());
    }
    EXPECT_LT(off, 1e-3 * length);
    back[3] = -Eigen::Matrix3f::Identity();
    back[5].setZero();
    EXPECT_EQ(Invert(back), 2);
}

TEST(Straighten, KeepsWhatIsStraightToTheBit) {
    const Shape tube = Tube(10, 0.6, 0.6, 51, 16);
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {4, 0, 0}, {10, 0, 0}});
    EXPECT_EQ(Along(tube, goal).position, Points(tube.position));
}

TEST(Straighten, TakesATwistOut) {
    const double length = 10, twist = 2.5;
    const Shape straight = Tube(length, 0.8, 0.4, 201, 24);
    Shape twisted = straight;
    for (Vector3d &p : twisted.position)
        p = Bent(Eigen::AngleAxisd(twist * p[0] / length, Vector3d::UnitX()) * p, length, 1.0);
    LineGoal goal;
    goal.line = BentLine(length, 1.0, 9);
    goal.untwist = true;
    const Straight made = Along(twisted, goal);
    EXPECT_NEAR(made.report.twist, twist * 180 / pi, 6);
    EXPECT_LT(RmsApart(made.position, Points(straight.position)), 5e-3 * length);
    goal.untwist = false;
    EXPECT_GT(RmsApart(Along(twisted, goal).position, Points(straight.position)), 0.02 * length);

    // A gap without surface has no twist, and does no harm.
    goal.untwist = true;
    goal.line = Points({{0, 0, 0}, {length, 0, 0}});
    const Shape ends = Twice(Tube(3, 0.8, 0.4, 31, 24), {7, 0, 0});
    const Straight apart = Along(ends, goal);
    EXPECT_TRUE(apart.position.allFinite());
    EXPECT_NEAR(apart.report.twist, 0, 6);

    EXPECT_NE(MessageOf<BadInput>([&] { Along(Tube(length, 0.6, 0.6, 101, 24), goal); }).find("nearly round"),
              std::string::npos);
}

TEST(Straighten, ReachesTheLengthThatIsAskedFor) {
    const Shape tube = Tube(10, 0.6, 0.6, 101, 16);
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {10, 0, 0}});
    goal.length = 25;
    goal.arc.direction = {0, 0, 2};
    const Straight made = Along(tube, goal);
    EXPECT_NEAR(made.position.row(2).maxCoeff() - made.position.row(2).minCoeff(), 25, 1e-6);
    EXPECT_NEAR(made.position.row(1).maxCoeff(), 0.6, 1e-6);
    EXPECT_EQ(made.report.newLength, 25);
    EXPECT_EQ(made.report.released, 0);
}

TEST(Straighten, LaysItAlongAnotherLineInTheWorld) {
    const Shape tube = Tube(10, 0.6, 0.6, 101, 16);
    Affine3d world = Affine3d::Identity();
    world.translate(Vector3d(100, -50, 20)).rotate(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())).scale(2);
    LineGoal goal;
    goal.line = world * Points({{0, 0, 0}, {10, 0, 0}});
    std::vector<Vector3d> arc;
    for (int i = 0; i <= 20; ++i)
        arc.push_back(Bent({i * 1.0, 0, 0}, 20, 1.2) + Vector3d(7, 8, 9));
    goal.target = Points(arc);
    const Straight made = Along(tube, goal, world);
    const FramedLine line(goal.target);
    double off = 0;
    for (std::size_t i = 0; i < tube.position.size(); ++i) {
        const double s = 2 * tube.position[i][0];
        const Vector3d to = world * Vector3d(made.position.col(Eigen::Index(i)));
        off = std::max(off, std::abs((to - line.At(s).point).norm() - 1.2));
        if (i % 97 == 0) {
            EXPECT_NEAR(line.Nearest(to, 0, line.Length()), s, 0.05);
        }
    }
    EXPECT_LT(off, 0.02);
}

TEST(Straighten, ReleasesWhatWouldFold) {
    // The line bends more sharply than the tube is thick.
    const double length = 12;
    const Shape tube = Tube(length, 1.5, 1.5, 121, 36);
    LineGoal goal;
    goal.line = Points({{0, 0, 0}, {length, 0, 0}});
    goal.target = Points({{0, 0, 0}, {3, 0, 0}, {5, 0, 0}, {5.9, 0.1, 0}, {6, 1, 0}, {6, 3, 0}, {6, 7, 0}});
    const Straight made = Along(tube, goal);
    EXPECT_GT(made.report.released, 0);
    EXPECT_GT(made.report.following, made.report.released);
    ASSERT_FALSE(made.report.releasedAt.empty());
    EXPECT_GT(made.report.releasedAt.front().first, 3);
    EXPECT_LT(made.report.releasedAt.back().second, 9);
    EXPECT_TRUE(made.position.allFinite());
}

TEST(Straighten, RefusesALineElsewhere) {
    LineGoal goal;
    goal.line = Points({{0, 20, 0}, {10, 20, 0}});
    EXPECT_NE(MessageOf<BadInput>([&] {
                  Along(Tube(10, 0.6, 0.6, 51, 16), goal);
              }).find("outside of the surface: 100 percent"),
              std::string::npos);
    // Between two ends, there is no cross-section.
    goal.line = Points({{0, 0, 0}, {10, 0, 0}});
    goal.middle = true;
    const Shape ends = Twice(Tube(0.3, 0.6, 0.6, 4, 16), {9.7, 0, 0});
    EXPECT_NE(MessageOf<BadInput>([&] { Along(ends, goal); }).find("too few cross-sections along the line"),
              std::string::npos);
}

TEST(Straighten, TellsPlacesAlongTheLine) {
    const double length = 10, radians = 2;
    Shape bent = Tube(length, 0.6, 0.6, 101, 16);
    const std::vector<Vector3d> before = bent.position;
    for (Vector3d &p : bent.position)
        p = Bent(p, length, radians);
    const MeshD mesh(bent);
    const Arrays arrays = Read(mesh);
    StraightenParam param;
    const auto deformer = PrepareDeformer(arrays.View(), AllFree(before.size(), Affine3d::Identity()), param);
    const FramedLine line(BentLine(length, radians, 9));
    const std::vector<float> place = PlacesOfVertices(arrays.View(), *deformer, Affine3d::Identity(), line);
    for (std::size_t i = 0; i < before.size(); ++i)
        ASSERT_NEAR(place[i], before[i][0], 0.05);
}

TEST(LinePlaces, DoNotJumpToAnotherTurn) {
    // A chain of nodes that leaves a spiral towards the inner turn, until it is nearer to that.
    std::vector<Vector3d> spiral;
    for (int i = 0; i <= 300; ++i) {
        const double a = 6 * pi * i / 300, r = 4 + 0.3 * a;
        spiral.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
    const FramedLine line(Points(spiral));
    const int count = 200;
    Csr chain;
    Matrix3Xd at(3, count);
    for (int i = 0; i < count; ++i) {
        const FramedLine::Frame frame = line.At(line.Length() * (i + 0.5) / count);
        at.col(i) = frame.point + std::min(1.1, 0.02 * i) * frame.bend.normalized();
        if (i > 0)
            chain.item.push_back(i - 1);
        if (i + 1 < count)
            chain.item.push_back(i + 1);
        chain.begin.push_back(std::uint32_t(chain.item.size()));
    }
    int jumps = 0;
    const std::vector<double> place = detail::PlacesAlong(line, chain, at);
    for (int i = 0; i < count; ++i) {
        EXPECT_NEAR(place[std::size_t(i)], line.Length() * (i + 0.5) / count, 0.5);
        jumps += std::abs(line.Nearest(at.col(i), 0, line.Length()) - line.Length() * (i + 0.5) / count) > 0.5;
    }
    EXPECT_GT(jumps, 20);
}
