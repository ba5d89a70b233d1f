// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/angle_normals.h>

#include "test_mesh.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vcg/complex/algorithms/update/normal.h>

using namespace fcd_test;

namespace {

/// How often faces were asked whether they are deleted.
std::atomic<std::size_t> visits;

class CountedVertex;
class CountedFace;
class CountedEdge;
struct CountedTypes : vcg::UsedTypes<vcg::Use<CountedVertex>::AsVertexType, vcg::Use<CountedEdge>::AsEdgeType,
                                     vcg::Use<CountedFace>::AsFaceType> {};
class CountedVertex
    : public vcg::Vertex<CountedTypes, vcg::vertex::Coord3d, vcg::vertex::Normal3d, vcg::vertex::BitFlags> {};
class CountedFace : public vcg::Face<CountedTypes, vcg::face::VertexRef, vcg::face::Normal3d, vcg::face::BitFlags> {
  public:
    bool IsD() const {
        ++visits;
        return vcg::Face<CountedTypes, vcg::face::VertexRef, vcg::face::Normal3d, vcg::face::BitFlags>::IsD();
    }
};
class CountedEdge : public vcg::Edge<CountedTypes, vcg::edge::VertexRef, vcg::edge::BitFlags> {};
using CountedMesh = MeshOf<CountedVertex, CountedEdge, CountedFace>;

/// Vertices with normals of their own, of which some are deleted and some have no face; faces of which some are
/// deleted. \param shuffled whether the corners of a face are far from each other in memory
class Bumps : public CountedMesh {
  public:
    explicit Bumps(bool shuffled) : CountedMesh(ShapeOf(shuffled)) {
        for (int i = 0; i < int(vert.size()); ++i) {
            vert[i].N() = vcg::Point3d(i, 2, 3);
            if (i % 1000 == 7)
                DeleteVertex(i);
        }
        for (int f = 0; f < int(face.size()); ++f) {
            face[f].N() = vcg::Point3d(f, 5, 6);
            if (f % 13 == 4)
                DeleteFace(f);
        }
    }

  private:
    static Shape ShapeOf(bool shuffled) {
        const Shape shape = Join(Jittered(Grid(90, 90), 0.4), PointCloud(20));
        const std::size_t n = shape.position.size(), step = shuffled ? 3571 : 1; // a prime
        const auto at = [&](std::size_t i) { return int(i * step % n); };
        Shape placed = shape;
        for (std::size_t i = 0; i < n; ++i)
            placed.position[at(i)] = shape.position[i];
        for (auto &corners : placed.face)
            for (int &corner : corners)
                corner = at(corner);
        placed.face.push_back({5, 5, 5});
        return placed;
    }
};

std::vector<vcg::Point3d> NormalsOf(const CountedMesh &mesh) {
    std::vector<vcg::Point3d> all;
    for (const auto &vertex : mesh.vert)
        all.push_back(vertex.cN());
    for (const auto &face : mesh.face)
        all.push_back(face.cN());
    return all;
}

void ComputeNormals(CountedMesh &mesh, unsigned threads, const std::vector<char> &flags = {}) {
    FacesOfNormals memory(mesh.vert.size(), mesh.face.size());
    computeAngleNormals(mesh, flags, memory, threads);
}

} // namespace

TEST(AngleNormals, AreThoseOfVcg) {
    for (bool shuffled : {false, true}) {
        Bumps mesh(shuffled), made(shuffled);
        for (CountedVertex &vertex : made.vert) // which vcg keeps otherwise where it is deleted or has no face
            if (vertex.IsD())
                vertex.ClearD();
        vcg::tri::UpdateNormal<CountedMesh>::PerFaceNormalized(made);
        vcg::tri::UpdateNormal<CountedMesh>::PerVertexAngleWeighted(made);
        ComputeNormals(mesh, 2);
        const std::vector<vcg::Point3d> normals = NormalsOf(mesh), expected = NormalsOf(made);
        for (std::size_t i = 0; i < normals.size(); ++i) // six faces, each with an angle that is off by 5e-7
            EXPECT_LT((normals[i] - expected[i]).Norm(), 3e-6) << i << ", shuffled: " << shuffled;
    }
}

TEST(AngleNormals, AreTheSameForAnyNumberOfThreads) {
    for (bool shuffled : {false, true}) {
        Bumps one(shuffled);
        ComputeNormals(one, 1);
        for (unsigned threads : {0u, 2u, 4u, 7u, 64u}) {
            Bumps mesh(shuffled);
            ComputeNormals(mesh, threads);
            EXPECT_EQ(NormalsOf(mesh), NormalsOf(one)) << threads << " threads, shuffled: " << shuffled;
        }
    }
}

TEST(AngleNormals, TakeTheSameWorkForAnyNumberOfThreads) {
    for (bool shuffled : {false, true}) {
        Bumps mesh(shuffled);
        const auto visitsOf = [&](unsigned threads) {
            visits = 0;
            ComputeNormals(mesh, threads);
            return double(visits);
        };
        const double one = visitsOf(1);
        EXPECT_LE(one, double(mesh.face.size()));
        for (unsigned threads : {2u, 4u, 64u})
            EXPECT_LE(visitsOf(threads), 1.2 * one) << threads << " threads, shuffled: " << shuffled;
    }
}

TEST(AngleNormals, LeaveAMeshWithoutFacesAlone) {
    CountedMesh mesh(PointCloud(10));
    mesh.vert[3].N() = vcg::Point3d(1, 2, 3);
    ComputeNormals(mesh, 4);
    EXPECT_EQ(mesh.vert[3].cN(), vcg::Point3d(1, 2, 3));
    CountedMesh empty;
    ComputeNormals(empty, 4);
}

TEST(AngleNormals, AnglesOfCotangents) {
    for (double angle = 1e-4; angle < 3.1415; angle += 1e-3)
        EXPECT_NEAR(vcg::fcd::AngleOfCotangent(float(1 / std::tan(angle))), angle, 5e-7);
    EXPECT_EQ(vcg::fcd::AngleOfCotangent(0), vcg::fcd::AngleOfCotangent(-0.f));
}

TEST(AngleNormals, OfFlaggedVerticesAreThoseOfAll) {
    const Bumps before(false);
    Bumps all(false), some(false);
    ComputeNormals(all, 1);
    std::vector<char> flags(some.vert.size(), 0);
    for (std::size_t i = 0; i < flags.size(); ++i)
        flags[i] = i % 7 == 0 || i > flags.size() / 2;
    ComputeNormals(some, 0, flags);
    for (std::size_t i = 0; i < flags.size(); ++i) {
        EXPECT_EQ(some.vert[i].cN(), (flags[i] ? all : before).vert[i].cN()) << i;
    }
}
