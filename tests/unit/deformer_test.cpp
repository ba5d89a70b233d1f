// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A tube bent at one end, with a loose ring beside it.
struct DeformerRig {
    Case bend;
    MeshD mesh;
    DeformationParam param;
    Matrix3Xd rest;
    std::unique_ptr<Deformer> deformer;

    explicit DeformerRig(const Affine3d &motion, const Eigen::Matrix3d &world = Eigen::Matrix3d::Identity())
        : bend(CaseOf(
              Tube(24, 60), [](const Vector3d &p) { return p[2] < 0.7   ? 0
                                                           : p[2] > 5.2 ? 2
                                                                        : 1; }, motion)),
          mesh(bend.shape) {
        bend.handles.world.linear() = world;
        param.graph.initialPatches = 50;
        deformer = PrepareDeformer(Read(mesh), bend.handles, param);
        rest = PositionsOf(mesh);
    }
};

static Affine3d BentEnd() { return Eigen::Translation3d(0.5, 0, 0) * Eigen::AngleAxisd(0.9, Vector3d::UnitY()); }

TEST(Deformer, EachPoseIsThatOfADeformationAnew) {
    DeformerRig rig(BentEnd());
    for (double pose : {30.0, 100.0, -50.0, 30.0, 0.0}) {
        rig.param.pose = pose;
        Matrix3Xd position = rig.rest;
        const Deformer::Pose solved = rig.deformer->Solve(rig.bend.handles, rig.param);
        Carrier(*rig.deformer, solved).Apply(position);
        EXPECT_TRUE(SameBits(position, vcg::tri::DeformCentroidal(rig.mesh, rig.bend.handles, rig.param).position));
    }
}

TEST(Deformer, APoseDoesNotDependOnTheStepsOfThoseBefore) {
    DeformerRig rig(BentEnd());
    const Matrix3Xd alone = vcg::tri::DeformCentroidal(rig.mesh, rig.bend.handles, rig.param).position;
    for (const bool accelerated : {false, true})
        for (const double smoothness : {rig.param.smoothness, 0.05}) {
            DeformationParam other = rig.param;
            other.accelerated = accelerated;
            other.smoothness = smoothness;
            rig.deformer->Solve(rig.bend.handles, other);
            Matrix3Xd position = rig.rest;
            Carrier(*rig.deformer, rig.deformer->Solve(rig.bend.handles, rig.param)).Apply(position);
            EXPECT_TRUE(SameBits(position, alone)) << accelerated << ", " << smoothness;
        }
}

TEST(Deformer, GivesWhatMayMoveOnceAndNothingElse) {
    DeformerRig rig(BentEnd());
    const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
    for (unsigned threads : {1u, 3u}) {
        Progress progress;
        progress.threads = threads;
        std::vector<std::atomic<int>> taken(rig.mesh.vert.size());
        Matrix3Xd position = rig.rest, applied = rig.rest;
        Carrier(*rig.deformer, pose).Apply(applied);
        Carrier(*rig.deformer, pose)
            .Apply([&](std::size_t i) { return Vector3d(rig.rest.col(Eigen::Index(i))); },
                   [&] {
                       return [&](std::size_t i, const Vector3d &p, const Eigen::Matrix3f &) {
                           ++taken[i];
                           position.col(Eigen::Index(i)) = p;
                       };
                   },
                   true, progress, [](std::size_t) {});
        EXPECT_TRUE(SameBits(position, applied));
        std::vector<int> moving(taken.size(), 0);
        rig.deformer->ForMoving([&](std::size_t i) { ++moving[i]; });
        for (std::size_t i = 0; i < taken.size(); ++i) {
            ASSERT_EQ(taken[i], moving[i]);
            ASSERT_EQ(moving[i], rig.bend.handles.tag[i] != 0);
        }
    }
}

TEST(Deformer, TurnsNormalsWithTheSurface) {
    for (const Eigen::Matrix3d &world : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
                                         Eigen::Matrix3d(RandomRigid(5).linear() * Vector3d(1, 2, 0.5).asDiagonal())}) {
        DeformerRig rig(BentEnd(), world);
        const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
        Matrix3Xd expected = rig.rest;
        std::vector<Eigen::Matrix3f> linear;
        Carrier(*rig.deformer, pose).Apply(expected, &linear);
        Matrix3Xd normal(3, rig.rest.cols()), position = rig.rest;
        for (Eigen::Index i = 0; i < normal.cols(); ++i) // several lengths, also 0
            normal.col(i) = double(i % 7) * RandomRigid(unsigned(i)).linear().col(0);
        Matrix3Xd turned = normal;
        Carrier(*rig.deformer, pose)
            .ApplyWithNormals([&](std::size_t i) { return Vector3d(rig.rest.col(Eigen::Index(i))); },
                              [&](std::size_t i) { return Vector3d(normal.col(Eigen::Index(i))); },
                              [&] {
                                  return [&](std::size_t i, const Vector3d &p, const Vector3d &n) {
                                      position.col(Eigen::Index(i)) = p;
                                      turned.col(Eigen::Index(i)) = n;
                                  };
                              },
                              Progress(), [](std::size_t) {});
        EXPECT_TRUE(SameBits(position, expected));
        for (std::size_t i = 0; i < linear.size(); ++i) {
            const Vector3d before = normal.col(Eigen::Index(i)), after = turned.col(Eigen::Index(i));
            if (linear[i].isIdentity(0)) {
                ASSERT_EQ(after, before);
            }
            ASSERT_LE((after - Turned(linear[i], before)).norm(), 1e-5);
            ASSERT_NEAR(after.norm(), before.norm(), 1e-5);
        }
    }
}

TEST(Deformer, CarriesItsOwnVerticesWhereTheyGo) {
    DeformerRig rig(BentEnd());
    const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
    Matrix3Xd position = rig.rest;
    std::vector<Eigen::Matrix3f> linear;
    const Carrier carrier(*rig.deformer, pose);
    carrier.Apply(position, &linear);
    std::vector<SurfacePlace> places;
    std::vector<Vector3d> from, ways;
    std::vector<Eigen::Matrix3f> maps;
    for (std::size_t i = 0; i < rig.mesh.vert.size(); ++i) {
        places.push_back(SurfacePlace::AtVertex(Index(i)));
        from.emplace_back(rig.rest.col(Eigen::Index(i)));
    }
    carrier.Displacements(places, from, ways, maps);
    for (std::size_t i = 0; i < from.size(); ++i) {
        ASSERT_LE((from[i] + ways[i] - position.col(Eigen::Index(i))).norm(), 1e-12);
        ASSERT_LE((maps[i] - linear[i]).norm(), 1e-6);
    }
}

TEST(Deformer, CarriesPointsBesideItRigidlyWhereAllMovesSo) {
    const Affine3d motion = RandomRigid(3);
    Case c = CaseOf(
        Tube(24, 60), [](const Vector3d &p) { return p[2] > 5.2 ? 2 : 1; }, motion);
    const MeshD mesh(c.shape);
    const Matrix3Xd rest = PositionsOf(mesh);
    DeformationParam param;
    const auto deformer = PrepareDeformer(Read(mesh), c.handles, param);
    const Deformer::Pose pose = deformer->Solve(c.handles, param);
    const Carrier carrier(*deformer, pose);
    std::vector<Vector3d> ways;
    std::vector<Eigen::Matrix3f> maps;
    for (std::size_t i = 0; i < mesh.vert.size(); i += 5) {
        const Vector3d p = rest.col(Eigen::Index(i)) + Vector3d(0.3, -0.2, 0.1);
        carrier.Displacements({SurfacePlace::AtVertex(Index(i))}, {p}, ways, maps);
        EXPECT_LE((p + ways[0] - motion * p).norm(), 1e-5);
    }
}

TEST(Deformer, CarriesPointsThatAreBoundToItOnce) {
    DeformerRig rig(BentEnd());
    std::vector<std::array<Index, 3>> triangle;
    for (const auto &f : rig.mesh.face)
        triangle.push_back({Index(vcg::tri::Index(rig.mesh, f.cV(0))), Index(vcg::tri::Index(rig.mesh, f.cV(1))),
                            Index(vcg::tri::Index(rig.mesh, f.cV(2)))});
    const NearestPlace places(rig.rest, triangle, std::vector<char>(rig.mesh.vert.size(), 1));
    std::vector<SurfacePlace> bound; // the middles of the triangles, and the vertices
    Matrix3Xd point(3, triangle.size() + rig.mesh.vert.size());
    for (std::size_t t = 0; t < triangle.size(); ++t)
        point.col(Eigen::Index(t)) =
            (rig.rest.col(triangle[t][0]) + rig.rest.col(triangle[t][1]) + rig.rest.col(triangle[t][2])) / 3;
    point.rightCols(rig.rest.cols()) = rig.rest;
    for (Eigen::Index i = 0; i < point.cols(); ++i)
        bound.push_back(places(point.col(i)));
    for (double percent : {40.0, 100.0, 0.0}) {
        rig.param.pose = percent;
        const Deformer::Pose pose = rig.deformer->Solve(rig.bend.handles, rig.param);
        const Carrier carrier(*rig.deformer, pose);
        Matrix3Xd position = rig.rest;
        carrier.Apply(position);
        std::vector<Vector3d> from, ways, alone;
        std::vector<Eigen::Matrix3f> maps, mapAlone;
        for (std::size_t i = 0; i < bound.size(); ++i)
            from.emplace_back(point.col(Eigen::Index(i)));
        carrier.Displacements(bound, from, ways, maps);
        for (std::size_t i = 0; i < bound.size(); ++i) {
            const Vector3d &p = from[i], &way = ways[i];
            carrier.Displacements({bound[i]}, {p}, alone, mapAlone); // whatever is mapped beside it
            EXPECT_EQ(alone[0], way);
            EXPECT_EQ(mapAlone[0], maps[i]);
            Vector3d expected = Vector3d::Zero();
            if (i < triangle.size()) {
                bool isFixed = true;
                for (Index v : triangle[i]) {
                    expected += position.col(v) / 3;
                    isFixed &= rig.deformer->slotTag[std::size_t(v)] == 0;
                }
                if (isFixed || percent == 0) {
                    EXPECT_EQ(way, Vector3d::Zero());
                }
            } else {
                expected = position.col(Eigen::Index(i - triangle.size()));
            }
            // Between the corners the surface bends: off by the square of an edge, 0.2, over the radius, 3.
            EXPECT_LE((p + way - expected).norm(), i < triangle.size() ? 0.02 : 1e-9) << percent << ", point " << i;
        }
    }
}

TEST(Deformer, KnowsItsNodes) {
    DeformerRig rig(BentEnd());
    const auto nodes = vcg::tri::DeformCentroidal(rig.mesh, rig.bend.handles, rig.param).rest.position;
    EXPECT_TRUE(HasNodes(*rig.deformer, nodes));
    EXPECT_TRUE(HasNodes(*rig.deformer, nodes.cast<float>().cast<double>()));
    Matrix3Xd other = nodes;
    other(1, 3) += 0.01;
    EXPECT_FALSE(HasNodes(*rig.deformer, other));
    EXPECT_FALSE(HasNodes(*rig.deformer, nodes.leftCols(nodes.cols() - 1)));
}

TEST(Deformer, KeepsToThePaperWhereAsked) {
    DeformerRig rig(BentEnd());
    rig.param.graphWeights = GraphWeights::Printed;
    rig.param.graph.measure = PatchMeasure::Vertices;
    rig.deformer = PrepareDeformer(Read(rig.mesh), rig.bend.handles, rig.param);
    const Deformer &deformer = *rig.deformer;
    const RegionDeformer &region = deformer.Whole();
    const SurfaceGraph &surface = region.surface;
    const DeformationGraph &graph = region.graph;
    const Csr &adjacency = graph.graph.adjacency;
    for (Index j = 0; j < graph.Size(); ++j) { // a node is the centre of its patch, an edge leads from node to node
        EXPECT_EQ(graph.graph.position.col(j), surface.graph.position.col(region.patches.center[j]));
        for (std::uint32_t e = adjacency.begin[j]; e < adjacency.begin[j + 1]; ++e) {
            EXPECT_EQ(graph.weight[e], 1);
            const Eigen::Vector3f way = graph.graph.position.col(j) - graph.graph.position.col(adjacency.item[e]);
            EXPECT_LE((graph.edge.col(e) - way).norm(), 1e-6f);
        }
    }
    Matrix3Xd position = rig.rest;
    std::vector<Eigen::Matrix3f> linear;
    const Deformer::Pose posed = rig.deformer->Solve(rig.bend.handles, rig.param);
    const RegionPose &pose = posed.region[0];
    Carrier(deformer, posed).Apply(position, &linear);
    ASSERT_TRUE(pose.graph.converged);
    for (Index j = 0; j < graph.Size(); ++j) { // rotations; of held nodes, the given ones
        EXPECT_TRUE((pose.graph.linear[j] * pose.graph.linear[j].transpose()).isIdentity(1e-9));
        if (graph.IsHeld(j)) {
            EXPECT_EQ(pose.graph.linear[j], pose.nodeMotion[j].linear());
        }
    }
    int blended = 0, open = 0;
    for (std::size_t i = 0; i < rig.mesh.vert.size(); ++i) { // Eqs. 7 and 8
        const Index node = deformer.nodeOf[i];
        if (node < 0 || region.held.tag[node] != 1)
            continue;
        const Vector3d p = surface.graph.position.col(node).cast<double>();
        Vector3d sum = Vector3d::Zero();
        Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
        double total = 0;
        int used = 0;
        const auto add = [&](Index j, double w) {
            const Vector3d c = graph.graph.position.col(j).cast<double>();
            sum += w * (pose.graph.linear[j] * (p - c) + pose.graph.position.col(j));
            turn += w * pose.graph.linear[j];
            total += w;
        };
        for (Index j = 0; j < graph.Size(); ++j) {
            double spacing = 0; // a patch of few nodes reaches half-way to its neighbours
            for (Index n : adjacency[j])
                spacing += (graph.graph.position.col(n) - graph.graph.position.col(j)).norm();
            const double d = std::max(double(graph.radius[j]), 0.5 * spacing / double(adjacency[j].size()));
            const double left = 1 - (p - graph.graph.position.col(j).cast<double>()).norm() / d;
            if (left > 0) {
                add(j, left * left);
                ++used;
            }
        }
        if (total < 1e-4) { // tiny weights: rounding decides
            ++open;
            continue;
        }
        blended += used > 1;
        const Vector3d expected = surface.frame.FromFrame(Vector3d(sum / total));
        EXPECT_LE((position.col(Eigen::Index(i)) - expected).norm(), 1e-4) << "vertex " << i;
        EXPECT_LE((linear[i].cast<double>() - turn / total).norm(), 1e-3) << "vertex " << i;
    }
    EXPECT_GT(blended, 3 * open);
    EXPECT_TRUE(position.allFinite());
    for (std::size_t i = 0; i < rig.mesh.vert.size(); ++i)
        if (deformer.slotTag[i] == 0) { // held vertices are exact anyway
            EXPECT_EQ(position.col(Eigen::Index(i)), rig.rest.col(Eigen::Index(i)));
        }
}
