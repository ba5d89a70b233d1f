// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/one_sided.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>
#include "test_support.h"

#include <algorithm>
#include <limits>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

/// A sheet with different bumps, so that each place can be told by its surroundings.
Vector3d Bumpy(double x, double y) {
    return {x, y,
            0.5 * std::sin(1.3 * x) * std::cos(0.9 * y + 0.4 * x) + 0.25 * std::sin(2.1 * y + 1) * std::cos(0.7 * x)};
}
Shape BumpySheet(int nx, int ny, double width = 10, double height = 6) {
    Shape shape = Grid(nx, ny);
    for (Vector3d &p : shape.position)
        p = Bumpy(p[0] * width / (nx - 1), p[1] * height / (ny - 1));
    return shape;
}

/// Rolls a sheet up and twists it a little; no graph makes this map exactly.
Vector3d Rolled(const Vector3d &p, double curvature = 0.06) {
    const double angle = curvature * p[0], twist = 0.02 * p[0], radius = 1 / curvature;
    const Vector3d q(p[0], 3 + (p[1] - 3) * std::cos(twist) - p[2] * std::sin(twist),
                     (p[1] - 3) * std::sin(twist) + p[2] * std::cos(twist));
    return {(radius - q[2]) * std::sin(angle), q[1], radius - (radius - q[2]) * std::cos(angle)};
}
Shape Rolled(Shape shape, double curvature = 0.06) {
    for (Vector3d &p : shape.position)
        p = Rolled(p, curvature);
    return shape;
}

/// For small sheets.
FitParam Small() {
    FitParam param;
    param.graph.initialPatches = 60;
    param.samples = sanitized ? 400 : 1200;
    return param;
}

struct Fitted {
    Matrix3Xd position;
    FitReport report;
    std::vector<float> distance = {};
    std::vector<char> liesOn = {};
};

Fitted Fit(const Shape &source, const Shape &target, const FitParam &param = Small(), std::vector<int> tag = {},
           const std::vector<Landmark> &landmark = {}, const NormalOf &normal = {}, unsigned threads = 0,
           const WeightOf &weight = {}, const WeightOf &targetWeight = {}, const std::vector<Curve> &curves = {}) {
    const MeshD from(source), to(target);
    const Arrays fromArrays = Read(from), toArrays = Read(to);
    Handles handles;
    handles.tag = tag.empty() ? std::vector<int>(source.position.size(), 1) : std::move(tag);
    Progress progress;
    progress.threads = threads;
    const Fitter fitter(fromArrays.View(), {}, handles, param, progress, weight);
    Fitted fitted;
    FitGoal goal;
    goal.surface = toArrays.View();
    goal.normal = normal;
    goal.weight = targetWeight;
    goal.curves = curves;
    const auto prepared = fitter.Prepare(goal, progress);
    const CallbackLog log;
    const Deformer::Pose pose = fitter.Solve(*prepared, landmark, fitted.report, log.Progress(threads));
    EXPECT_TRUE(std::is_sorted(log.percent.begin(), log.percent.end())) << "progress never goes back";
    fitted.position = fromArrays.View().Copy();
    Carrier(fitter.Surface(), pose).Apply(fitted.position);
    fitter.Compare(*prepared, fitted.report, fitted.position, fitted.distance, fitted.liesOn, progress);
    return fitted;
}

/// The rms distance of the vertices from their true positions, over the source's diagonal.
template <class Counts>
double Rms(const Fitted &fitted, const Shape &truth, const Counts &counts) {
    double squares = 0;
    int n = 0;
    for (std::size_t i = 0; i < truth.position.size(); ++i)
        if (counts(i)) {
            squares += (fitted.position.col(Eigen::Index(i)) - truth.position[i]).squaredNorm();
            ++n;
        }
    return std::sqrt(squares / n) / std::hypot(10, 6);
}
double Rms(const Fitted &fitted, const Shape &truth) {
    return Rms(fitted, truth, [](std::size_t) { return true; });
}

std::string Joined(const std::vector<std::string> &texts) {
    std::string all;
    for (const std::string &text : texts)
        all += text + "\n";
    return all;
}

template <class Run>
void ExpectError(const Run &run, const std::string &text) {
    EXPECT_NE(MessageOf<BadInput>(run).find(text), std::string::npos) << text;
}

const Shape source = BumpySheet(40, 25), truth = Rolled(source), target = Rolled(BumpySheet(57, 33));

} // namespace

TEST(Fit, OntoItselfStays) {
    const Fitted fitted = Fit(source, source);
    EXPECT_LT(Rms(fitted, source), 1e-6);
    EXPECT_TRUE(fitted.report.converged);
    EXPECT_GT(fitted.report.matched, 0.99);
}

// Limits, over an edge of the source (2.1 % of the diagonal): 0.2 on a clean surface; 0.3 on points half an edge apart,
// and for noise of 0.1; 1 if landmarks lead far. With sanitizers, which use a third of the samples, 0.4 on points.
TEST(Fit, FindsASurfaceInOtherTriangles) {
    ASSERT_GT(Rms({PositionsOf(MeshD(source)), {}}, truth), 0.05);
    const Fitted fitted = Fit(source, target);
    EXPECT_LT(Rms(fitted, truth), 0.0042);
    EXPECT_GT(fitted.report.matched, 0.9);
    EXPECT_LT(fitted.report.median, 0.01);
}

TEST(Fit, FindsAnUnweldedSurfaceAsAWeldedOne) {
    EXPECT_LT(Rms(Fit(source, Unwelded(target)), truth), 0.0042);
    EXPECT_LT(Rms(Fit(Unwelded(source), target), Unwelded(truth)), 0.0042);
}

TEST(Fit, FindsASurfaceThatIsInsideOut) {
    Shape turned = target;
    for (auto &face : turned.face)
        std::swap(face[1], face[2]);
    const Fitted plain = Fit(source, target), other = Fit(source, turned);
    EXPECT_FALSE(plain.report.insideOut);
    EXPECT_TRUE(other.report.insideOut);
    EXPECT_LT((other.position - plain.position).cwiseAbs().maxCoeff(), 1e-6);
    FitParam param = Small();
    param.start = FitStart::TriedAxes;
    Shape away = turned; // about a line that is none of its axes
    for (Vector3d &p : away.position)
        p = Eigen::AngleAxisd(2, Vector3d(1, 2, -1).normalized()) * p + Vector3d(20, 5, 0);
    EXPECT_GT(Fit(source, away, param).report.matched, 0.9);
}

TEST(Fit, FindsPointsWithAndWithoutNormals) {
    const double limit = sanitized ? 0.0084 : 0.0063;
    EXPECT_LT(Rms(Fit(source, Points(target)), truth), limit);
    const MeshD mesh(target);
    const Arrays arrays = Read(mesh);
    std::vector<Vector3d> normal(target.position.size(), Vector3d::Zero());
    for (const auto &face : target.face) {
        const auto at = [&](int k) { return target.position[std::size_t(face[std::size_t(k)])]; };
        for (int k : face)
            normal[std::size_t(k)] += (at(1) - at(0)).cross(at(2) - at(0));
    }
    EXPECT_LT(Rms(Fit(source, Points(target), Small(), {}, {}, [&](std::size_t i) { return normal[i]; }), truth),
              limit);
    EXPECT_LT(Rms(Fit(Points(source), target), truth),
              0.0084); // a cloud without normals cannot tell its sides apart
}

TEST(Fit, FindsItThroughNoise) { EXPECT_LT(Rms(Fit(source, Jittered(target, 0.02)), truth), 0.0063); }

// Half of the target is missing: parts without a counterpart are carried along, and not drawn to the border.
TEST(Fit, CarriesAlongWhatHasNoCounterpart) {
    Shape half = Grid(29, 33);
    for (Vector3d &p : half.position)
        p = Rolled(Bumpy(p[0] * 10 / 56, p[1] * 6 / 32));
    const Fitted fitted = Fit(source, half);
    EXPECT_NEAR(fitted.report.matched, 0.5, 0.05);
    const double limit = sanitized ? 0.0054 : 0.0042; // with a third of the samples
    EXPECT_LT(Rms(fitted, truth, [](std::size_t i) { return source.position[i][0] < 4; }), limit);
    int edges = 0, stretched = 0;
    for (const auto &face : source.face)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = face[k], b = face[(k + 1) % 3];
            if (source.position[std::size_t(a)][0] < 5.2)
                continue;
            const double stretch = (fitted.position.col(a) - fitted.position.col(b)).norm() /
                                   (source.position[std::size_t(a)] - source.position[std::size_t(b)]).norm();
            ++edges;
            stretched += stretch < 0.8 || stretch > 1.25;
        }
    EXPECT_LE(100 * stretched, edges);
    // Whether a vertex lies on the target agrees with its distance.
    int there = 0, lies = 0;
    for (std::size_t i = 0; i < source.position.size(); ++i) {
        there += source.position[i][0] < 4.8;
        lies += source.position[i][0] < 4.8 && fitted.liesOn[i];
        if (source.position[i][0] > 5.5) {
            EXPECT_FALSE(fitted.liesOn[i]);
            EXPECT_GT(double(fitted.distance[i]), 0.2);
        }
    }
    EXPECT_GT(lies, (sanitized ? 0.85 : 0.9) * there);
}

// Half of the target is missing, a mesh or points, and that half of the source has not moved: it stays.
TEST(Fit, WhatHasNoCounterpartIsStiff) {
    const auto bent = [](Vector3d p) { // where x is above 6.5
        const double beyond = std::max(p[0] - 6.5, 0.0);
        p[2] += 0.06 * beyond * beyond;
        return p;
    };
    Shape there = source, half = BumpySheet(57, 33);
    for (Vector3d &p : there.position)
        p = bent(p);
    for (Vector3d &p : half.position)
        p = bent(p);
    const auto isLeft = [](const Vector3d &p) { return p[0] < 4; };
    half.face.erase(std::remove_if(half.face.begin(), half.face.end(),
                                   [&](const auto &f) { return isLeft(half.position[std::size_t(f[0])]); }),
                    half.face.end());
    Shape points = half;
    points.face.clear();
    points.position.erase(std::remove_if(points.position.begin(), points.position.end(), isLeft),
                          points.position.end());
    const double most = sanitized ? 0.0056 : 0.0042; // with a third of the samples
    for (const Shape &each : {half, points}) {
        const Fitted fitted = Fit(source, each);
        EXPECT_LT(Rms(fitted, there, [](std::size_t i) { return source.position[i][0] > 4.2; }), most);
        EXPECT_LT(Rms(fitted, there, [](std::size_t i) { return source.position[i][0] < 3.8; }), most);
    }
}

// The end of a cloud is known to about a spacing: where the surface ends with it, it draws the rim. Nothing else tells
// where in its plane a flat sheet lies.
TEST(Fit, TheEndOfACloudDrawsTheRim) {
    const auto flat = [](int nx, int ny, double shift) {
        Shape shape = Grid(nx, ny);
        for (Vector3d &p : shape.position)
            p = {p[0] * 10 / (nx - 1) + shift, p[1] * 6 / (ny - 1), 0};
        return shape;
    };
    const double shift = 0.2;
    Shape cloud = flat(115, 67, shift);
    cloud.face.clear();
    const Fitted fitted = Fit(flat(40, 25, 0), cloud);
    EXPECT_LT(Rms(fitted, flat(40, 25, shift)), 0.9 * shift / std::hypot(10, 6));
}

// Half of the target is missing, and the source has bent there, too: the carried half must not hold back the matched
// one.
TEST(Fit, WhatHasNoCounterpartHoldsNothingBack) {
    Shape half = Grid(29, 33);
    const double curvature = 0.15;
    for (Vector3d &p : half.position)
        p = Rolled(Bumpy(p[0] * 10 / 56, p[1] * 6 / 32), curvature);
    const Fitted fitted = Fit(source, half);
    EXPECT_LT(Rms(fitted, Rolled(source, curvature), [](std::size_t i) { return source.position[i][0] < 4.8; }),
              0.0024);
}

// A thin tongue, shorter than the target's: nothing of it is nearest to the far end.
TEST(Fit, MatchesBothWaysReachWhatIsThin) {
    const auto tongue = [](double length, int n) {
        Shape shape = Grid(n, 9);
        for (Vector3d &p : shape.position) {
            const double t = p[0] / (n - 1), width = t < 0.5 ? 1.5 : 0.25;
            p = Bumpy(t < 0.5 ? 8 * t : 4 + (t - 0.5) * 2 * length, 3 + width * (p[1] / 4 - 1));
        }
        return shape;
    };
    const Shape from = tongue(3, 61), to = tongue(3.8, 81);
    FitParam param = Small();
    param.graph.initialPatches = 100;
    const auto reached = [&](const Fitted &fitted) { return fitted.position.row(0).maxCoeff(); };
    const Fitted asItIs = Fit(from, to, param);
    const double oneWay = reached(asItIs);
    EXPECT_FALSE(asItIs.report.bothWays) << "drawn out, it has no more counterparts than before";
    param.bothWays = true;
    const double bothWays = reached(Fit(from, to, param));
    EXPECT_LT(oneWay, 7.3);
    EXPECT_GT(bothWays, oneWay + 0.2);
}

/// A ball with waves and two arms.
/// \param degrees that the longer arm is turned by, towards the other one
Shape Armed(int rows, int columns, double degrees) {
    Shape shape = Grid(columns + 1, rows);
    const Vector3d arm(1, 0, 0), other(std::sqrt(0.5), 0, std::sqrt(0.5));
    for (Vector3d &p : shape.position) {
        const double down = double(EIGEN_PI) * p[1] / (rows - 1), round = 2 * double(EIGEN_PI) * p[0] / columns;
        const Vector3d d(std::sin(down) * std::cos(round), std::sin(down) * std::sin(round), std::cos(down));
        const auto bell = [&](const Vector3d &to) {
            return std::exp(-std::pow(std::acos(std::min(1.0, std::max(-1.0, d.dot(to)))) / 0.3, 2));
        };
        p = d * (1 + 0.08 * std::sin(3 * d[0] + 1) * std::cos(4 * d[1]) + 0.05 * std::sin(5 * d[2]) + 2.2 * bell(arm) +
                 1.76 * bell(other));
        if (p.normalized().dot(arm) < std::cos(0.5))
            continue;
        const double t = std::min(1.0, std::max(0.0, (p.dot(arm) - 1) / 1.2));
        const Eigen::AngleAxisd turn(degrees * double(EIGEN_PI) / 180 * t * t * (3 - 2 * t), Vector3d(0, -1, 0));
        p = arm + turn * (p - arm);
    }
    return shape;
}

// Turned so far that its end is nearer to the other arm. Matched one way, it shrinks onto that, and the target's end is
// not reached. Matching both ways is then tried unasked.
TEST(Fit, AnArmThatIsNotFoundIsFoundBothWays) {
    const Shape arms = Armed(70, 120, 0), turned = Armed(70, 120, 25);
    FitParam param = Small();
    param.samples = 6000; // dense enough to show that the end is not reached
    param.fitSteps = 25;
    const Fitted fitted = Fit(arms, Armed(61, 101, 25), param);
    double far = 0;
    for (std::size_t i = 0; i < turned.position.size(); ++i)
        far = std::max(far, (fitted.position.col(Eigen::Index(i)) - turned.position[i]).norm());
    EXPECT_TRUE(fitted.report.bothWays);
    EXPECT_LT(far, 0.25) << "and 0.8 one way";
}

// Rolled so far that the nearest points are not the counterparts.
TEST(Fit, LandmarksLeadThere) {
    const Shape far = Rolled(source, 0.3), goal = Rolled(BumpySheet(57, 33), 0.3);
    std::vector<Landmark> landmark;
    for (std::size_t i : {0u, 20u, 39u, 12u * 40u, 12u * 40u + 39u, 24u * 40u, 24u * 40u + 20u, 24u * 40u + 39u})
        landmark.push_back({i, far.position[i]});
    const Fitted fitted = Fit(source, goal, Small(), {}, landmark);
    EXPECT_LT(Rms(fitted, far), 0.021);
    EXPECT_LT(fitted.report.landmarks, 1e-4);
}

TEST(Fit, LandmarksStayWithinTheirTolerance) {
    std::vector<Landmark> landmark; // wrong by a tenth of the height
    for (std::size_t i : {0u, 39u, 12u * 40u + 20u, 24u * 40u, 24u * 40u + 39u})
        landmark.push_back({i, truth.position[i] + Vector3d(0, 0, i % 2 == 0 ? 0.6 : -0.6)});
    FitParam param = Small();
    EXPECT_LT(Fit(source, target, param, {}, landmark).report.landmarks, 1e-4);
    param.landmarkTolerance = 0.5;
    const Fitted within = Fit(source, target, param, {}, landmark);
    EXPECT_GT(within.report.landmarks, 0.4);
    EXPECT_LT(within.report.landmarks, 0.5);
    EXPECT_EQ(within.report.beyond, 0);
    param.landmarkTolerance = 0.7;
    EXPECT_LT(Rms(Fit(source, target, param, {}, landmark), truth), 0.0063);
}

// Landmarks with errors of picking on all of the source, and half of a target: beside it, only landmarks lead.
TEST(Fit, WithAToleranceItComesToRest) {
    Shape half = Jittered(target, 0.01);
    half.face.erase(
        std::remove_if(half.face.begin(), half.face.end(), [](const auto &corner) { return corner[0] % 57 > 28; }),
        half.face.end());
    std::mt19937 random(3);
    std::vector<Landmark> landmark;
    for (std::size_t i = 5; i < source.position.size(); i += 45)
        landmark.push_back({i, truth.position[i] + 0.03 * RandomVector(random)});
    FitParam param = Small();
    for (double tolerance : {0.0, 0.03, 0.06, 0.12}) {
        param.landmarkTolerance = tolerance;
        const Fitted fitted = Fit(source, half, param, {}, landmark);
        EXPECT_TRUE(fitted.report.converged) << tolerance;
        EXPECT_LE(fitted.report.landmarks, tolerance + 1e-4);
        EXPECT_LT(fitted.report.steps, 40) << tolerance;
        EXPECT_LT(Rms(fitted, truth), 0.006) << tolerance;
    }
}

TEST(Fit, WhatIsFixedKeepsItsBits) {
    std::vector<int> tag;
    for (const Vector3d &p : source.position)
        tag.push_back(p[0] < 1.5 ? 0 : p[0] > 9 ? -1 : 1);
    const Fitted fitted = Fit(source, target, Small(), tag);
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (tag[i] < 1) {
            EXPECT_EQ(fitted.position.col(Eigen::Index(i)), source.position[i]);
        }
}

TEST(Fit, MatricesOfBothLayersCount) {
    Eigen::Affine3d world = RandomRigid(3);
    world.linear() *= 2;
    const MeshD from(source), to(target);
    const Arrays fromArrays = Read(from), toArrays = Read(to);
    Handles handles;
    handles.tag.assign(source.position.size(), 1);
    handles.world = world;
    FitGoal goal;
    Matrix3Xd there = toArrays.View().Copy();
    there = world * there;
    goal.world = world * Eigen::Translation3d(0, 0, 1);
    there.colwise() -= world.translation(); // back through another matrix
    there = world.linear().inverse() * there;
    there.row(2).array() -= 1;
    goal.surface = toArrays.View().With(there);
    FitReport report;
    const Fitter fitter(fromArrays.View(), {}, handles, Small());
    Fitted fitted{fromArrays.View().Copy(), {}};
    Carrier(fitter.Surface(), fitter.Solve(*fitter.Prepare(goal), {}, report)).Apply(fitted.position);
    EXPECT_LT(Rms(fitted, truth), 0.0042);
}

TEST(Fit, TheSameBitsForAnyNumberOfThreads) {
    const Fitted one = Fit(source, target, Small(), {}, {}, {}, 1), four = Fit(source, target, Small(), {}, {}, {}, 4);
    EXPECT_TRUE(SameBits(one.position, four.position));
}

TEST(Fit, TellsALineFromAPlane) {
    std::vector<Vector3d> points{{1e6, 2, 3}, {1e6 + 4, 2, 3}};
    EXPECT_EQ(AcrossALine(points), 0);
    points.emplace_back(1e6 + 2, 2, 3);
    EXPECT_LT(AcrossALine(points), 1e-9);
    points = {{1e6 + 1, 1, 1}, {1e6 - 1, 1, -1}, {1e6 - 1, -1, -1}, {1e6 + 1, -1, 1}};
    EXPECT_NEAR(AcrossALine(points), std::sqrt(0.5), 1e-9); // a rectangle of 2 by the root of 8
    EXPECT_EQ(AcrossALine({3, Vector3d(1, 1, 1)}), 0);
    const std::vector<Vector3d> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}};
    using Pair = std::pair<std::vector<Vector3d>, std::vector<Vector3d>>;
    for (const Pair &each : {Pair(points, line), Pair(line, points), Pair(points, {4, points[0]})})
        EXPECT_NE(MessageOf<BadInput>([&] {
                      StartFromLandmarks(each.first, each.second, true);
                  }).find("three of them that are not on a line"),
                  std::string::npos);
}

TEST(Fit, SaysWhatCannotBe) {
    ExpectError([] { Fit(source, Points(Shape{})); }, "no vertices");
    ExpectError([] { Fit(Shape{}, target); }, "There is nothing to fit: the surface has no vertices");
    ExpectError(
        [] {
            Fit(Shape{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}, {}}, target);
        },
        "The surface has no triangle with an area where it is free to bend");
    ExpectError([] { Fit(source, Shape{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}, {}}); }, "no triangle");
    ExpectError([] { Fit(source, target, Small(), {}, {{source.position.size(), {0, 0, 0}}}); }, "Landmark 1");
    ExpectError([] { Fit(source, target, Small(), {}, {{3, {0, 0, 0}}, {3, {1, 0, 0}}}); }, "Landmark 2");
    std::vector<int> tag(source.position.size(), 1);
    tag[5] = 0;
    ExpectError([&] { Fit(source, target, Small(), tag, {{5, {0, 0, 0}}}); }, "not free");
    ExpectError([] { Fit(source, target, {}, std::vector<int>(source.position.size(), 0)); }, "free");
    ExpectError([] { Fit(Shape{{{0, 0, 0}}, {}, {}}, target); }, "nothing to fit: only single vertices are free");
    Shape loose = source;
    loose.position.emplace_back(0, 0, 9);
    ExpectError(
        [&] {
            Fit(loose, target, Small(), {}, {{source.position.size(), {0, 0, 0}}});
        },
        "Landmark 1 is at a vertex of a loose part, which only goes along with the surface. Leave it out.");
    for (const auto &[scale, size] : {std::pair(1e77, "times larger"), std::pair(1e150, "times larger"),
                                      std::pair(1e-10, "times smaller"), std::pair(1e-200, "times smaller")}) {
        Shape other = target;
        for (Vector3d &p : other.position)
            p *= scale;
        ExpectError([&] { Fit(source, other); }, std::string(size) + " than the surface. Scale one of them first.");
        ExpectError([&] { Fit(source, Points(other)); }, std::string(size) + " than the surface. Scale one of them");
    }
    Shape stray = target; // one vertex does not make it large
    stray.position.emplace_back(1e50, 0, 0);
    EXPECT_LT(Rms(Fit(source, stray), Points(truth)), 0.01);
    for (double FitParam::*value : {&FitParam::stiffness, &FitParam::largestDistance, &FitParam::largestAngle}) {
        FitParam param = Small();
        param.*value = 0;
        ExpectError([&] { Fit(source, target, param); }, "must be");
    }
    FitParam param;
    param.fitSteps = 1;
    ExpectError([&] { Fit(source, target, param); }, "steps");
    for (double tolerance : {-1.0, std::numeric_limits<double>::infinity()}) {
        param = {};
        param.landmarkTolerance = tolerance;
        ExpectError([&] { Fit(source, target, param); }, "tolerance");
    }
    param = {};
    param.samples = 1;
    ExpectError([&] { Fit(source, target, param); }, "places");
}

Fitted Weighted(const Shape &source, const Shape &target, const WeightOf &weight, const WeightOf &targetWeight = {}) {
    return Fit(source, target, Small(), {}, {}, {}, 0, weight, targetWeight);
}

bool IsSame(const Fitted &a, const Fitted &b) { return (a.position.array() == b.position.array()).all(); }

// Half of the target is wrong, as the gum around a jaw may be another person's.
TEST(Fit, WhatDoesNotCountIsCarriedAndNotMatched) {
    Shape other = target;
    for (std::size_t i = 0; i < other.position.size(); ++i)
        if (const double x = double(i % 57) / 56 * 10; x > 5)
            other.position[i] += Vector3d(0, 0, 1.5 * std::min(1.0, x - 5));
    const auto isLeft = [](std::size_t i) { return source.position[i][0] < 5; };
    const auto isRight = [](std::size_t i) { return source.position[i][0] > 6; };
    const Fitted all = Weighted(source, other, {}), half = Weighted(source, other, isLeft);
    EXPECT_GT(Rms(all, truth, isRight), 0.1);
    EXPECT_LT(Rms(half, truth, isRight), 0.5 * Rms(all, truth, isRight));
    EXPECT_LT(Rms(half, truth, [](std::size_t i) { return source.position[i][0] < 4.5; }), 0.0042);
    EXPECT_NEAR(half.report.counted, 0.5, 0.05);
    EXPECT_EQ(all.report.counted, 1);
    EXPECT_GT(half.report.matched, 0.85); // of what counts
    for (std::size_t i = 0; i < source.position.size(); ++i)
        if (isRight(i)) {
            EXPECT_FALSE(half.liesOn[i]);
        }
    // Weights between 0 and 1 have an effect between.
    const Fitted little = Weighted(source, other, [&](std::size_t i) { return source.position[i][0] < 5 ? 1 : 1e-5; });
    EXPECT_LT(Rms(half, truth, isRight), Rms(little, truth, isRight));
    EXPECT_LT(Rms(little, truth, isRight), Rms(all, truth, isRight));
    // 1 everywhere is the same as no weights.
    const auto one = [](std::size_t) { return 1; };
    EXPECT_TRUE(IsSame(Weighted(source, target, one, one), Fit(source, target)));
}

TEST(Fit, WhatDoesNotCountOfTheTargetIsAsIfItWereNotThere) {
    Shape cluttered = target; // a second sheet above it
    const int first = int(target.position.size());
    for (const Vector3d &p : target.position)
        cluttered.position.emplace_back(p + Vector3d(0, 0, 0.3));
    for (const auto &face : target.face)
        cluttered.face.push_back({face[0] + first, face[1] + first, face[2] + first});
    const auto isTarget = [&](std::size_t i) { return i < std::size_t(first); };
    EXPECT_TRUE(IsSame(Weighted(source, cluttered, {}, isTarget), Fit(source, target)));
    EXPECT_TRUE(IsSame(Weighted(source, Points(cluttered), {}, isTarget), Fit(source, Points(target))));
}

TEST(Fit, SaysWhichWeightsCannotBe) {
    const auto none = [](std::size_t) { return 0; };
    ExpectError([&] { Weighted(source, target, none); }, "The weights of the surface are 0 wherever it is free");
    ExpectError([&] { Weighted(source, target, {}, none); }, "The weights of the target are 0 everywhere");
    ExpectError([&] { Weighted(source, target, [](std::size_t i) { return i == 7 ? 2 : 1; }); },
                "The weight of vertex 7 of the surface is 2");
    ExpectError([&] { Weighted(source, target, {}, [](std::size_t i) { return i == 3 ? std::nan("") : 1; }); },
                "The weight of vertex 3 of the target is no number");
}

/// With a ball of so many vertices around.
Shape Ball(const Vector3d &middle, double radius, int around = 16) {
    Shape ball;
    for (int i = 0; i <= around / 2; ++i)
        for (int k = 0; k < around; ++k) {
            const double a = 2 * detail::pi * k / around, b = detail::pi * (i + 0.05) / (around / 2 + 0.1);
            ball.position.emplace_back(
                middle + radius * Vector3d(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)));
        }
    for (int i = 0; i < around / 2; ++i)
        for (int k = 0; k < around; ++k) {
            const int a = i * around + k, b = i * around + (k + 1) % around;
            ball.face.push_back({a, a + around, b});
            ball.face.push_back({b, a + around, b + around});
        }
    return ball;
}
/// A ball with lumps, so that its places can be told apart.
Shape Lumpy(int around) {
    Shape ball = Ball(Vector3d::Zero(), 1, around);
    for (Vector3d &p : ball.position)
        p = (3 + 0.3 * std::sin(4 * p[0] + 3 * p[1]) + 0.3 * std::sin(5 * p[1] - 3 * p[2] + 1) +
             0.1 * std::sin(11 * p[2] + 9 * p[0]) + 0.1 * std::sin(13 * p[1] - 8 * p[0] + 2)) *
            Vector3d(1.3 * p[0], p[1], 0.9 * p[2]);
    return ball;
}

/// What lies above a plane across an axis.
Shape Above(Shape shape, double least, int axis = 2) {
    shape.face.erase(std::remove_if(shape.face.begin(), shape.face.end(),
                                    [&](const auto &face) {
                                        return std::any_of(face.begin(), face.end(), [&](int i) {
                                            return shape.position[std::size_t(i)][axis] <= least;
                                        });
                                    }),
                     shape.face.end());
    return shape;
}

// Stiff, it would draw the rim along the target, which no distance tells, and then be off by 0.0105.
TEST(Fit, WhatHasNoCounterpartDrawsNothingAlong) {
    if (sanitized)
        return; // it needs many samples
    const Shape from = Lumpy(40), belongs = Rolled(from, 0.1);
    const double cut = -1;
    const Fitted fitted = Fit(from, Above(Rolled(Lumpy(57), 0.1), cut));
    EXPECT_LT(Rms(fitted, belongs, [&](std::size_t i) { return belongs.position[i][2] < cut; }), 0.0092);
}

// For a large surface this takes a second, and can be cancelled.
TEST(Fit, ComparingSidesCanBeCancelled) {
    const int n = 100000;
    Eigen::Matrix3Xd position(3, n);
    std::vector<Corners> strip;
    for (int i = 0; i < n; ++i) {
        position.col(i) = Vector3d(i / 2, i % 2, 0);
        if (i >= 2)
            strip.push_back(i % 2 == 0 ? Corners{i - 2, i, i - 1} : Corners{i - 2, i - 1, i});
    }
    std::vector<Corners> triangle = strip;
    std::size_t calls = 0;
    {
        const CallbackLog log;
        MakeOneSided(position, triangle, log.Progress());
        EXPECT_EQ(triangle, strip) << "it has one side already";
        EXPECT_TRUE(std::is_sorted(log.percent.begin(), log.percent.end()));
        calls = log.percent.size();
    }
    ASSERT_GE(calls, 4); // at the start of each loop, and after 65536 rounds
    for (std::size_t call = 0; call < calls; ++call) {
        const CallbackLog log(call);
        EXPECT_THROW(MakeOneSided(position, triangle, log.Progress()), Cancelled);
    }
}

/// A ball with five fingers, each turned at its root. \param apart distance of the fingers, over that of spread ones
Shape Hand(int around, double apart) {
    Shape hand = Ball(Vector3d::Zero(), 1, around);
    for (Vector3d &p : hand.position) {
        double length = 0.5;
        for (int k = 0; k < 5; ++k) {
            const double a = (k - 2) * 40 * detail::pi / 180;
            length += (0.9 + 0.06 * k) * std::exp(70 * (p.dot(Vector3d(std::cos(a), std::sin(a), 0)) - 1));
        }
        p *= length;
        const double out = std::clamp((length - 0.55) / 0.25, 0.0, 1.0), along = out * out * (3 - 2 * out),
                     angle = std::atan2(p[1], p[0]), turn = std::abs(angle) < 2 ? (apart - 1) * along * angle : 0;
        p = Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * p;
    }
    return hand;
}

// Each finger except the middle one lies nearer to another one's old place.
TEST(Fit, FindsFingersThatClose) {
    if (sanitized)
        return; // fingers need many samples
    FitParam param;
    param.samples = 3000;
    param.fitSteps = 25;
    const Shape from = Hand(140, 1), to = Hand(152, 0.55), belongs = Hand(140, 0.55);
    const Fitted fitted = Fit(from, to, param);
    EXPECT_LT(Rms(fitted, belongs), 0.006);
    EXPECT_GE(fitted.report.endsLed, 5);
    EXPECT_NE(Joined(fitted.report.Remarks()).find("led the fit at first"), std::string::npos);
    EXPECT_EQ(Fit(from, Hand(152, 0.95), param).report.endsLed, 0);
}

/// A slightly uneven rod, bent to an arc of \p curvature from its end on.
Shape Rod(int around, double curvature) {
    Shape rod = Ball(Vector3d::Zero(), 1, around);
    for (Vector3d &p : rod.position) {
        const double z = 8 * p[2] + 8, round = std::atan2(p[1], p[0]);
        p.head<2>() *= 1 + 0.02 * std::sin(0.7 * z + round) + 0.012 * std::cos(1.3 * z - 2 * round);
        p[2] = z;
        const double angle = curvature * z, radius = 1 / curvature - p[0];
        if (curvature > 0)
            p = Vector3d(1 / curvature - radius * std::cos(angle), p[1], radius * std::sin(angle));
    }
    return rod;
}

// On its way it slides along the target. A second fit, from where it lies, brings it nearer: without, it is 0.0062 off.
TEST(Fit, WhatIsBentFarDoesNotSlideAlong) {
    if (sanitized)
        return; // it needs many samples
    FitParam param = Small();
    param.graph.initialPatches = 120;
    EXPECT_LT(Rms(Fit(Rod(40, 0), Rod(47, 0.16), param), Rod(40, 0.16)), 0.0045);
}

// If the soft surface follows the noise of a fine target, it becomes stiffer, at rest or not; otherwise the error is
// 0.0042 and 0.0045.
TEST(Fit, FollowsLittleOfStrongNoise) {
    if (sanitized)
        return; // the case must be as large for the noise
    const Shape from = Lumpy(110);
    FitParam param;
    param.samples = 4000;
    for (const int steps : {50, 20}) {
        param.fitSteps = steps;
        const Fitted fitted = Fit(from, Jittered(Rolled(Lumpy(131)), 0.04), param);
        EXPECT_LT(Rms(fitted, Rolled(from)), 0.0038) << steps;
        EXPECT_EQ(fitted.report.steps < steps, steps == 50) << "it comes to rest in the first one only";
    }
}

// A ball slides along itself: only the curves tell that the target is turned. Their vertices and corners lie at
// different places.
TEST(Fit, CurvesLeadWhatSlides) {
    const int around = 40;
    const double turned = 0.45;
    const Eigen::Affine3d turn(Eigen::AngleAxisd(turned, Vector3d::UnitZ()));
    const Shape from = Ball(Vector3d::Zero(), 5, around), to = Moved(Ball(Vector3d::Zero(), 5, around + 7), turn),
                belongs = Moved(from, turn);
    Curve meridian, ring;
    for (int i = 3; i <= around / 2 - 3; ++i)
        meridian.vertex.push_back(std::size_t(i * around));
    const auto onBall = [](double along, double up) {
        return Vector3d(5 * std::sin(up) * std::cos(along), 5 * std::sin(up) * std::sin(along), 5 * std::cos(up));
    };
    for (int k = 0; k <= 50; ++k)
        meridian.target.push_back(onBall(turned, 0.2 + k * 0.055));
    const double height = std::acos(from.position[std::size_t(around / 2 * around / 2)][2] / 5);
    for (int k = 0; k < around; ++k)
        ring.vertex.push_back(std::size_t(around / 2 * around / 2 + k));
    for (int k = 0; k <= 90; ++k)
        ring.target.push_back(onBall(0.01 + 2 * detail::pi * (k % 90) / 90, height));
    const auto fit = [&](const std::vector<Curve> &curves) {
        return Fit(from, to, Small(), {}, {}, {}, 0, {}, {}, curves);
    };
    const double without = Rms(fit({}), belongs);
    for (const std::vector<Curve> &curves : Rounds<std::vector<Curve>>({{meridian, ring}, {meridian}})) {
        const Fitted fitted = fit(curves);
        EXPECT_LT(Rms(fitted, belongs), 0.2 * without);
        EXPECT_LT(fitted.report.curves, 0.01);
        EXPECT_TRUE(fitted.report.converged);
    }
    EXPECT_EQ(fit({}).report.curves, 0);
    // Places beside the vertices lie on the curve: the vertices themselves do not, and offsets turn with the surface.
    Curve beside = meridian;
    for (const std::size_t vertex : beside.vertex) {
        const Vector3d p = from.position[vertex];
        beside.offset.emplace_back(Eigen::AngleAxisd(0.1, Vector3d::UnitZ()) * p - p);
    }
    for (Vector3d &corner : beside.target)
        corner = Eigen::AngleAxisd(0.1, Vector3d::UnitZ()) * corner;
    const Fitted fitted = fit({beside});
    EXPECT_LT(Rms(fitted, belongs), 0.2 * without);
    EXPECT_LT(fitted.report.curves, 0.01);
    // Of many corners, only some are used.
    Curve fine = meridian;
    fine.target.clear();
    for (int k = 0; k <= 2000; ++k)
        fine.target.push_back(onBall(turned, 0.2 + k * 0.055 / 40));
    EXPECT_NEAR(Rms(fit({fine}), belongs), Rms(fit({meridian}), belongs), 0.01);
    // Two that contradict each other pull to the middle, and the report shows it.
    Curve above = ring;
    above.target.clear();
    for (int k = 0; k <= 90; ++k)
        above.target.push_back(onBall(0.01 + 2 * detail::pi * (k % 90) / 90, height - 0.1));
    for (const std::vector<Curve> &both : {std::vector<Curve>{ring, above}, {above, ring}})
        EXPECT_NEAR(fit(both).report.curves, 5 * 0.1 / 2, 0.05);
    std::vector<int> tag(from.position.size(), 1);
    tag[meridian.vertex[0]] = 0;
    ExpectError([&] { Fit(from, to, Small(), tag, {}, {}, 0, {}, {}, {meridian}); },
                "does not exist, is not free, or belongs to a loose part");
    meridian.offset.resize(2);
    ExpectError([&] { fit({meridian}); }, "Curve 1 has 2 offsets. Give one for each vertex");
    meridian.offset.clear();
    for (Vector3d &corner : above.target)
        corner += Vector3d(0, 0, 100);
    ExpectError([&] { fit({meridian, above}); }, "Curve 2 is ");
    above.target.assign(9, meridian.target[9]);
    ExpectError([&] { fit({above}); }, "Curve 1 has all its points on the target at one place");
    ring.target.resize(1);
    ExpectError([&] { fit({meridian, ring}); }, "Curve 2 has fewer than two points");
    meridian.target[3][1] = std::nan("");
    ExpectError([&] { fit({meridian}); }, "Curve 1 has a point that is not finite");
    meridian.vertex.push_back(from.position.size());
    meridian.target.erase(meridian.target.begin() + 3);
    ExpectError([&] { fit({meridian}); }, "which does not exist");
}

// A sheet of unit squares, in a layer with a turn and a scale of 2.
TEST(Fit, KnowsWhatLiesAlongALine) {
    const Shape sheet = Grid(21, 11);
    const MeshD mesh(sheet);
    const Arrays arrays = Read(mesh);
    Handles handles;
    for (const Vector3d &p : sheet.position)
        handles.tag.push_back(p[0] < 1.5 ? -1 : p[0] < 5.5 ? 0 : 1);
    handles.world =
        Eigen::Translation3d(7, 8, 9) * Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()) * Eigen::Scaling(2.0);
    const Fitter fitter(arrays.View(), {}, handles, Small());
    const auto world = [&](std::vector<Vector3d> line) {
        for (Vector3d &p : line)
            p = handles.world * p;
        return line;
    };
    const auto along = [&](const std::vector<Vector3d> &line) { return fitter.Along({world(line)})[0]; };
    const auto slot = [](int x, int y) { return std::size_t(y * 21 + x); };
    const auto expect = [](const AlongLine &found, std::vector<std::size_t> vertices) {
        std::sort(vertices.begin(), vertices.end());
        EXPECT_EQ(found.vertex, vertices);
        EXPECT_FALSE(found.isElsewhere);
    };
    // Around a corner and back again. Vertices are free from the sixth column on.
    const AlongLine bent = along({{0.1, 2.2, 0.3}, {8.1, 2.2, 0.3}, {8.1, 5.1, 0}, {8.1, 2.2, 0.3}});
    expect(bent, {slot(6, 2), slot(7, 2), slot(8, 2), slot(8, 3), slot(8, 4), slot(8, 5)});
    for (std::size_t k = 0; k < bent.vertex.size(); ++k) { // to the line, where that is nearest
        const Vector3d at = handles.world.inverse() * (handles.world * sheet.position[bent.vertex[k]] + bent.offset[k]);
        EXPECT_NEAR(bent.vertex[k] < slot(0, 3) ? at[1] - 2.2 : at[0] - 8.1, 0, 1e-9);
        EXPECT_LE(bent.offset[k].norm(), bent.farthest + 1e-9);
    }
    EXPECT_GE(bent.farthest, 1.999 * std::hypot(0.3, 0.2, 0.1));
    EXPECT_LE(bent.farthest, 2 * std::hypot(0.3, 0.2, 0.6)); // half of the way to the next
    expect(along({{9.3, 3.1, 0}}), {slot(9, 3)});
    expect(along({{9.3, 3.1, 0}, {9.3, 3.1, 0}}), {slot(9, 3)});
    EXPECT_EQ(fitter.Along({world({{9.3, 3.1, 0}}), world({{1, 1, 0}, {3, 1, 0}})})[1].vertex.size(), 0u);

    // Its box, turned, is at least 18 across and at most 31, times 2.
    const AlongLine over = along({{8, 2, 0}, {8, 8, 1.5}, {10, 8, 0}}), far = along({{8, 2, 0}, {8, 8, 4}, {9, 9, 0}});
    EXPECT_FALSE(over.isElsewhere);
    EXPECT_TRUE(far.isElsewhere);
    EXPECT_EQ(far.corner, 1u);
    EXPECT_NEAR(far.farthest, 8, 1e-9);
    for (double huge : {1e9, 1e200, 1e308})
        EXPECT_TRUE(along({{8, 2, 0}, {huge, -huge, huge}}).isElsewhere) << huge;
}

// A line on a sheet of two triangles is far from their corners, but not elsewhere.
TEST(Fit, KnowsWhatLiesAlongALineOfFewTriangles) {
    const MeshD mesh(Grid(2, 2, 10));
    const Arrays arrays = Read(mesh);
    Handles handles;
    handles.tag.assign(4, 1);
    const Fitter fitter(arrays.View(), {}, handles, Small());
    EXPECT_FALSE(fitter.Along({{{5, 5, 0}, {5, 9, 0}}})[0].isElsewhere);
    EXPECT_TRUE(fitter.Along({{{5, 5, 0}, {5, 40, 0}}})[0].isElsewhere);
}

Shape Together(Shape a, const Shape &b) {
    const int first = int(a.position.size());
    a.position.insert(a.position.end(), b.position.begin(), b.position.end());
    for (const auto &face : b.face)
        a.face.push_back({face[0] + first, face[1] + first, face[2] + first});
    return a;
}

TEST(Fit, TellsWhatItGuesses) {
    EXPECT_LT(Fit(source, target).report.guessed, 0.02);
    const auto isLeft = [](std::size_t i) { return source.position[i][0] < 5; };
    const Fitted half = Weighted(source, target, isLeft);
    EXPECT_NEAR(half.report.guessed, 0.5, 0.1);
    const double off = Rms(half, truth, [](std::size_t i) { return source.position[i][0] > 5; }) * std::hypot(10, 6);
    EXPECT_GT(half.report.guessError, off / 3);
    EXPECT_LT(half.report.guessError, 3 * off);
    EXPECT_GT(half.report.movedMost, half.report.moved);
    EXPECT_NEAR(half.report.movedMost, 1, 0.3); // as far as the sheet was rolled up by its middle
}

TEST(Fit, TellsHowFarLandmarksAreWithoutThemselves) {
    const MeshD from(source), to(target);
    const Arrays fromArrays = Read(from), toArrays = Read(to);
    Handles handles;
    handles.tag.assign(source.position.size(), 1);
    const Fitter fitter(fromArrays.View(), {}, handles, Small());
    FitGoal goal;
    goal.surface = toArrays.View();
    const auto prepared = fitter.Prepare(goal);
    const std::vector<Landmark> landmark = {{300, truth.position[300]}, {800, truth.position[800] + Vector3d(1, 0, 0)}};
    const std::vector<double> off = fitter.LeaveOneOut(*prepared, landmark);
    const Fitted without = Fit(source, target, Small(), {}, {landmark[0]});
    ASSERT_EQ(off.size(), 2u);
    EXPECT_NEAR(off[1], (without.position.col(800) - landmark[1].target).norm(), 1e-4);
    FitReport report;
    const Deformer::Pose pose = fitter.Solve(*prepared, {landmark[0]}, report);
    EXPECT_DOUBLE_EQ(fitter.Residuals(landmark, pose, without.position)[1],
                     (without.position.col(800) - landmark[1].target).norm());
    ExpectError(
        [&] {
            fitter.Residuals({{999999, Vector3d::Zero()}}, pose, without.position);
        },
        "Pair 0 of those to check, counted from 0, is at no vertex");
}

// The target lies turned, and is three times as large.
TEST(Fit, LandmarksBesideVerticesTurnAndGrowWithTheSurface) {
    const Eigen::Affine3d there =
        Eigen::Translation3d(20, -5, 3) * Eigen::Scaling(3.0) * Eigen::AngleAxisd(2, Vector3d(1, 2, -1).normalized());
    const MeshD from(source);
    const Arrays arrays = Read(from);
    Handles handles;
    handles.tag.assign(source.position.size(), 1);
    FitParam param = Small().LandmarksAlone();
    param.start = FitStart::Similar;
    const Fitter fitter(arrays.View(), {}, handles, param);
    std::vector<Landmark> landmark;
    for (const std::size_t i : {45u, 70u, 300u, 500u, 640u, 910u}) {
        const Vector3d place = 0.6 * source.position[i] + 0.4 * source.position[i + 41];
        landmark.push_back({i, there * place, place - source.position[i]});
    }
    FitReport report;
    const Deformer::Pose pose = fitter.Solve(*fitter.TargetOf(landmark), landmark, report);
    Matrix3Xd position = arrays.View().Copy();
    Carrier(fitter.Surface(), pose).Apply(position);
    const Matrix3Xd mapped = position;
    fitter.PutLandmarks(landmark, position);
    EXPECT_EQ(position, mapped) << "no vertex is at a landmark";
    for (std::size_t i = 0; i < source.position.size(); ++i)
        ASSERT_LT((position.col(Eigen::Index(i)) - there * source.position[i]).norm(), 1e-4) << i;
    for (const double off : fitter.Residuals(landmark, pose, position))
        EXPECT_LT(off, 1e-4);
    EXPECT_LT(fitter.LeaveOneOut(*fitter.TargetOf(landmark), landmark)[2], 1e-4);
}

// A ball on the sheet has no counterpart: it moves with the place where it sits, though parts of it are near enough to
// be matched. If the target has it, it is matched.
TEST(Fit, PartsThatNothingMatchesAreCarried) {
    const Shape ball = Ball(Bumpy(6, 3) + Vector3d(0, 0, 0.5), 0.45);
    const Shape both = Together(source, ball), there = Together(truth, Rolled(ball));
    const auto isBall = [](std::size_t i) { return i >= source.position.size(); };
    const Fitted without = Fit(both, target);
    EXPECT_EQ(without.report.carried, 1u);
    EXPECT_LT(Rms(without, there, isBall), 0.006);
    EXPECT_LT(Rms(without, there, [&](std::size_t i) { return !isBall(i); }), 0.0042);
    for (std::size_t i = source.position.size(); i < both.position.size(); ++i)
        EXPECT_FALSE(without.liesOn[i]);
    const Fitted weighted = Weighted(both, target, [&](std::size_t i) { return !isBall(i); });
    EXPECT_EQ(weighted.report.carried, 1u);
    EXPECT_LT(Rms(weighted, there, isBall), 0.006);
    EXPECT_EQ(Fit(both, Together(target, Rolled(ball))).report.carried, 0u);
    // With landmarks only, parts without one are carried, and parts with one follow it.
    FitParam alone = Small().LandmarksAlone();
    std::vector<Landmark> landmark;
    for (std::size_t i = 0; i < source.position.size(); i += 37)
        landmark.push_back({i, truth.position[i]});
    EXPECT_LT(Rms(Fit(both, target, alone, {}, landmark), there, isBall), 0.01);
    landmark.push_back({source.position.size() + 20, Vector3d(5, 3, 9)});
    const Fitted led = Fit(both, target, alone, {}, landmark);
    EXPECT_EQ(led.report.carried, 0u);
    EXPECT_LT((led.position.col(Eigen::Index(source.position.size()) + 20) - Vector3d(5, 3, 9)).norm(), 1e-4);
}

TEST(Fit, SaysWhatHasNoSolution) {
    Shape strip = Grid(60, 2, 1.0 / 59); // as thin as a line
    for (Vector3d &p : strip.position)
        p[1] *= 1e-9;
    const std::vector<Landmark> ends = {{0, Vector3d(0, 0, 0)}, {59, Vector3d(1, 0, 0.1)}};
    EXPECT_NE(MessageOf<Unsolvable>([&] { Fit(strip, target, Small(), {}, ends); }).find("cannot be solved"),
              std::string::npos);
    FitParam param;
    param.smoothness = 1e7;
    EXPECT_EQ(MessageOf<BadInput>([&] { Fit(source, target, param); }),
              "The smoothness of a fit must be at most 1e6; useful are 0.001 to 0.1.");
}

// Crumbs with more than twice the vertices of the sheet, but hardly any area, do not make it a heap of parts.
TEST(Fit, CrumbsAreNotWhatASurfaceIs) {
    const Shape sheet = BumpySheet(20, 12), there = Rolled(BumpySheet(29, 17));
    Shape littered = sheet;
    for (int i = 0; i < 200; ++i) {
        const int first = int(littered.position.size());
        const Vector3d p = sheet.position[std::size_t(i)] + Vector3d(0.1, 0.1, 0.05);
        for (const Vector3d &corner : {Vector3d(0, 0, 0), Vector3d(0.02, 0, 0), Vector3d(0, 0.02, 0)})
            littered.position.push_back(p + corner);
        littered.face.push_back({first, first + 1, first + 2});
    }
    const Fitted clean = Fit(sheet, there), dirty = Fit(littered, there);
    double most = 0;
    for (std::size_t i = 0; i < sheet.position.size(); ++i)
        most = std::max(most, (dirty.position.col(Eigen::Index(i)) - clean.position.col(Eigen::Index(i))).norm());
    EXPECT_LT(most / std::hypot(10, 6), 1.5e-3);
}

// Of a sheet in a hundred parts, crumbs above it tell nothing of where it belongs, wherever there are crumbs.
TEST(Fit, CrumbsAmongPartsAreNotMatched) {
    const auto cut = [](Shape sheet) {
        const auto partOf = [&](int i) {
            return std::floor(1.25 * sheet.position[std::size_t(i)][0]) * 100 +
                   std::floor(1.25 * sheet.position[std::size_t(i)][1]);
        };
        sheet.face.erase(
            std::remove_if(sheet.face.begin(), sheet.face.end(),
                           [&](const auto &f) { return partOf(f[0]) != partOf(f[1]) || partOf(f[0]) != partOf(f[2]); }),
            sheet.face.end());
        return sheet;
    };
    const auto littered = [](Shape shape, std::size_t step) {
        for (std::size_t i = 0, n = shape.position.size(); i < n; i += step) {
            const int first = int(shape.position.size());
            const Vector3d p = shape.position[i] + Vector3d(0.1, 0.1, 0.2);
            for (const Vector3d &corner : {Vector3d(0, 0, 0), Vector3d(0.06, 0, 0), Vector3d(0, 0.06, 0)})
                shape.position.push_back(p + corner);
            shape.face.push_back({first, first + 1, first + 2});
        }
        return shape;
    };
    const Shape sheet = cut(BumpySheet(49, 29)), other = cut(BumpySheet(53, 31)), belongs = Rolled(sheet);
    const auto isSheet = [&](std::size_t i) { return i < sheet.position.size(); };
    const double clean = Rms(Fit(sheet, Rolled(other)), belongs, isSheet);
    EXPECT_LT(Rms(Fit(littered(sheet, 5), Rolled(littered(other, 7))), belongs, isSheet), 1.5 * clean);
}

// As exporters of thin shells write them, and tools that flip faces: a face counts once, and all are turned to one
// side.
TEST(Fit, FacesCountOnceAndAllLookToOneSide) {
    const auto turned = [](Shape shape, const auto &isTurned) {
        for (std::size_t f = 0; f < shape.face.size(); ++f)
            if (isTurned(f))
                std::swap(shape.face[f][1], shape.face[f][2]);
        return shape;
    };
    const auto twice = [](Shape shape, const Shape &other) {
        shape.face.insert(shape.face.end(), other.face.begin(), other.face.end());
        return shape;
    };
    const auto all = [](std::size_t) { return true; };
    const auto some = [](std::size_t f) { return f % 3 == 0 || f % 7 == 1; };
    const auto half = [](std::size_t f) { return f < 2000; };
    FitParam param = Small();
    param.fitSteps = 20;
    const Fitted plain = Fit(source, target, param);
    EXPECT_GT(plain.report.matched, 0.9);
    for (const Shape &other : {twice(target, target), twice(target, turned(target, all)), turned(target, some),
                               turned(target, half), turned(twice(target, target), some)}) {
        const Fitted fitted = Fit(source, other, param);
        EXPECT_LT((fitted.position - plain.position).cwiseAbs().maxCoeff(), 1e-6);
        EXPECT_EQ(fitted.report.matched, plain.report.matched);
    }
    for (const Shape &other : {twice(source, turned(source, all)), turned(source, some), turned(source, half)})
        EXPECT_LT((Fit(other, target, param).position - plain.position).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Fit, PlacesOfATargetStandForItsArea) {
    Shape box; // 2 x 1 x 1, of 12 triangles
    for (int i = 0; i < 8; ++i)
        box.position.emplace_back(2 * (i & 1), i >> 1 & 1, i >> 2);
    for (const auto &[a, b, c, d] :
         {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        box.face.push_back({a, b, c});
        box.face.push_back({a, c, d});
    }
    const MeshD mesh(box);
    const Arrays arrays = Read(mesh);
    const FitTarget boxTarget(arrays.View(), {}, Eigen::Affine3d::Identity());
    const std::vector<FitTarget::Match> places = boxTarget.Places(1000);
    EXPECT_NEAR(double(places.size()), 1000, 1);
    int top = 0, cells[2][2] = {};
    for (const FitTarget::Match &each : places)
        if (each.point[2] > 1 - 1e-9 && each.point[0] > 1e-9 && each.point[0] < 2 - 1e-9) {
            ++top;
            ++cells[each.point[0] > 1][each.point[1] > 0.5];
        }
    EXPECT_NEAR(top, 200, 10); // a fifth of the area
    for (const auto &row : cells)
        for (int count : row)
            EXPECT_NEAR(count, 50, 12);
}

// As in organised clouds of depth cameras.
TEST(Fit, WhatIsNotFiniteIsLeftOutOfTheTarget) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Shape holed = Points(target), clean = holed;
    clean.position.clear();
    for (std::size_t i = 0; i < holed.position.size(); ++i)
        if (i % 3 == 1)
            holed.position[i] =
                i % 2 ? Vector3d(nan, nan, nan) : Vector3d(0, std::numeric_limits<double>::infinity(), 0);
        else
            clean.position.push_back(holed.position[i]);
    FitParam param = Small();
    param.fitSteps = 10;
    const Fitted fitted = Fit(source, holed, param), expected = Fit(source, clean, param);
    EXPECT_EQ(fitted.report.notFinite, holed.position.size() - clean.position.size());
    EXPECT_TRUE(SameBits(fitted.position, expected.position));
    Shape torn = target; // the faces at it are left out
    torn.position[900][1] = nan;
    const Fitted onto = Fit(source, torn, param);
    EXPECT_EQ(onto.report.notFinite, 1u);
    EXPECT_LT(Rms(onto, truth), 0.0063);
    ExpectError([&] { Fit(source, Points(Shape{{{nan, 0, 0}}, {}, {}})); }, "finite numbers");
}

TEST(Fit, ATargetThatIsNoSurfaceIsRefusedOrTold) {
    ExpectError([] { Fit(source, Points(Shape{{{1, 2, 3}}, {}, {}})); }, "one point or on one line");
    ExpectError([] { Fit(source, Points(Shape{{{1, 2, 3}, {1, 2, 3}}, {}, {}})); }, "one point or on one line");
    Shape line;
    for (int i = 0; i < 100; ++i)
        line.position.emplace_back(0.1 * i, 0.2 * i, 3 - 0.1 * i);
    ExpectError([&] { Fit(source, line); }, "one point or on one line");
    FitParam param = Small();
    param.fitSteps = 10;
    const Shape triangle{{{0, 0, 0}, {9, 0, 0}, {0, 5, 0}}, {{0, 1, 2}}, {}};
    for (const Shape &flat : {Grid(12, 9), Points(Grid(12, 9)), triangle}) {
        const Fitted fitted = Fit(source, flat, param);
        EXPECT_TRUE(fitted.report.flat);
        EXPECT_NE(Joined(fitted.report.Remarks()).find("target is flat"), std::string::npos);
    }
    EXPECT_FALSE(Fit(Grid(40, 25), Grid(12, 9), param).report.flat) << "so is the source";
    EXPECT_EQ(Joined(Fit(source, target).report.Remarks()), "");
}

// Far apart, as in different coordinate systems: the surface is first moved there. If something is fixed, only a remark
// tells.
TEST(Fit, BeginsFromAfarByItself) {
    const Eigen::Affine3d shift(Eigen::Translation3d(300, -20, 100)),
        turn = shift * Eigen::AngleAxisd(1.6, Vector3d(1, 2, -1).normalized()),
        farthest(Eigen::Translation3d(4e6, -5e6, 0)); // as a survey's coordinates from a template's
    for (const Eigen::Affine3d &away : {shift, turn, farthest}) {
        const Fitted fitted = Fit(source, Moved(target, away));
        EXPECT_TRUE(fitted.report.fromAfar);
        EXPECT_GT(fitted.report.apart, 200);
        EXPECT_LT(Rms(fitted, Moved(truth, away)), 0.0063);
        EXPECT_NE(Joined(fitted.report.Remarks()).find("did not overlap"), std::string::npos);
    }
    EXPECT_FALSE(Fit(source, target).report.fromAfar);
    FitParam param = Small();
    param.fitSteps = 5;
    std::vector<int> tag(source.position.size(), 1);
    tag[0] = 0;
    const Fitted held = Fit(source, Moved(target, shift), param, tag);
    EXPECT_FALSE(held.report.fromAfar);
    EXPECT_NE(Joined(held.report.Remarks()).find("do not overlap"), std::string::npos);
    param.largestDistance = 1; // a limit: it is not moved
    EXPECT_EQ(Fit(source, Moved(target, shift), param).report.matched, 0);
}

// If layers overlap, but are turned or of another size, the strain of the fit shows it, and other starts are tried.
TEST(Fit, BeginsTurnedOrScaledByItself) {
    // On a graph so coarse, a rolled sheet is strained in the right place, too.
    const int around = sanitized ? 30 : 40;
    FitParam param = Small();
    param.samples = 600;
    param.fitSteps = 30;
    const auto bent = [](const Shape &shape) { return sanitized ? shape : Rolled(shape); };
    const Shape from = Lumpy(around), to = bent(Lumpy(around + 9)), belongs = bent(from);
    const Fitted straight = Fit(from, to, param);
    EXPECT_EQ(straight.report.turnedBy, 0);
    EXPECT_EQ(straight.report.scaledBy, 1);
    const Vector3d middle(0, 0, 0.2);
    for (const auto &[degrees, times] : Rounds<std::pair<double, double>>({{110, 0.7}, {0, 1.5}, {150, 1}})) {
        const Eigen::Affine3d away = Eigen::Translation3d(middle) * Eigen::Scaling(times) *
                                     Eigen::AngleAxisd(degrees * detail::pi / 180, Vector3d(1, 2, -1).normalized()) *
                                     Eigen::Translation3d(-middle);
        const Fitted fitted = Fit(from, Moved(to, away), param);
        EXPECT_LT(Rms(fitted, Moved(belongs, away)), 1.5 * times * Rms(straight, belongs)) << degrees;
        EXPECT_NEAR(fitted.report.scaledBy, times,
                    (sanitized ? 0.1 : 0.05) * times); // a coarse surface tells it less well
        EXPECT_EQ(fitted.report.turnedBy > 1, degrees > 1);
        const std::string said = Joined(fitted.report.Remarks());
        EXPECT_NE(said.find("strains it far less"), std::string::npos);
        EXPECT_EQ(said.find("scaled by") != std::string::npos, times != 1);
        EXPECT_EQ(said.find("turned by") != std::string::npos, degrees > 0);
        EXPECT_EQ(said.find("The scale is a guess"), std::string::npos) << "all of the surface tells it";
    }
}

/// A lumpy ball with a limb, which is bent along an arc of \p curvature times its length.
Shape OneLimbed(int around, double curvature) {
    Shape shape = Lumpy(around);
    for (Vector3d &p : shape.position) {
        p[2] *= 1 + 2.5 * std::exp(60 * (p.normalized()[2] - 1));
        const double start = 3, out = std::max(p[2] - start, 0.0), angle = curvature * out;
        if (curvature > 0 && out > 0)
            p = Vector3d((1 - (1 - curvature * p[0]) * std::cos(angle)) / curvature, p[1],
                         start + (1 - curvature * p[0]) * std::sin(angle) / curvature);
    }
    return shape;
}

// A bent limb draws the target's middle aside, and makes its radius smaller: neither tells where most of the surface
// belongs, nor how large it is. The fit does.
TEST(Fit, FindsTheScaleOfWhatIsBent) {
    if (sanitized)
        return; // the limb needs many samples
    const Shape from = OneLimbed(60, 0), to = OneLimbed(69, 0.16), belongs = OneLimbed(60, 0.16);
    const double straight = Rms(Fit(from, to), belongs);
    EXPECT_LT(straight, 0.014);
    const double times = 1.2; // which strains the surface by less than other starts need, if it is all of one size
    const Eigen::Affine3d larger(Eigen::Scaling(times));
    const Fitted fitted = Fit(from, Moved(to, larger));
    EXPECT_LT(Rms(fitted, Moved(belongs, larger)), 1.1 * times * straight);
    EXPECT_NEAR(fitted.report.scaledBy, times, 0.01 * times);
    const std::string said = Joined(fitted.report.Remarks());
    EXPECT_NE(said.find("scaled by"), std::string::npos);
    EXPECT_EQ(said.find("turned by"), std::string::npos);
}

namespace {

const Shape partly = Lumpy(30);

/// Fits it to a part of itself that is moved, by few samples.
Fitted FitToPart(const Eigen::Affine3d &move) {
    FitParam param = Small();
    param.samples = 800;
    param.fitSteps = 30;
    return Fit(partly, Moved(Above(Lumpy(37), 0.7, 1), move), param);
}

} // namespace

// Most of the surface has no counterpart, and keeps its size in the first fit. The rest tells the scale, step by step.
TEST(Fit, FindsTheScaleOfAPart) {
    if (sanitized)
        return; // it needs many samples
    const double times = 0.7;
    const Eigen::Affine3d smaller(Eigen::Scaling(times));
    const Fitted fitted = FitToPart(smaller);
    EXPECT_NEAR(fitted.report.scaledBy, times, 0.05 * times) << "and 1 where all of the surface tells it";
    EXPECT_LT(Rms(fitted, Moved(partly, smaller)), 0.016);
    EXPECT_NE(Joined(fitted.report.Remarks()).find("The scale is a guess: "), std::string::npos);
}

// Middle and axes of a part are not those of the whole: closest points tell how it is turned (FitTurns).
TEST(Fit, FindsHowAPartIsTurned) {
    if (sanitized)
        return; // it needs many samples
    const double turned = 2.2;
    const Eigen::Affine3d away(Eigen::AngleAxisd(turned, Vector3d(1, 2, -1).normalized()));
    const Fitted fitted = FitToPart(away);
    EXPECT_NEAR(fitted.report.turnedBy, turned, 0.1);
    EXPECT_LT(Rms(fitted, Moved(partly, away)), 0.016) << "and 0.43 by the axes alone";
}

// Each has what the other lacks.
TEST(Fit, FindsHowPartsOfEachOtherAreTurned) {
    if (sanitized)
        return; // it needs many samples
    const double turned = 2.2;
    const Eigen::Affine3d away(Eigen::AngleAxisd(turned, Vector3d(1, 2, -1).normalized()));
    FitParam param = Small();
    param.samples = 800;
    param.fitSteps = 30;
    const Shape part = Above(partly, -1.5, 0);
    const Fitted fitted = Fit(part, Moved(Above(Lumpy(37), -1, 1), away), param);
    EXPECT_NEAR(fitted.report.turnedBy, turned, 0.1);
    EXPECT_LT(Rms(fitted, Moved(part, away)), 0.03);
}

// The body tells, though the mean of all is turned and lies elsewhere.
TEST(Fit, AMotionOfMostIsThatOfTheBody) {
    const Shape body = Lumpy(20), limb = Ball(Vector3d(9, 0, 0), 1, 8);
    const Eigen::Affine3d turn = Eigen::Translation3d(1, -2, 3) * Eigen::Scaling(1.3) *
                                 Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()),
                          bend = turn * Eigen::AngleAxisd(1.5, Vector3d(0, 0.6, 0.8));
    Matrix3Xd before(3, Eigen::Index(body.position.size() + limb.position.size())), after = before;
    for (Eigen::Index i = 0; i < before.cols(); ++i) {
        const bool isBody = std::size_t(i) < body.position.size();
        before.col(i) = isBody ? body.position[std::size_t(i)] : limb.position[std::size_t(i) - body.position.size()];
        after.col(i) = (isBody ? turn : bend) * before.col(i);
    }
    EXPECT_LT((MotionOfMost(before, after, 1.3).matrix() - turn.matrix()).norm(), 0.05);
}

// A target that no start fits without strain.
TEST(Fit, TellsWhereAllIsStrained) {
    const Shape ball = Ball(Vector3d::Zero(), 1), rod = Moved(ball, Eigen::Affine3d(Eigen::Scaling(0.3, 0.3, 3.0)));
    const Fitted strained = Fit(rod, ball),
                 fitting = Fit(ball, Moved(ball, Eigen::Affine3d(Eigen::Scaling(1.0, 1.1, 1.0))));
    EXPECT_GT(strained.report.strained, 0.25);
    EXPECT_NE(Joined(strained.report.Remarks()).find("stretches and presses the surface by"), std::string::npos);
    EXPECT_EQ(fitting.report.strained, 0);
    EXPECT_EQ(Joined(fitting.report.Remarks()).find("stretches and presses"), std::string::npos);
}

TEST(Fit, TellsOtherUnitsAndMirrorImages) {
    FitParam param = Small();
    param.fitSteps = 5;
    for (double times : {1000.0, 25.4, 10.0, 0.001}) {
        Shape other = target;
        for (Vector3d &p : other.position)
            p *= times;
        const Fitted fitted = Fit(source, other, param);
        EXPECT_TRUE(fitted.report.otherSize) << times;
        EXPECT_NEAR(fitted.report.larger / times, 1, 0.1);
        EXPECT_NE(Joined(fitted.report.Remarks()).find(times > 1 ? "larger" : "smaller"), std::string::npos);
    }
    Shape hand = source, mirrored;
    for (Vector3d &p : hand.position) // no mirror image is like it
        p[2] += 0.02 * p[0] * p[0] * (p[1] - 3) + 0.1 * (p[1] - 3) * (p[1] - 3);
    mirrored = hand;
    for (Vector3d &p : mirrored.position)
        p[1] = 6 - p[1];
    for (auto &face : mirrored.face)
        std::swap(face[1], face[2]);
    EXPECT_TRUE(Fit(hand, mirrored, param).report.mirrored);
    EXPECT_FALSE(Fit(hand, hand, param).report.mirrored);
    EXPECT_FALSE(Fit(source, target, param).report.mirrored);
    for (Vector3d &p : hand.position) // much farther from its mirror images than bending brings it
        p[2] += p[1] < 3 ? 0.2 * p[0] : 0;
    Shape turnedOver = Rolled(hand, 0.02);
    for (auto &face : turnedOver.face)
        std::swap(face[1], face[2]);
    const FitReport notAtRest = Fit(hand, turnedOver, param).report;
    EXPECT_TRUE(notAtRest.insideOut);
    EXPECT_FALSE(notAtRest.converged);
    EXPECT_FALSE(notAtRest.mirrored);
}

/// Landmarks all over a sheet, with targets on the rolled one.
std::vector<Landmark> PairsOf(const Shape &shape, std::size_t count) {
    std::vector<Landmark> landmark;
    for (std::size_t l = 0; l < count; ++l) {
        const std::size_t i = (l * 617 + 31) % shape.position.size();
        landmark.push_back({i, Rolled(shape.position[i])});
    }
    return landmark;
}

// More landmarks than nodes: all come as near as the graph allows, and none is flung away.
TEST(Fit, ManyLandmarksAreMetAsNearlyAsTheGraphCan) {
    FitParam param = FitParam(Small()).LandmarksAlone();
    param.graph.initialPatches = 40;
    const auto follow = [&](const std::vector<Landmark> &landmark) {
        const MeshD mesh(source);
        const Arrays arrays = Read(mesh);
        Handles handles;
        handles.tag.assign(source.position.size(), 1);
        const Fitter fitter(arrays.View(), {}, handles, param);
        Fitted fitted{arrays.View().Copy(), {}};
        Carrier(fitter.Surface(), fitter.Solve(*fitter.TargetOf(landmark), landmark, fitted.report))
            .Apply(fitted.position);
        return fitted;
    };
    const std::vector<Landmark> dense = PairsOf(source, 500);
    const Fitted coarse = follow(dense);
    EXPECT_LT(Rms(coarse, truth), 0.005);
    EXPECT_GT(coarse.report.unmet, 0u);
    EXPECT_NE(Joined(coarse.report.Remarks()).find("too coarse"), std::string::npos);
    EXPECT_TRUE(coarse.report.contradicted.empty());
    EXPECT_LT(coarse.report.pull, 1);
    param.graph.initialPatches = 900;
    const Fitted fine = follow(dense);
    EXPECT_EQ(fine.report.unmet, 0u);
    EXPECT_LT(fine.report.landmarks, 1e-4);
}

TEST(Fit, PairsThatTheOthersContradictAreNamedAndLeftOut) {
    for (std::size_t count : {11u, 50u}) {
        std::vector<Landmark> landmark = PairsOf(source, count), swapped = landmark, displaced = landmark;
        std::swap(swapped[3].target, swapped[count - 2].target);
        displaced[5].target += Vector3d(1.5, 1, -1.5);
        FitParam param = Small();
        param.fitSteps = 20;
        param.samples = 400;
        EXPECT_TRUE(Fit(source, target, param, {}, landmark).report.contradicted.empty());
        for (const auto &[given, wrong] : {std::pair(swapped, std::vector<std::size_t>{3, count - 2}),
                                           std::pair(displaced, std::vector<std::size_t>{5})}) {
            param.landmarkTolerance = 0;
            const Fitted exact = Fit(source, target, param, {}, given);
            EXPECT_EQ(exact.report.contradicted, wrong) << count;
            EXPECT_TRUE(exact.report.landmarks < 1e-4 || exact.report.unmet > 0) << "they are exact, as asked for";
            EXPECT_LT((exact.position - PositionsOf(MeshD(truth))).colwise().norm().maxCoeff(), 12) << "all of it";
            EXPECT_NE(Joined(exact.report.Remarks()).find("landmark_tolerance"), std::string::npos);
            param.landmarkTolerance = 0.05;
            const Fitted without = Fit(source, target, param, {}, given);
            EXPECT_EQ(without.report.contradicted, wrong) << count;
            EXPECT_TRUE(without.report.leftOut);
            EXPECT_LE(without.report.landmarks, 0.05);
            EXPECT_LT(Rms(without, truth), 0.0063);
            EXPECT_NE(Joined(without.report.Remarks()).find("left out"), std::string::npos);
        }
    }
}

// A far-turned arm, led by the landmark at its end only: since the target confirms it, it is not contradicted.
TEST(Fit, APairThatLeadsALimbIsNotContradicted) {
    const Shape arms = Armed(70, 120, 0), turned = Armed(70, 120, 60);
    std::vector<Landmark> landmark;
    std::size_t tip = 0;
    for (std::size_t i = 0; i < arms.position.size(); ++i)
        if (arms.position[i][0] > arms.position[tip][0])
            tip = i;
    landmark.push_back({tip, turned.position[tip]});
    for (std::size_t i : {1000u, 2500u, 4000u, 5500u, 6500u, 7500u, 8200u, 1800u, 3300u})
        landmark.push_back({i, turned.position[i]});
    FitParam param = Small();
    param.landmarkTolerance = 0.02;
    const Fitted fitted = Fit(arms, Armed(61, 101, 60), param, {}, landmark);
    EXPECT_TRUE(fitted.report.contradicted.empty());
    EXPECT_LE(fitted.report.landmarks, 0.02);
}

TEST(Fit, TargetTellsItsBorderAndItsNormals) {
    const MeshD mesh(Grid(5, 5));
    const Arrays arrays = Read(mesh);
    const FitTarget plane(arrays.View(), {}, Eigen::Affine3d::Identity());
    const FitTarget::Match inside = plane.Nearest({1.3, 2.2, 0.5}), outside = plane.Nearest({-1, 2.2, 0.5});
    EXPECT_FALSE(inside.onBorder);
    EXPECT_TRUE(outside.onBorder);
    EXPECT_NEAR((inside.point - Vector3d(1.3, 2.2, 0)).norm(), 0, 1e-6);
    EXPECT_NEAR(std::abs(inside.normal[2]), 1, 1e-6);
    EXPECT_TRUE(inside.isOriented);
    const MeshD points(Points(Grid(5, 5)));
    const Arrays pointArrays = Read(points);
    const FitTarget cloud(pointArrays.View(), {}, Eigen::Affine3d::Identity());
    EXPECT_FALSE(cloud.Nearest({1.3, 2.2, 0.5}).isOriented);
    EXPECT_NEAR(std::abs(cloud.Nearest({1.3, 2.2, 0.5}).normal[2]), 1, 1e-6);
}

/// Points of a ball of radius 1, evenly spread (Fibonacci's lattice), those for which keeps(p) holds. \param noise
/// largest offset to each side
template <class Keeps>
Shape BallOfPoints(int count, double noise, const Keeps &keeps) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> offset(-noise, noise);
    Shape shape;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1) / double(count), r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
        const Vector3d p(r * std::cos(a), r * std::sin(a), z);
        if (keeps(p))
            shape.position.emplace_back(p + Vector3d(offset(random), offset(random), offset(random)));
    }
    return shape;
}

TEST(Fit, TargetTellsWhereACloudEnds) {
    const double spacing = std::sqrt(4 * EIGEN_PI / 4000);
    for (const double noise : {0., 0.25, 0.5}) {
        // Share of the places beside a ball, so many times its radius from its middle.
        const auto ends = [&](const auto &keeps, const auto &isAsked, const std::vector<double> &radii) {
            const MeshD points(BallOfPoints(4000, noise * spacing, keeps));
            const Arrays arrays = Read(points);
            FitTarget cloud(arrays.View(), {}, Eigen::Affine3d::Identity());
            int asked = 0, found = 0;
            for (const Vector3d &p : BallOfPoints(500, 0, isAsked).position)
                for (const double radius : radii) {
                    ++asked;
                    found += cloud.Nearest(radius * p).onBorder;
                }
            return double(found) / asked;
        };
        const auto all = [](const Vector3d &) { return true; };
        EXPECT_EQ(ends(all, all, {0.7, 0.85, 1.15, 1.3}), 0) << noise;
        const auto below = [](const Vector3d &p) { return p[0] < 0.2; };
        EXPECT_GT(ends(below, [](const Vector3d &p) { return p[0] > 0.6 && p[0] < 0.8; }, {0.9, 1, 1.1}),
                  noise < 0.5 ? 0.95 : 0.8)
            << noise;
        EXPECT_EQ(ends(below, [](const Vector3d &p) { return p[0] < 0; }, {0.7, 0.85, 1.15, 1.3}), 0) << noise;
    }
}

// The two sides of a fold, two spacings apart.
TEST(Fit, TargetTellsWhereAFoldedCloudEnds) {
    const int n = 40;
    Shape fold = Grid(n, n);
    for (int i = 0; i < n * n; ++i)
        fold.position.push_back(fold.position[std::size_t(i)] + Vector3d(0.5, 0.5, 2));
    fold = Jittered(fold, 0.1);
    fold.face.clear();
    const MeshD points(fold);
    const Arrays arrays = Read(points);
    const FitTarget cloud(arrays.View(), {}, Eigen::Affine3d::Identity());
    int asked = 0, found = 0;
    for (const double side : {0., 2.})
        for (double y = 5; y < 35; ++y) {
            for (const double beyond : {2., 4., 8.}) {
                ++asked;
                found += cloud.Nearest(Vector3d(n + beyond, y, side)).onBorder;
            }
            for (const double above : {-3., -1.5, 0.9})
                EXPECT_FALSE(cloud.Nearest(Vector3d(20.3, y, above)).onBorder) << y << " " << above;
        }
    EXPECT_GT(found, 2 * asked / 3);
}

// What is as thin as the points are apart has no plane in which it could end: a rod's tip draws what lies beyond it.
TEST(Fit, ACloudDoesNotEndAtTheTipOfARod) {
    Shape rod;
    for (int i = 0; i < 200; ++i)
        for (int k = 0; k < 8; ++k)
            rod.position.emplace_back(0.05 * i, 0.06 * std::cos(k * EIGEN_PI / 4), 0.06 * std::sin(k * EIGEN_PI / 4));
    const MeshD points(rod);
    const Arrays arrays = Read(points);
    FitTarget cloud(arrays.View(), {}, Eigen::Affine3d::Identity());
    cloud.reachesFarther = true;
    for (const double far : {0.2, 0.5, 1., 2.}) {
        EXPECT_FALSE(cloud.Nearest({-far, 0, 0}).onBorder);
        EXPECT_FALSE(cloud.Nearest({-far, 0.5 * far, 0}).onBorder);
    }
}

TEST(Fit, TargetNeedsItsArraysNoLongerThanItSays) {
    const MeshD mesh(Grid(5, 5)), points(Points(Grid(5, 5)));
    for (const MeshD *each : {&mesh, &points}) {
        auto arrays = std::make_unique<Arrays>(Read(*each));
        const FitTarget kept(arrays->View(), {}, Eigen::Affine3d::Identity());
        const FitTarget freed(arrays->View(), {}, Eigen::Affine3d::Identity(), {}, [&] { arrays = nullptr; });
        EXPECT_FALSE(arrays);
        for (const Vector3d &p : {Vector3d(1.3, 2.2, 0.5), Vector3d(-1, 2.2, 0.5)}) {
            EXPECT_EQ(freed.Nearest(p).point, kept.Nearest(p).point);
            EXPECT_EQ(freed.Nearest(p).normal, kept.Nearest(p).normal);
            EXPECT_EQ(freed.Nearest(p).onBorder, kept.Nearest(p).onBorder);
        }
    }
}

// The Gauss-Newton step against differences of the energy.
void ExpectStepsOfTheEnergy(double rigidity) {
    const MeshD mesh(BumpySheet(20, 12));
    const Arrays arrays = Read(mesh);
    Handles handles;
    handles.tag.assign(mesh.vert.size(), 1);
    FitParam param;
    param.graph.initialPatches = 12;
    const Fitter fitter(arrays.View(), {}, handles, param);
    const RegionDeformer &region = fitter.Surface().Whole();
    const RegionPose rest = fitter.Surface().Solve(handles, param).region[0];
    FitSamples samples;
    for (Index u : EvenSample(region, 100))
        samples.Add(region, rest, u);
    GraphPose pose = rest.solved;
    std::mt19937 random(5);
    for (Index j = 0; j < region.graph.Size(); ++j) {
        pose.position.col(j) += 0.03 * RandomVector(random);
        pose.linear[std::size_t(j)] = Eigen::AngleAxisd(0.2, RandomVector(random).normalized()).toRotationMatrix();
        if (rigidity < 1)
            pose.linear[std::size_t(j)] += 0.1 * Eigen::Matrix3d(RandomVector(random).asDiagonal());
    }
    std::vector<FitSystem::Pull> pull(samples.Size());
    std::vector<Vector3d> place;
    const Eigen::Matrix3d form = Eigen::Vector3d(1, 0.3, 0.1).asDiagonal();
    for (std::size_t s = 0; s < samples.Size(); ++s) {
        place.push_back(samples.At(s, pose) + 0.05 * RandomVector(random));
        pull[s].form = form / double(samples.Size());
        pull[s].gradient = pull[s].form * (samples.At(s, pose) - place[s]);
    }
    const double stiffness = 0.01, smoothness = 0.05, area = region.surface.area;
    const auto energy = [&](const GraphPose &at) {
        double sum = 0;
        for (std::size_t s = 0; s < samples.Size(); ++s) {
            const Vector3d way = samples.At(s, at) - place[s];
            sum += way.dot(pull[s].form * way);
        }
        for (Index i = 0; i < region.graph.Size(); ++i)
            for (std::uint32_t item = region.graph.graph.adjacency.begin[std::size_t(i)];
                 item < region.graph.graph.adjacency.begin[std::size_t(i) + 1]; ++item) {
                const Index j = region.graph.graph.adjacency.item[item];
                const Vector3d e =
                    (region.graph.graph.position.col(j) - region.graph.graph.position.col(i)).cast<double>();
                const double w = stiffness * double(region.graph.weight[item]) / area;
                sum += w * (at.position.col(i) + at.linear[std::size_t(i)] * e - at.position.col(j)).squaredNorm();
                sum +=
                    0.5 * w * smoothness * area * (at.linear[std::size_t(i)] - at.linear[std::size_t(j)]).squaredNorm();
                if (rigidity < 1)
                    sum += rigidity / (1 - rigidity) * w * e.squaredNorm() *
                           (at.linear[std::size_t(i)] - vcg::fcd::detail::RotationOf(at.linear[std::size_t(i)]))
                               .squaredNorm();
            }
        return sum;
    };
    std::vector<char> isFree(std::size_t(region.graph.Size()), 1);
    FitSystem system(region, isFree, samples, smoothness, rigidity);
    const std::vector<double> stiff(isFree.size(), stiffness);
    const auto step = system.Step(pose, pull, stiff);
    const auto moved = [&](double t) {
        GraphPose at = pose;
        FitSystem::Take(t * step, at);
        return energy(at);
    };
    const double t = 1e-5, slope = (moved(t) - moved(-t)) / (2 * t),
                 curve = (moved(t) - 2 * moved(0) + moved(-t)) / (t * t);
    EXPECT_LT(slope, 0);
    // Along the step, g^T x = -x^T H x. So the slope is -2 x^T H x, and the second difference is 2 x^T H x plus what
    // Gauss-Newton leaves out.
    EXPECT_NEAR(curve / -slope, 1, 0.3);
    EXPECT_LT(moved(1), 0.7 * moved(0));
    EXPECT_LT(system.Step(pose, pull, stiff).isApprox(step, 1e-3) ? 0 : 1, 1); // by the present factorisation
}

TEST(Fit, StepsAreThoseOfTheEnergy) {
    for (double rigidity : {1.0, 0.5, 0.0})
        ExpectStepsOfTheEnergy(rigidity);
}

// Sheared and stretched all over, like one skull to another.
Vector3d Sheared(const Vector3d &p) {
    return {1.2 * p[0] + 0.3 * p[1], 0.9 * p[1] - 0.2 * p[2], p[2] + 0.15 * p[0] + 0.1 * p[1]};
}

TEST(Fit, WithoutRigidityWhatIsShearedAllOverIsFound) {
    Shape sheared = source;
    for (Vector3d &p : sheared.position)
        p = Sheared(p);
    const MeshD from(source);
    const Arrays arrays = Read(from);
    Handles handles;
    handles.tag.assign(source.position.size(), 1);
    std::vector<Landmark> landmark;
    for (std::size_t i = 17; i < source.position.size(); i += 90)
        landmark.push_back({i, sheared.position[i]});
    const auto led = [&](double rigidity) {
        FitParam param = Small().LandmarksAlone();
        param.fitRigidity = rigidity;
        const Fitter fitter(arrays.View(), {}, handles, param);
        Fitted fitted;
        const Deformer::Pose pose = fitter.Solve(*fitter.TargetOf(landmark), landmark, fitted.report);
        fitted.position = arrays.View().Copy();
        Carrier(fitter.Surface(), pose).Apply(fitted.position);
        EXPECT_TRUE(fitted.report.converged) << rigidity;
        EXPECT_EQ(Joined(fitted.report.Remarks()), "") << rigidity;
        return Rms(fitted, sheared);
    };
    const double rigid = led(1), half = led(0.5), smooth = led(0);
    EXPECT_LT(smooth, 1e-4); // every affine map is free
    EXPECT_LT(half, rigid);
    EXPECT_GT(rigid, 20 * smooth);

    // Onto a target: its samples show the shear, except for slides along itself.
    Shape goal = BumpySheet(57, 33);
    for (Vector3d &p : goal.position)
        p = Sheared(p);
    FitParam param = Small();
    const double before = Rms(Fit(source, goal, param, {}, landmark), sheared);
    param.fitRigidity = 0;
    const Fitted after = Fit(source, goal, param, {}, landmark), again = Fit(source, goal, param, {}, landmark, {}, 3);
    EXPECT_LT(Rms(after, sheared), 0.5 * before);
    EXPECT_TRUE(IsSame(after, again)); // by any number of threads

    for (double wrong : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
        param.fitRigidity = wrong;
        ExpectError([&] { Fit(source, target, param); }, "The rigidity must be from 0");
    }
}

TEST(FitLandmarks, ManyMoveTheNodesAsFewDo) {
    // Against the pseudo-inverse, for more places than nodes and for fewer.
    const Index nodes = 1500;
    for (const std::size_t places : {std::size_t(2000), std::size_t(800)}) {
        std::mt19937 random(7);
        FitSamples samples;
        GraphPose pose;
        pose.position = Matrix3Xd::Random(3, nodes);
        pose.linear.assign(std::size_t(nodes), Eigen::Matrix3d::Identity());
        Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(Eigen::Index(places), nodes);
        std::vector<Vector3d> place;
        Eigen::MatrixXd off(Eigen::Index(places), 3);
        for (std::size_t s = 0; s < places; ++s) {
            samples.surfaceNode.push_back(Index(s));
            const Index first = Index(s * std::size_t(nodes - 8) / places);
            for (Index k = 0; k < 8; ++k)
                weight(Eigen::Index(s), first + k) =
                    k == 0 ? 0.6 : 0.4 / 7 * (1 + 0.5 * std::sin(double(random() % 7)));
            for (Index k = 0; k < 8; ++k)
                samples.term.push_back({first + k, weight(Eigen::Index(s), first + k), Vector3d::Zero()});
            samples.begin.push_back(std::uint32_t(samples.term.size()));
            samples.fixed.push_back(Vector3d::Zero());
            off.row(Eigen::Index(s)) = 0.1 * RandomVector(random).transpose();
        }
        for (std::size_t s = 0; s < places; ++s)
            place.push_back(samples.At(s, pose) + off.row(Eigen::Index(s)).transpose());
        const Matrix3Xd expected = pose.position + weight.completeOrthogonalDecomposition().solve(off).transpose();
        CallbackLog log(3);
        GraphPose again = pose;
        const std::vector<char> isFree(std::size_t(nodes), 1);
        EXPECT_THROW(MoveOnto(samples, 0, place, isFree, again, log.Progress()), Cancelled);
        MoveOnto(samples, 0, place, isFree, pose);
        EXPECT_LE((pose.position - expected).colwise().norm().maxCoeff(), 1e-6) << places;
    }
}
