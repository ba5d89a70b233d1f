// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/contrasting_colors.h>
#include <vcg_ext/graph/border_weights.h>
#include "test_support.h"

#include <map>

using namespace vcg::fcd;
using namespace fcd_test;

static Rig RigOf(const Shape &shape, double radius = 1) {
    return Rig(shape, radius, [](const Eigen::Vector3d &) { return 1; });
}

static const std::vector<Shape> &Shapes() {
    static const std::vector<Shape> shapes{Triangle(),       Grid(20, 15),       Tube(20, 12),        Sphere(12, 20),
                                           Fan(100),         TwoSheets(10, 0.2), UnweldedGrid(12, 9), PointCloud(300),
                                           Wireframe(12, 9), Points(Grid(2, 1))};
    return shapes;
}

TEST(DeformationGraph, JoinsThePatchesThatTouch) {
    for (const Shape &shape : Shapes()) {
        const Rig rig = RigOf(shape);
        EdgeSet expected;
        for (const auto &e : EdgesOf(rig.surface.graph.adjacency))
            Insert(expected, rig.patches.patchOf[e.first], rig.patches.patchOf[e.second]);
        ASSERT_EQ(rig.graph.Size(), rig.patches.Size());
        ExpectAdjacencyInOrder(rig.graph.graph.adjacency);
        EXPECT_EQ(EdgesOf(rig.graph.graph.adjacency), expected);
    }
}

TEST(DeformationGraph, NodesAreThePatchesBarycentres) {
    const Rig rig(Jittered(Tube(40, 24), 0.02), 0.8, [](const Eigen::Vector3d &p) { return TubeTag(p); });
    EXPECT_EQ(rig.graph.radius, rig.patches.radius);
    ASSERT_EQ(Index(rig.graph.held.size()), rig.graph.Size());
    int held = 0;
    for (Index j = 0; j < rig.graph.Size(); ++j) {
        const Eigen::Vector3f at = rig.graph.graph.position.col(j);
        EXPECT_EQ(rig.graph.IsHeld(j), rig.patches.tag[j] != 1);
        if (rig.graph.IsHeld(j)) {
            ++held;
            EXPECT_EQ(at, rig.surface.graph.position.col(rig.patches.center[j]));
            continue;
        }
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double area = 0;
        for (Index u = 0; u < rig.surface.graph.Size(); ++u)
            if (rig.patches.patchOf[u] == j) {
                sum += rig.surface.nodeArea[u] * rig.surface.graph.position.col(u).cast<double>();
                area += rig.surface.nodeArea[u];
            }
        EXPECT_LE((at.cast<double>() - sum / area).norm(), 1e-6);
    }
    EXPECT_GT(held, 3);
}

TEST(DeformationGraph, NodesOfPatchesWithoutAreaAreTheirCentres) {
    const Rig rig = RigOf(Wireframe(12, 9), 3);
    EXPECT_GT(rig.graph.Size(), 1);
    for (Index j = 0; j < rig.graph.Size(); ++j)
        EXPECT_EQ(rig.graph.graph.position.col(j), rig.surface.graph.position.col(rig.patches.center[j]));
}

TEST(DeformationGraph, HasTheMeshsComponents) {
    for (const Shape &shape : Shapes()) {
        const Rig rig = RigOf(shape);
        std::vector<Index> meshComponent, component;
        const Index count = ConnectedComponents(rig.surface.graph.adjacency, meshComponent);
        EXPECT_EQ(ConnectedComponents(rig.graph.graph.adjacency, component), count);
        std::set<std::pair<Index, Index>> pairs;
        for (Index u = 0; u < rig.surface.graph.Size(); ++u)
            pairs.emplace(meshComponent[u], component[rig.patches.patchOf[u]]);
        EXPECT_EQ(Index(pairs.size()), count);
    }
}

static std::uint32_t ItemOf(const Csr &adjacency, Index i, Index j) {
    return std::uint32_t(std::lower_bound(adjacency[i].begin(), adjacency[i].end(), j) - adjacency.item.data());
}

/// Expects symmetric, positive weights, and edges with opposite signs in both directions.
static void ExpectSoundWeights(const DeformationGraph &d) {
    const Csr &adjacency = d.graph.adjacency;
    ASSERT_EQ(d.weight.size(), adjacency.item.size());
    ASSERT_EQ(std::size_t(d.edge.cols()), adjacency.item.size());
    EXPECT_TRUE(d.graph.position.allFinite());
    for (Index i = 0; i < adjacency.Size(); ++i)
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
            const Index j = adjacency.item[e];
            const std::uint32_t back = ItemOf(adjacency, j, i);
            ASSERT_TRUE(std::isfinite(d.weight[e]) && d.weight[e] > 0) << i << " - " << j << ": " << d.weight[e];
            ASSERT_EQ(d.weight[e], d.weight[back]) << "not symmetric";
            ASSERT_TRUE(d.edge.col(e).allFinite());
            ASSERT_EQ(Eigen::Vector3f(d.edge.col(e)), Eigen::Vector3f(-d.edge.col(back)));
            ASSERT_FALSE(d.IsHeld(i) && d.IsHeld(j)) << "between them nothing deforms";
        }
}

static DeformationGraph APatchPerNode(const SurfaceGraph &s, GraphWeights weights = GraphWeights::Border) {
    std::vector<Index> all(s.graph.Size());
    std::iota(all.begin(), all.end(), 0);
    return MakeDeformationGraph(s.graph, {}, s.nodeArea, GrowPatches(s.graph, {}, all), weights);
}

TEST(DeformationGraph, WithAPatchPerVertexWeightsAreTheCotangentsOfTheFaces) {
    for (const Shape &shape :
         {Jittered(Sphere(24, 30), 0.02), Jittered(Sphere(12, 14), 0.002, 2), Jittered(Sphere(40, 16), 0.03, 3)}) {
        const MeshD mesh(shape);
        const SurfaceGraph s = BuildSurfaceGraph(Read(mesh));
        const DeformationGraph d = APatchPerNode(s);
        ExpectSoundWeights(d);
        std::map<std::pair<Index, Index>, double> cotangent;
        for (const auto &f : shape.face)
            for (int c = 0; c < 3; ++c) {
                const Eigen::Vector3d x = shape.position[f[c]], p = shape.position[f[(c + 1) % 3]] - x,
                                      q = shape.position[f[(c + 2) % 3]] - x;
                const double angle = std::acos(p.dot(q) / (p.norm() * q.norm()));
                cotangent[std::minmax(s.nodeOf[f[(c + 1) % 3]], s.nodeOf[f[(c + 2) % 3]])] += 0.5 / std::tan(angle);
            }
        double mean = 0;
        for (const auto &each : cotangent)
            mean += std::max(0.0, each.second) / double(cotangent.size());
        const double least = ShapeConstants().leastWeight * mean;
        ASSERT_EQ(cotangent.size() * 2, d.weight.size());
        int below = 0;
        for (Index i = 0; i < d.Size(); ++i)
            for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
                const double expected = cotangent.at(std::minmax(i, d.graph.adjacency.item[e]));
                below += expected < least;
                EXPECT_NEAR(d.weight[e], std::max(expected, least), 1e-4 * (1 + std::abs(expected)));
            }
        EXPECT_LT(below, int(d.weight.size()) / 2);
    }
}

TEST(DeformationGraph, PatchesLikeBricksCarryAsMuchAcrossAsAlong) {
    const int n = 48, half = n / 2 + 1;
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Grid(n, n))));
    Patches patches;
    std::map<int, Index> number; // of the bricks, as they appear
    for (Index u = 0; u < s.graph.Size(); ++u) {
        const Eigen::Vector3d p = s.frame.FromFrame(s.graph.position.col(u).cast<double>());
        const int x = int(std::lround(p[0])), y = int(std::lround(p[1]));
        const auto brick = number.emplace(y * half + (x + y % 2) / 2, patches.Size());
        if (brick.second)
            patches.center.push_back(u);
        patches.patchOf.push_back(brick.first->second);
    }
    patches.radius.assign(patches.Size(), 1);
    patches.tag.assign(patches.Size(), 1);
    const DeformationGraph d = MakeDeformationGraph(s.graph, {}, s.nodeArea, patches, GraphWeights::Border);
    ExpectSoundWeights(d);
    const auto energyOf = [](const Graph &g, const Eigen::Vector3d &slope, const auto &weightOf) {
        double energy = 0;
        for (const auto &e : EdgesOf(g.adjacency)) {
            const Eigen::Vector3d way = (g.position.col(e.first) - g.position.col(e.second)).cast<double>();
            energy += weightOf(e.first, e.second) * std::pow(slope.dot(way), 2);
        }
        return energy;
    };
    for (const Eigen::Vector3d &slope :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, -1, 0)})
        EXPECT_NEAR(
            energyOf(d.graph, slope, [&](Index i, Index j) { return d.weight[ItemOf(d.graph.adjacency, i, j)]; }) /
                energyOf(s.graph, slope,
                         [&](Index u, Index v) { return vcg::fcd::detail::CotangentWeight(s.graph, u, v); }),
            1, 0.1)
            << slope.transpose();
}

/// Divides each face with all corners at x < \p limit into four, and cuts its neighbours to fit.
static Shape RefinedLeft(Shape s, double limit) {
    std::map<std::pair<int, int>, int> middle;
    for (const auto &f : s.face)
        if (s.position[f[0]][0] < limit && s.position[f[1]][0] < limit && s.position[f[2]][0] < limit)
            for (int c = 0; c < 3; ++c)
                if (middle.emplace(std::minmax(f[c], f[(c + 1) % 3]), s.Size()).second)
                    s.position.push_back(0.5 * (s.position[f[c]] + s.position[f[(c + 1) % 3]]));
    std::vector<std::array<int, 3>> open = std::move(s.face);
    s.face.clear();
    while (!open.empty()) {
        const std::array<int, 3> f = open.back();
        open.pop_back();
        std::array<int, 3> m;
        int cuts = 0;
        for (int c = 0; c < 3; ++c) {
            const auto found = middle.find(std::minmax(f[c], f[(c + 1) % 3]));
            m[c] = found == middle.end() ? -1 : found->second;
            cuts += m[c] >= 0;
        }
        if (cuts == 3) {
            s.face.insert(s.face.end(), {{f[0], m[0], m[2]}, {m[0], f[1], m[1]}, {m[2], m[1], f[2]}, m});
            continue;
        }
        int cut = 0;
        while (cut < 3 && m[cut] < 0)
            ++cut;
        if (cut == 3) {
            s.face.push_back(f);
            continue;
        }
        const int a = f[cut], b = f[(cut + 1) % 3], c = f[(cut + 2) % 3];
        open.push_back({a, m[cut], c});
        open.push_back({m[cut], b, c});
    }
    return s;
}

TEST(DeformationGraph, WeightsAreThoseOfTheSurfaceNotOfItsVertices) {
    const int cells = 4, n = 61;
    const double side = (n - 1.0) / cells;
    const auto weights = [&](const Shape &shape) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
        Patches patches;
        patches.center.resize(cells * cells, -1);
        patches.radius.resize(cells * cells, 1);
        patches.tag.resize(cells * cells, 1);
        const auto cell = [&](double x) { return std::min(cells - 1, std::max(0, int(x / side))); };
        for (Index u = 0; u < s.graph.Size(); ++u) {
            const Eigen::Vector3d p = s.frame.FromFrame(s.graph.position.col(u).cast<double>());
            patches.patchOf.push_back(cell(p[1] - 0.5) * cells + cell(p[0] - 0.5));
            patches.center[patches.patchOf.back()] = u;
        }
        const DeformationGraph d = MakeDeformationGraph(s.graph, {}, s.nodeArea, patches, GraphWeights::Border);
        ExpectSoundWeights(d);
        std::map<std::pair<Index, Index>, double> weight;
        for (const auto &e : EdgesOf(d.graph.adjacency))
            weight[e] = d.weight[ItemOf(d.graph.adjacency, e.first, e.second)];
        return weight;
    };
    for (double jitter : {0.0, 0.25}) {
        const Shape shape = Jittered(Grid(n, n), jitter), refined = RefinedLeft(shape, 29.5),
                    twice = RefinedLeft(refined, 29.5);
        ASSERT_GT(twice.Size(), 8 * shape.Size());
        const auto before = weights(shape), after = weights(twice);
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x)
                for (const auto &[dx, dy] : {std::make_pair(1, 0), std::make_pair(0, 1)}) {
                    if (x + dx >= cells || y + dy >= cells)
                        continue;
                    const std::pair<Index, Index> e(y * cells + x, (y + dy) * cells + x + dx);
                    EXPECT_NEAR(before.at(e), 1, 0.15) << "squares: the border is as long as the way";
                    EXPECT_NEAR(after.at(e), before.at(e), 0.1) << e.first << " - " << e.second;
                }
        for (const auto &e : after)
            if (!before.count(e.first) || e.first.second - e.first.first == cells + 1) {
                EXPECT_LT(e.second, 0.15) << "squares that touch at a corner";
            }
    }
}

TEST(DeformationGraph, WeightsArePositiveWhateverTheFacesAreLike) {
    Shape collinear = Strip(40);
    for (Eigen::Vector3d &p : collinear.position)
        p = Eigen::Vector3d(p[0] + 0.5 * p[1], 0, 0);
    Shape slivers = Grid(20, 20);
    for (Eigen::Vector3d &p : slivers.position)
        p[1] *= 1e-7;
    Shape close = Grid(3, 3);
    close.position[4] = close.position[0] + Eigen::Vector3d(1e-9, 0, 0);
    Shape degenerate = Grid(8, 8), tangled = Sphere(10, 12);
    std::mt19937 random(1);
    for (int i = 0; i < 60; ++i) {
        degenerate.face.push_back({i, i, i + 1});
        tangled.face.push_back({int(random() % 120), int(random() % 120), int(random() % 120)});
    }
    std::vector<Shape> shapes{collinear,
                              slivers,
                              close,
                              degenerate,
                              tangled,
                              Fan3(),
                              Fan(100),
                              PointCloud(200),
                              Wireframe(9, 8),
                              Join(Grid(9, 9), Grid(9, 9)),
                              Moved(Grid(9, 9), Eigen::Affine3d(Eigen::Scaling(1e-30)))};
    for (const Shape &shape : shapes)
        for (int tagged : {0, 1}) {
            const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(shape)));
            ExpectSoundWeights(APatchPerNode(s));
            std::vector<Index> tag = RandomGroups(s.graph.Size(), 3, 7);
            if (!tagged)
                tag.clear();
            for (double D : {0.05, 0.3}) {
                PatchParam param;
                param.targetRadius = D;
                param.initialPatches = 5;
                Patches patches = SamplePatches(s.graph, tag, s.nodeArea, param);
                AddHeldPatches(s.graph, tag, patches);
                ExpectSoundWeights(MakeDeformationGraph(s.graph, tag, s.nodeArea, patches, GraphWeights::Border));
                ExpectSoundWeights(MakeDeformationGraph(s.graph, tag, s.nodeArea, patches, GraphWeights::Uniform));
            }
        }
}

TEST(CotangentWeight, OfEdgesWithoutFacesIsThatOfEquilateralTriangles) {
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Wireframe(4, 4))));
    for (const auto &e : EdgesOf(s.graph.adjacency))
        EXPECT_NEAR(vcg::fcd::detail::CotangentWeight(s.graph, e.first, e.second), 1 / std::sqrt(3.0), 1e-7);
}

TEST(CotangentWeight, OfAnEdgeOfManyFacesIsThatOfTwo) {
    for (int n : {2, 3, 17}) { // all faces are alike
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Fan(n))));
        const Eigen::Vector3d p(1, 0, 0.5), q(1, 0, -0.5);
        EXPECT_NEAR(vcg::fcd::detail::CotangentWeight(s.graph, s.nodeOf[0], s.nodeOf[1]), p.dot(q) / p.cross(q).norm(),
                    1e-5)
            << n;
    }
}

TEST(DeformationGraph, EdgesBetweenHeldAndFreePatchesEndAtTheBorder) {
    const Rig rig(Grid(40, 40, 0.1), 0.5, [](const Eigen::Vector3d &p) { return p[0] < 1.55 ? 0 : 1; });
    const DeformationGraph &d = rig.graph;
    ExpectSoundWeights(d);
    const double border = rig.surface.frame.ToFrame(Eigen::Vector3d(1.5, 0, 0))[0];
    int cut = 0;
    for (Index i = 0; i < d.Size(); ++i)
        for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = d.graph.adjacency.item[e];
            const Eigen::Vector3f edge = d.edge.col(e), whole = d.graph.position.col(i) - d.graph.position.col(j);
            if (rig.patches.tag[i] == rig.patches.tag[j]) {
                EXPECT_EQ(edge, whole);
            } else if (rig.patches.tag[i] == 1) {
                ++cut;
                EXPECT_NEAR(d.graph.position(0, i) - edge[0], border, 1e-5);
            }
        }
    EXPECT_GT(cut, 3);
}

TEST(DeformationGraph, UniformWeightsAreOne) {
    const Rig rig = RigOf(Grid(20, 15));
    const DeformationGraph uniform =
        MakeDeformationGraph(rig.surface.graph, {}, rig.surface.nodeArea, rig.patches, GraphWeights::Uniform);
    EXPECT_EQ(uniform.weight, std::vector<float>(uniform.graph.adjacency.item.size(), 1));
}

TEST(DeformationGraph, DoesNotDependOnTheThreads) {
    const Rig rig(Jittered(Grid(180, 170), 0.3), 8, [](const Eigen::Vector3d &p) { return p[0] < 30 ? 0 : 1; });
    for (unsigned threads : Rounds({7u, 2u, 1u})) {
        const DeformationGraph d = MakeDeformationGraph(rig.surface.graph, rig.tag, rig.surface.nodeArea, rig.patches,
                                                        GraphWeights::Border, Threads(threads));
        EXPECT_EQ(d.weight, rig.graph.weight);
        EXPECT_TRUE(SameBits(d.edge, rig.graph.edge));
        EXPECT_TRUE(SameBits(d.graph.position, rig.graph.graph.position));
    }
}

TEST(AddHeldPatches, TakesTheHeldNodesBesideFreePatches) {
    for (unsigned seed = 0; seed <= 6; ++seed) {
        const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Jittered(Grid(30, 30), 0.3))));
        const std::vector<Index> tag =
            seed ? RandomGroups(s.graph.Size(), 2 + seed, seed) : TagNodes(s, [](const Eigen::Vector3d &p) {
                return p[0] < 9 ? 0 : p[0] > 20 ? 2 : 1;
            });
        PatchParam param;
        param.targetRadius = seed % 2 ? 0.2 : 0.05;
        const Patches free = SamplePatches(s.graph, tag, {}, param);
        Patches patches = free;
        AddHeldPatches(s.graph, tag, patches);
        ASSERT_GT(patches.Size(), free.Size());
        ASSERT_EQ(patches.radius.size(), patches.center.size());
        ASSERT_EQ(patches.tag.size(), patches.center.size());
        for (Index j = 0; j < patches.Size(); ++j) {
            EXPECT_EQ(patches.patchOf[patches.center[j]], j);
            EXPECT_EQ(patches.tag[j], tag[patches.center[j]]);
            EXPECT_EQ(j < free.Size(), patches.tag[j] == 1);
            if (j < free.Size()) {
                EXPECT_EQ(patches.center[j], free.center[j]);
                EXPECT_EQ(patches.radius[j], free.radius[j]);
            }
        }
        std::vector<double> radius(patches.Size(), 0);
        std::vector<std::set<Index>> faced(patches.Size()); // of each held patch: free patches to which it is nearest
        const Csr members = GroupMembers(free.patchOf, free.Size());
        for (Index u = 0; u < s.graph.Size(); ++u) {
            const Index j = patches.patchOf[u];
            Index nearest = -1;
            float least = 9;
            for (Index v : s.graph.adjacency[u]) {
                const float distance = (s.graph.position.col(v) - s.graph.position.col(u)).norm();
                if (tag[v] == 1 && distance < least) {
                    least = distance;
                    nearest = free.patchOf[v];
                }
            }
            if (tag[u] == 1) {
                EXPECT_EQ(j, free.patchOf[u]);
                continue;
            }
            ASSERT_EQ(j >= 0, nearest >= 0);
            if (j < 0)
                continue;
            EXPECT_EQ(patches.tag[j], tag[u]);
            faced[j].insert(nearest);
            radius[j] =
                std::max<double>(radius[j], (s.graph.position.col(u) - s.graph.position.col(patches.center[j])).norm());
        }
        const Csr all = GroupMembers(patches.patchOf, patches.Size());
        std::set<std::pair<Index, Index>> pairs;
        for (Index j = free.Size(); j < patches.Size(); ++j) {
            EXPECT_NEAR(patches.radius[j], radius[j], 1e-6);
            ASSERT_EQ(faced[j].size(), 1u);
            const Index beside = *faced[j].begin();
            if (members[beside].size() == 1) {
                EXPECT_EQ(all[j].size(), 1u) << "beside a patch of one node";
            } else {
                EXPECT_TRUE(pairs.emplace(beside, patches.tag[j]).second) << "two that face the same patch";
            }
        }
    }
}

TEST(AddHeldPatches, AddsNoneWhereNothingIsHeldOrNothingIsFree) {
    const SurfaceGraph s = BuildSurfaceGraph(Read(MeshD(Grid(5, 5))));
    for (const std::vector<Index> &tag : {std::vector<Index>(), std::vector<Index>(25, 1), std::vector<Index>(25, 0)}) {
        PatchParam param;
        param.targetRadius = 0.3;
        Patches patches = SamplePatches(s.graph, tag, {}, param);
        const Index before = patches.Size();
        AddHeldPatches(s.graph, tag, patches);
        EXPECT_EQ(patches.Size(), before);
    }
}

static std::vector<vcg::Color4b> ColorsOf(const Csr &adjacency) {
    std::vector<std::array<Index, 2>> edge;
    for (const auto &e : EdgesOf(adjacency))
        edge.push_back({e.first, e.second});
    return contrastingColors(std::size_t(adjacency.Size()), edge);
}

TEST(ContrastingColors, OfNeighboursDiffer) {
    for (const Shape &shape : Shapes()) {
        const Csr &adjacency = RigOf(shape, 0.3).graph.graph.adjacency;
        const std::vector<vcg::Color4b> color = ColorsOf(adjacency);
        ASSERT_EQ(Index(color.size()), adjacency.Size());
        for (const auto &e : EdgesOf(adjacency))
            EXPECT_TRUE(color[e.first] != color[e.second] || adjacency[e.second].size() >= 12);
    }
}

TEST(ContrastingColors, TakesANodeWithManyNeighbours) {
    EdgeSet star;
    for (Index i = 1; i < 100; ++i)
        Insert(star, 0, i);
    EXPECT_EQ(ColorsOf(CsrOf(100, star)).size(), 100u);
    EXPECT_TRUE(ColorsOf({}).empty());
}
