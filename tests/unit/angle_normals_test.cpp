// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/angle_normals.h>

#include "test_mesh.h"

#include <cstring>
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

/// A mesh with normals. Some vertices are deleted and some have no face; some faces are deleted and one must not be
/// read. \param shuffled whether the corners of a face are far from each other in memory
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
        face[100].ClearR();
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

std::vector<double> NormalsOf(const CountedMesh &mesh) {
    std::vector<double> all;
    for (const auto &vertex : mesh.vert)
        all.insert(all.end(), &vertex.cN()[0], &vertex.cN()[0] + 3);
    for (const auto &face : mesh.face)
        all.insert(all.end(), &face.cN()[0], &face.cN()[0] + 3);
    return all;
}

bool Same(const std::vector<double> &a, const std::vector<double> &b) { // to the bit
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

} // namespace

TEST(AngleNormals, AreThoseOfVcgForAnyNumberOfThreads) {
    for (bool shuffled : {false, true}) {
        Bumps expected(shuffled);
        for (CountedVertex &vertex : expected.vert) // vcg does not change deleted ones and those without a face
            if (vertex.IsD())
                vertex.ClearD();
        vcg::tri::UpdateNormal<CountedMesh>::PerFaceNormalized(expected);
        vcg::tri::UpdateNormal<CountedMesh>::PerVertexAngleWeighted(expected);
        for (unsigned threads : {0u, 1u, 2u, 4u, 7u, 64u}) {
            Bumps mesh(shuffled);
            computeAngleNormals(mesh, threads);
            EXPECT_TRUE(Same(NormalsOf(mesh), NormalsOf(expected))) << threads << " threads, shuffled: " << shuffled;
        }
    }
}

TEST(AngleNormals, TakeTheSameWorkForAnyNumberOfThreads) {
    for (bool shuffled : {false, true}) {
        Bumps mesh(shuffled);
        const auto visitsOf = [&](unsigned threads) {
            visits = 0;
            computeAngleNormals(mesh, threads);
            return double(visits);
        };
        const double one = visitsOf(1);
        EXPECT_LE(one, 2 * double(mesh.face.size())); // once for the normals, once for their sums
        for (unsigned threads : {2u, 4u, 64u})
            EXPECT_LE(visitsOf(threads), 1.2 * one) << threads << " threads, shuffled: " << shuffled;
    }
}

TEST(AngleNormals, LeaveAMeshWithoutFacesAlone) {
    CountedMesh mesh(PointCloud(10));
    mesh.vert[3].N() = vcg::Point3d(1, 2, 3);
    computeAngleNormals(mesh, 4);
    EXPECT_EQ(mesh.vert[3].cN(), vcg::Point3d(1, 2, 3));
    CountedMesh empty;
    computeAngleNormals(empty, 4);
}

TEST(AngleNormals, AnglesOfCotangents) {
    for (double angle = 1e-4; angle < 3.1415; angle += 1e-3)
        EXPECT_NEAR(vcg::fcd::AngleOfCotangent(float(1 / std::tan(angle))), angle, 5e-7);
    EXPECT_EQ(vcg::fcd::AngleOfCotangent(0), vcg::fcd::AngleOfCotangent(-0.f));
}

TEST(AngleNormals, OfFlaggedVerticesAreThoseOfAll) {
    const Bumps before(false);
    Bumps all(false), some(false);
    computeAngleNormals(all, 1);
    std::vector<char> flags(some.vert.size(), 0);
    for (std::size_t i = 0; i < flags.size(); ++i)
        flags[i] = i % 7 == 0 || i > flags.size() / 2;
    FlaggedFaces memory(flags.size(), some.face.size());
    computeFlaggedNormals(some, flags, memory);
    for (std::size_t i = 0; i < flags.size(); ++i) {
        const vcg::Point3d &expected = flags[i] ? all.vert[i].N() : before.vert[i].cN();
        EXPECT_LT((some.vert[i].N() - expected).Norm(), 1e-5) << i;
    }
}
