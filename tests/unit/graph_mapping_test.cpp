// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/graph_mapping.h>
#include <vcg_ext/solve/graph_deformer.h>
#include <vcg_ext/map/mapping_kernel_variants.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

using Motions = std::map<Index, Affine3d>; // of each tag, in the frame

static const MappingWeights both[] = {MappingWeights::Surface, MappingWeights::Euclidean};

/// The mapped nodes of the surface.
static Matrix3Xd Mapped(const Rig &rig, MappingWeights weights, const GraphPose &pose, const Motions &motion,
                        double influence = 3.5) {
    const GraphMapping mapping(rig.surface.graph, rig.tag, rig.patches, rig.graph, weights, influence,
                               rig.param.targetRadius);
    const auto map = mapping.At(pose, motion);
    Matrix3Xd result(3, rig.surface.graph.Size());
    for (Index u = 0; u < rig.surface.graph.Size(); ++u)
        result.col(u) = map(u, rig.surface.graph.position.col(u).cast<double>());
    return result;
}

static GraphPose Solved(const Rig &rig, const Motions &motion) {
    std::vector<Affine3d> nodeMotion;
    for (Index c : rig.patches.center)
        nodeMotion.push_back(rig.tag[c] == 1 ? Affine3d::Identity() : motion.at(rig.tag[c]));
    return GraphDeformer(rig.graph, rig.constrained, rig.surface.area).Solve(nodeMotion, {});
}

/// Every node of the graph makes the same motion.
static GraphPose PoseOf(const Rig &rig, const Affine3d &motion) {
    GraphPose pose;
    pose.position = motion * rig.graph.graph.position.cast<double>();
    pose.linear.assign(rig.graph.Size(), motion.linear());
    return pose;
}

static Matrix3Xd Rest(const Rig &rig) { return rig.surface.graph.position.cast<double>(); }

static Rig RoundTubeRig() {
    return Rig(Jittered(Tube(40, 16), 0.02), 0.6, [](const Vector3d &p) { return TubeTag(p); });
}

static Motions Bend() {
    Affine3d bend(Eigen::AngleAxisd(1, Vector3d(1, 0.2, 0).normalized()));
    bend.translation() = Vector3d(0.1, 0.2, 0);
    return {{0, Affine3d::Identity()}, {2, bend}};
}

TEST(GraphMapping, HeldNodesAreExact) {
    const Rig rig = RoundTubeRig();
    const Motions motion = Bend();
    const GraphPose pose = Solved(rig, motion);
    for (MappingWeights weights : both) {
        const Matrix3Xd mapped = Mapped(rig, weights, pose, motion), rest = Rest(rig);
        EXPECT_TRUE(mapped.allFinite());
        for (Index u = 0; u < rig.surface.graph.Size(); ++u)
            if (rig.tag[u] != 1) {
                EXPECT_EQ(mapped.col(u), motion.at(rig.tag[u]) * Vector3d(rest.col(u)));
            }
    }
}

TEST(GraphMapping, ReproducesTheIdentityAndRigidMotions) {
    std::vector<Rig> rigs{RoundTubeRig()};
    for (const Shape &shape : {Grid(30, 30), Fan(50), PointCloud(300), Triangle(), TwoSheets(10, 0.3)})
        rigs.emplace_back(shape, 0.25, [](const Vector3d &p) { return p[0] < 0.3 ? 0 : p[0] > 0.8 ? 2 : 1; });
    for (const Rig &rig : rigs)
        for (MappingWeights weights : both)
            for (double influence : {1.01, 3.5, 20.0})
                for (unsigned seed = 0; seed < 3; ++seed) {
                    const Affine3d rigid = seed ? RandomRigid(seed) : Affine3d::Identity();
                    const Matrix3Xd mapped =
                        Mapped(rig, weights, PoseOf(rig, rigid), {{0, rigid}, {2, rigid}}, influence);
                    ASSERT_TRUE(mapped.allFinite());
                    EXPECT_LE((mapped - rigid * Rest(rig)).cwiseAbs().maxCoeff(), 1e-9);
                }
}

TEST(GraphMapping, IsFiniteWhereBallsAreTiny) {
    Shape isolated = Join(Grid(4, 4), Points(Moved(Grid(2, 2), Affine3d(Eigen::Translation3d(9, 0, 0)))));
    Shape speck =
        Join(Grid(4, 4), Moved(Triangle(), Affine3d(Eigen::Translation3d(1.5, 1.5, 0) * Eigen::Scaling(1e-25))));
    for (const Shape &shape : {isolated, speck, Triangle()})
        for (MappingWeights weights : both)
            for (double influence : {std::nextafter(1.0, 2.0), 3.5}) {
                const Rig rig(shape, 2, [](const Vector3d &) { return 1; });
                const Affine3d rigid = RandomRigid(1);
                const Matrix3Xd mapped = Mapped(rig, weights, PoseOf(rig, rigid), {}, influence);
                ASSERT_TRUE(mapped.allFinite());
                EXPECT_LE((mapped - rigid * Rest(rig)).cwiseAbs().maxCoeff(), 1e-9);
            }
}

TEST(GraphMapping, IsContinuous) {
    // The same patch radius on a finer grid: differences of neighbours shrink with the edges.
    auto largestJump = [](int n, MappingWeights weights) {
        const Rig rig(Grid(n, n, 8.0 / (n - 1)), 1, [](const Vector3d &p) { return p[0] < 1 ? 0 : p[0] > 7 ? 2 : 1; });
        const Motions motion = Bend();
        const Matrix3Xd mapped = Mapped(rig, weights, Solved(rig, motion), motion), rest = Rest(rig);
        double largest = 0;
        for (const auto &e : EdgesOf(rig.surface.graph.adjacency))
            largest = std::max(largest, (mapped.col(e.first) - mapped.col(e.second)).norm());
        return largest;
    };
    for (MappingWeights weights : both) {
        const double coarse = largestJump(33, weights), fine = largestJump(129, weights);
        EXPECT_LT(fine, 0.45 * coarse) << "a jump would stay as it is, a slope goes down to a quarter";
    }
}

TEST(GraphMapping, AlongTheSurfaceAnotherSheetDoesNotPull) {
    const int n = 30;
    // Two parallel sheets, the upper one's middle moved: only it may follow.
    const Rig rig(TwoSheets(n, 0.3), 3, [](const Vector3d &p) {
        const bool middle = std::hypot(p[0] - 14.5, p[1] - 14.5) < 4;
        return p[2] > 0.15 ? (middle ? 2 : 1) : (p[0] < 1.5 ? 0 : 1);
    });
    const Motions motion{{0, Affine3d::Identity()}, {2, Affine3d(Eigen::Translation3d(0, 0, 0.2))}};
    const GraphPose pose = Solved(rig, motion);
    const Matrix3Xd rest = Rest(rig);
    auto lowerSheetMoves = [&](MappingWeights weights) {
        const Matrix3Xd mapped = Mapped(rig, weights, pose, motion);
        double most = 0;
        for (Index u = 0; u < rig.surface.graph.Size(); ++u)
            if (rest(2, u) < 0)
                most = std::max(most, (mapped.col(u) - rest.col(u)).norm());
        return most;
    };
    EXPECT_LE(lowerSheetMoves(MappingWeights::Surface), 1e-8);
    EXPECT_GT(lowerSheetMoves(MappingWeights::Euclidean), 0.02);
}

/// A sheet with a fold like that of a cortex: two banks 0.2 apart and 3 deep, a half-circle at the bottom. The flat
/// sheet's first coordinate, 0 at the bottom, becomes the arc length.
static Shape Folded(const Shape &flat) {
    Shape shape = flat;
    const double radius = 0.1, bottom = radius * std::acos(-1.0) / 2;
    for (Vector3d &p : shape.position) {
        const double s = p[0], angle = std::min(bottom, std::max(-bottom, s)) / radius;
        p[0] = radius * std::sin(angle);
        p[2] = radius * (1 - std::cos(angle)) + std::max(0.0, std::abs(s) - bottom);
    }
    return shape;
}

TEST(GraphMapping, AlongTheSurfaceAFoldKeepsItsBanksApart) {
    struct Worst {
        double error = 0; // above the patches that reach around the bottom
        double jump = 0;  // between neighbours
    };
    const auto worst = [](int n, MappingWeights weights) {
        const double step = 6.0 / (n - 1);
        const Shape flat = Jittered(Moved(Grid(n, n / 2, step), Affine3d(Eigen::Translation3d(-3, 0, 0))), 0.2 * step);
        const Rig rig(Folded(flat), 0.3, [](const Vector3d &) { return 1; });
        // A motion that depends on the place along the sheet.
        const auto shift = [](double s) { return Vector3d(0, 0.5 * std::tanh(s), 0); };
        std::vector<double> along(rig.surface.graph.Size());
        for (int i = 0; i < flat.Size(); ++i)
            along[rig.surface.nodeOf[i]] = flat.position[i][0];
        GraphPose pose = PoseOf(rig, Affine3d::Identity());
        for (Index j = 0; j < rig.graph.Size(); ++j)
            pose.position.col(j) += shift(along[rig.patches.center[j]]);
        const Matrix3Xd moved = Mapped(rig, weights, pose, {}, 4) - Rest(rig);
        Worst found;
        for (Index u = 0; u < rig.surface.graph.Size(); ++u)
            if (std::abs(along[u]) > 1.2)
                found.error = std::max(found.error, (moved.col(u) - shift(along[u])).norm());
        for (const auto &e : EdgesOf(rig.surface.graph.adjacency))
            found.jump = std::max(found.jump, (moved.col(e.first) - moved.col(e.second)).norm());
        return found;
    };
    const Worst coarse = worst(121, MappingWeights::Surface), fine = worst(361, MappingWeights::Surface);
    EXPECT_LE(coarse.error, 0.04);
    EXPECT_LE(fine.error, 0.04);
    EXPECT_LE(fine.jump, 0.5 * coarse.jump) << "a jump would stay as it is, a slope goes down to a third";
    EXPECT_GE(worst(121, MappingWeights::Euclidean).error, 0.3);
}

TEST(GraphMapping, RunsSmoothlyIntoHeldRegions) {
    // The free nodes next to a held region depart from the region's own motion with the square of their distance.
    auto departure = [](int n) {
        const Rig rig(Grid(n, n, 8.0 / (n - 1)), 1, [](const Vector3d &p) { return p[0] < 1 ? 0 : p[0] > 7 ? 2 : 1; });
        const Motions motion = Bend();
        const Matrix3Xd mapped = Mapped(rig, MappingWeights::Surface, Solved(rig, motion), motion), rest = Rest(rig);
        double most = 0;
        for (const auto &e : EdgesOf(rig.surface.graph.adjacency))
            for (const auto &[held, free] : {e, std::make_pair(e.second, e.first)})
                if (rig.tag[held] != 1 && rig.tag[free] == 1) {
                    const Vector3d own = motion.at(rig.tag[held]) * Vector3d(rest.col(free));
                    most = std::max(most, (mapped.col(free) - own).norm() / rig.param.targetRadius);
                }
        return most;
    };
    const int finer = sanitized ? 2 : 4;
    const double coarse = departure(129), fine = departure(128 * finer + 1);
    EXPECT_LE(coarse, 0.03);
    EXPECT_LE(fine, coarse / std::pow(finer, 1.5)) << "a crease would go down by no more than " << finer;
}

/// Every node of the graph is a patch of its own, with this radius.
static Patches NodesAsPatches(Index k, float radius) {
    Patches patches;
    for (Index i = 0; i < k; ++i) {
        patches.patchOf.push_back(i);
        patches.center.push_back(i);
    }
    patches.radius.assign(k, radius);
    patches.tag.assign(k, 1);
    return patches;
}

static DeformationGraph GraphOf(const Graph &graph, const Patches &patches) {
    return {graph, std::vector<float>(graph.adjacency.item.size(), 1), patches.radius, {}, {}, {}};
}

TEST(GraphMapping, ABallThatTouchesTooManyPatchesIsHalvedUntilItDoesNot) {
    const Index n = 128, k = n * n;
    const int most = (1 << 22) / k, full = 10; // a ball of radius 10 touches more than that, but not at the corners
    EdgeSet edges;
    Graph grid;
    grid.position.resize(3, k);
    for (Index i = 0; i < k; ++i) {
        grid.position.col(i) << float(i % n), float(i / n), 0;
        if (i % n > 0)
            Insert(edges, i, i - 1);
        if (i >= n)
            Insert(edges, i, i - n);
    }
    grid.adjacency = CsrOf(k, edges);
    const float radius = 0.5;
    const Patches patches = NodesAsPatches(k, radius);
    const DeformationGraph graph = GraphOf(grid, patches);
    GraphPose pose;
    pose.position = grid.position.cast<double>();
    pose.linear.assign(k, Eigen::Matrix3d::Identity());
    std::mt19937 random(1);
    for (Index i = 0; i < k; ++i)
        pose.position.col(i) += RandomVector(random);
    const Motions none;
    const GraphMapping mapping(grid, patches.tag, patches, graph, MappingWeights::Surface, full / radius, 1);
    const auto map = mapping.At(pose, none);

    // All is connected without detours: only the distance matters.
    const auto around = [&](Index i, const auto &visit) { // visit(node, squared distance)
        for (Index y = std::max(0, i / n - full); y <= std::min(n - 1, i / n + full); ++y)
            for (Index x = std::max(0, i % n - full); x <= std::min(n - 1, i % n + full); ++x)
                visit(y * n + x, double((x - i % n) * (x - i % n) + (y - i / n) * (y - i / n)));
    };
    const auto touchedBy = [&](Index j, double within) { // nodes within that distance, row by row
        int touched = 0;
        for (Index y = std::max(0, j / n - full); y <= std::min(n - 1, j / n + full); ++y) {
            const double squared = within * within - double((y - j / n) * (y - j / n));
            const Index beside = squared > 0 ? Index(std::ceil(std::sqrt(squared))) - 1 : -1;
            touched += std::max(0, std::min(n - 1, j % n + beside) - std::max(0, j % n - beside) + 1);
        }
        return touched;
    };
    std::vector<double> reach(k, full);
    int halved = 0;
    for (Index j = 0; j < k; ++j) {
        int touched = 0;
        do {
            reach[j] /= touched ? 2 : 1;
            touched = touchedBy(j, reach[j] + radius);
        } while (touched > most);
        halved += reach[j] == full / 2;
        ASSERT_GE(reach[j], full / 2);
    }
    EXPECT_TRUE(halved > k / 2 && halved < k);
    for (Index i = 0; i < k; i += sanitized ? 211 : 11) {
        Vector3d shift = Vector3d::Zero();
        double total = 0;
        around(i, [&](Index j, double squared) {
            const double u = std::max(0.0, 1 - squared / (reach[j] * reach[j]));
            shift += u * u * u * (pose.position.col(j) - grid.position.col(j).cast<double>());
            total += u * u * u;
        });
        const Vector3d p = grid.position.col(i).cast<double>();
        ASSERT_LE((map(i, p) - p - shift / total).norm(), 1e-5) << "node " << i;
    }
}

TEST(GraphMapping, EndsWhereTheMiddleOfAStarHasVeryManyNeighbours) {
    const Index k = 70000; // so many that a ball may touch 64 patches
    Graph star;
    EdgeSet edges;
    star.position.setZero(3, k);
    for (Index i = 1; i < k; ++i) {
        Insert(edges, 0, i);
        star.position.col(i) << std::cos(float(i)), std::sin(float(i)), 0;
    }
    star.adjacency = CsrOf(k, edges);
    GraphPose pose;
    pose.position = star.position.cast<double>();
    pose.linear.assign(k, Eigen::Matrix3d::Identity());
    const Motions none;
    for (float radius :
         Rounds({0.27f, 2.f})) { // balls touch the middle and more than 64, halved once only some; or all patches
        const Patches patches = NodesAsPatches(k, radius);
        const DeformationGraph graph = GraphOf(star, patches);
        const GraphMapping mapping(star, patches.tag, patches, graph, MappingWeights::Surface, 4, 1);
        const auto map = mapping.At(pose, none);
        for (Index i = 0; i < k; ++i)
            ASSERT_LE((map(i, pose.position.col(i)) - pose.position.col(i)).norm(), 1e-6);
    }
}

// A blend of one candidate, and of many, some with a share of their weight.
struct BlendRig {
    static constexpr std::size_t n = 9, whole = 4, m = 3;
    std::vector<detail::Ball> ball, shareBall;
    std::vector<float> share = std::vector<float>((n - whole) * m);
    float term[n][detail::terms], weight[n][detail::lanes], shareWeight[m][detail::lanes];
    std::uint32_t active[n], shareActive[m];
    detail::Blending blending;

    BlendRig() {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> number(0, 1);
        const auto ballHere = [&] { return detail::Ball{{number(random), number(random), number(random)}, 1.5f, 0}; };
        for (std::size_t c = 0; c < n; ++c) {
            ball.push_back(ballHere());
            for (float &t : term[c])
                t = number(random) - 0.5f;
            term[c][detail::terms - 1] = 1;
        }
        for (std::size_t q = 0; q < m; ++q)
            shareBall.push_back(ballHere());
        for (detail::Ball *far : {&ball[1], &ball[6], &shareBall[1]}) // from all vertices
            far->center[2] = 9;
        for (float &s : share)
            s = number(random);
        for (int l = 0; l < detail::lanes; ++l)
            for (int d = 0; d < 3; ++d)
                blending.x[d][l] = 1.5f * number(random);
        blending.ball = ball.data();
        blending.term = term;
        blending.n = n;
        blending.whole = whole;
        blending.shareBall = shareBall.data();
        blending.share = share.data();
        blending.m = m;
        blending.weight = weight;
        blending.shareWeight = shareWeight;
        blending.active = active;
        blending.shareActive = shareActive;
    }
};

TEST(GraphMapping, WeightsFallFromOneToZero) {
    const detail::Ball ball[2] = {{{0, 5, 0}, 1, 0}, {{0, 0, 0}, 1, 0}};
    float x[3][detail::lanes] = {}, weight[2][detail::lanes];
    std::uint32_t active[2];
    for (int l = 0; l < detail::lanes; ++l)
        x[1][l] = float(l) / (detail::lanes - 1);
    ASSERT_EQ(detail::plain::WeighBalls(x, ball, 0, 2, weight, active, 0), 1u); // the other does not reach them
    EXPECT_EQ(active[0], 1u);
    EXPECT_EQ(weight[0][0], 1);
    EXPECT_EQ(weight[0][detail::lanes - 1], 0);
    for (int l = 1; l < detail::lanes; ++l)
        EXPECT_LT(weight[0][l], weight[0][l - 1]);
}

TEST(GraphMapping, BlendsAsWrittenDown) {
    BlendRig rig;
    detail::Blend(rig.blending);
    const auto weigh = [&](const detail::Ball &ball, int l) {
        double square = 0;
        for (int d = 0; d < 3; ++d)
            square += std::pow(double(ball.center[d]) - rig.blending.x[d][l], 2);
        return std::pow(std::max(0.0, 1 - square * ball.inverse), 3);
    };
    int shared = 0;
    for (int l = 0; l < detail::lanes; ++l) {
        double sum[detail::terms] = {};
        for (std::size_t c = 0; c < rig.n; ++c) {
            double w = weigh(rig.ball[c], l), kept = 0, total = 0;
            for (std::size_t q = 0; q < rig.m && c >= rig.whole; ++q) {
                total += weigh(rig.shareBall[q], l);
                kept += weigh(rig.shareBall[q], l) * rig.share[(c - rig.whole) * rig.m + q];
            }
            w *= total > 0 ? kept / total : 1;
            shared += total > 0;
            for (int t = 0; t < detail::terms; ++t)
                sum[t] += w * rig.term[c][t];
        }
        for (int t = 0; t < detail::terms; ++t)
            EXPECT_NEAR(rig.blending.sum[t][l], sum[t], 1e-5);
    }
    EXPECT_GT(shared, 0);
    EXPECT_GT(rig.blending.used, 0u);
    EXPECT_LT(rig.blending.used, rig.n);
    for (std::size_t a = 0, c = 0; a < rig.blending.used; ++a, ++c) // those that are left out reach no vertex
        for (; c < rig.blending.active[a]; ++c)
            for (int l = 0; l < detail::lanes; ++l)
                EXPECT_EQ(weigh(rig.ball[c], l), 0);
}

TEST(GraphMapping, BlendsToTheSameBitsOnAnyProcessor) {
    BlendRig rig, plain;
    detail::Blend(rig.blending);
    detail::plain::Blend(plain.blending);
    EXPECT_EQ(std::memcmp(rig.blending.sum, plain.blending.sum, sizeof(plain.blending.sum)), 0);
}

TEST(GraphMapping, CanBeCancelledAnywhere) {
    const Rig rig = RoundTubeRig();
    auto prepare = [&](const CallbackLog &log) {
        GraphMapping(rig.surface.graph, rig.tag, rig.patches, rig.graph, MappingWeights::Surface, 3.5,
                     rig.param.targetRadius, log.Progress(1));
    };
    CallbackLog all;
    prepare(all);
    EXPECT_TRUE(std::is_sorted(all.percent.begin(), all.percent.end()));
    const std::size_t calls = all.percent.size();
    ASSERT_GT(calls, 0u);
    for (std::size_t i = 0; i < calls; ++i) {
        CallbackLog log(i);
        EXPECT_THROW(prepare(log), Cancelled);
    }
}

TEST(GraphMapping, InfluencesAreTheWeightsOfTheBlend) {
    const Rig rig = RoundTubeRig();
    Motions motion = Bend();
    motion[2] = Eigen::Translation3d(0, 0, 1);
    for (const bool printed : {false, true}) {
        const BeyondPaper beyond(printed ? GraphWeights::Printed : GraphWeights::Border);
        const GraphMapping mapping(rig.surface.graph, rig.tag, rig.patches, rig.graph, MappingWeights::Surface, 3.5,
                                   rig.param.targetRadius, {}, {}, beyond);
        // Each node moves, and none turns or stretches: then the result is linear in the weights.
        GraphPose pose = PoseOf(rig, Affine3d::Identity());
        for (Index j = 0; j < rig.graph.Size(); ++j)
            pose.position.col(j) += Vector3d(std::sin(j), std::cos(3 * j), 0.1 * (j % 7));
        const auto map = mapping.At(pose, motion);
        GraphMapping::Influences influences;
        std::size_t runInto = 0;
        for (Index u = 0; u < rig.surface.graph.Size(); ++u) {
            if (rig.tag[u] != 1)
                continue;
            mapping.InfluencesAt(u, influences);
            const Vector3d p = rig.surface.graph.position.col(u).cast<double>();
            Vector3d expected = p;
            double sum = 0;
            for (const auto &[j, weight] : influences.nodes) {
                EXPECT_GT(weight, 0);
                expected += double(weight) * (pose.position.col(j) - rig.graph.graph.position.col(j).cast<double>());
                sum += double(weight);
            }
            for (const auto &[tag, weight] : influences.held) {
                expected += double(weight) * (motion.at(tag) * p - p);
                sum += double(weight);
            }
            runInto += !influences.held.empty();
            ASSERT_NEAR(sum, 1, 1e-6);
            ASSERT_LE((map(u, p) - expected).norm(), 1e-5);
        }
        EXPECT_EQ(runInto > 0, !printed);
    }
}

TEST(GraphMapping, FewOfManyRegionsNearbyHaveAnInfluence) {
    // Every ninth node is a handle of its own.
    const int n = sanitized ? 40 : 90;
    const Rig rig(Jittered(Grid(n, n, 8.0 / (n - 1)), 0.02), 1, [&](const Vector3d &p) {
        const int i = int(std::lround(p[0] * (n - 1) / 8)), j = int(std::lround(p[1] * (n - 1) / 8));
        return i % 3 == 1 && j % 3 == 1 ? 2 + i * n + j : 1;
    });
    GraphPose pose = PoseOf(rig, Affine3d::Identity());
    const GraphMapping mapping(rig.surface.graph, rig.tag, rig.patches, rig.graph, MappingWeights::Surface, 3.5,
                               rig.param.targetRadius);
    GraphMapping::Influences influences;
    std::size_t most = 0, nearest = 0, free = 0;
    for (Index u = 0; u < rig.surface.graph.Size(); ++u) {
        if (rig.tag[u] != 1)
            continue;
        mapping.InfluencesAt(u, influences);
        most = std::max(most, influences.held.size());
        ++free;
        const auto largest = std::max_element(influences.held.begin(), influences.held.end(),
                                              [](const auto &a, const auto &b) { return a.second < b.second; });
        if (largest == influences.held.end())
            continue;
        double least = 1e9;
        Index tag = 1;
        for (Index v = 0; v < rig.surface.graph.Size(); ++v)
            if (const double d = (rig.surface.graph.position.col(v) - rig.surface.graph.position.col(u)).norm();
                rig.tag[v] != 1 && d < least) {
                least = d;
                tag = rig.tag[v];
            }
        nearest += largest->first == tag;
    }
    EXPECT_LE(most, 8u);
    EXPECT_GE(most, 6u);
    EXPECT_GT(nearest, 9 * free / 10);
}
