// SPDX-License-Identifier: GPL-3.0-or-later
#include "test_support.h"

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

TEST(DeformationGraph, NodesAreThePatchCentres) {
    const Rig rig = RigOf(Tube(20, 12));
    EXPECT_EQ(rig.graph.radius, rig.patches.radius);
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

TEST(DeformationGraph, BorderWeightsAreBorderOverDistance) {
    for (const Shape &shape : Shapes()) {
        const Rig rig = RigOf(shape);
        const Csr &adjacency = rig.graph.graph.adjacency;
        const std::vector<float> &weight = rig.graph.weight;
        ASSERT_EQ(weight.size(), adjacency.item.size());
        if (weight.empty())
            continue;
        double sum = 0, ratio = 0; // of the weight to crossings over distance: the same for all edges
        for (Index i = 0; i < adjacency.Size(); ++i)
            for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
                const Index j = adjacency.item[e];
                const auto back = std::lower_bound(adjacency[j].begin(), adjacency[j].end(), i);
                EXPECT_EQ(weight[e], weight[back - adjacency.item.data()]) << "not symmetric";
                EXPECT_GT(weight[e], 0);
                sum += weight[e];
                int crossings = 0;
                for (const auto &s : EdgesOf(rig.surface.graph.adjacency))
                    crossings +=
                        std::minmax(rig.patches.patchOf[s.first], rig.patches.patchOf[s.second]) == std::minmax(i, j);
                const double length = rig.graph.edge.col(e).norm();
                EXPECT_EQ(rig.graph.edge.col(e), rig.graph.graph.position.col(i) - rig.graph.graph.position.col(j));
                const double here = weight[e] * length / crossings;
                ratio = ratio > 0 ? ratio : here;
                EXPECT_NEAR(here / ratio, 1, 1e-5);
            }
        EXPECT_NEAR(sum / double(weight.size()), 1, 1e-5);
    }
}

TEST(DeformationGraph, EdgesBetweenHeldAndFreePatchesEndAtTheBorder) {
    const Rig rig(Grid(40, 40, 0.1), 0.5, [](const Eigen::Vector3d &p) { return p[0] < 1.55 ? 0 : 1; });
    const DeformationGraph &d = rig.graph;
    const Patches &patches = rig.patches;
    const double border = rig.surface.frame.ToFrame(Eigen::Vector3d(1.5, 0, 0))[0];
    int cut = 0;
    for (Index i = 0; i < d.Size(); ++i)
        for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = d.graph.adjacency.item[e];
            const Eigen::Vector3f edge = d.edge.col(e), whole = d.graph.position.col(i) - d.graph.position.col(j);
            const auto back = std::lower_bound(d.graph.adjacency[j].begin(), d.graph.adjacency[j].end(), i);
            EXPECT_EQ(Eigen::Vector3f(d.edge.col(back - d.graph.adjacency.item.data())), Eigen::Vector3f(-edge));
            if (patches.tag[i] == patches.tag[j]) {
                EXPECT_EQ(edge, whole);
            } else if (patches.tag[i] == 1) {
                ++cut;
                EXPECT_NEAR(d.graph.position(0, i) - edge[0], border, 1e-5);
                EXPECT_LT(edge.norm(), whole.norm());
            }
        }
    EXPECT_GT(cut, 3);
}

TEST(DeformationGraph, UniformWeightsAreOne) {
    const Rig rig = RigOf(Grid(20, 15));
    const DeformationGraph uniform =
        MakeDeformationGraph(rig.surface.graph, rig.patches, rig.surface.averageEdge, GraphWeights::Uniform);
    EXPECT_EQ(uniform.weight, std::vector<float>(uniform.graph.adjacency.item.size(), 1));
}

TEST(DeformationGraph, WeightsStayFiniteWhereCentresAlmostCoincide) {
    Shape shape = Grid(3, 3);
    shape.position[4] = shape.position[0] + Eigen::Vector3d(1e-9, 0, 0);
    const SurfaceGraph s = vcg::tri::BuildSurfaceGraph(MeshD(shape));
    std::vector<Index> all;
    for (Index u = 0; u < s.graph.Size(); ++u)
        all.push_back(u);
    const DeformationGraph d =
        MakeDeformationGraph(s.graph, GrowPatches(s.graph, {}, all), s.averageEdge, GraphWeights::Border);
    for (float w : d.weight) {
        EXPECT_TRUE(std::isfinite(w));
        EXPECT_GT(w, 0);
    }
}

TEST(ContrastingColors, OfNeighboursDiffer) {
    for (const Shape &shape : Shapes()) {
        const Csr &adjacency = RigOf(shape, 0.3).graph.graph.adjacency;
        const std::vector<vcg::Color4b> color = ContrastingColors(adjacency);
        ASSERT_EQ(Index(color.size()), adjacency.Size());
        for (const auto &e : EdgesOf(adjacency))
            EXPECT_TRUE(color[e.first] != color[e.second] || adjacency[e.second].size() >= 12);
    }
}

TEST(ContrastingColors, TakesANodeWithManyNeighbours) {
    EdgeSet star;
    for (Index i = 1; i < 100; ++i)
        Insert(star, 0, i);
    EXPECT_EQ(ContrastingColors(CsrOf(100, star)).size(), 100u);
    EXPECT_TRUE(ContrastingColors({}).empty());
}
