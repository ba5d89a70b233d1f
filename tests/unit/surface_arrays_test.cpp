// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;

TEST(SurfaceArrays, HoldWhatTheMeshHas) {
    Shape shape = Wireframe(5, 4);
    const Shape sheet = Grid(6, 5);
    const int first = shape.Size();
    shape.position.insert(shape.position.end(), sheet.position.begin(), sheet.position.end());
    for (auto f : sheet.face)
        shape.face.push_back({f[0] + first, f[1] + first, f[2] + first});
    MeshD mesh(shape);
    for (bool isCompact : {true, false}) {
        if (!isCompact) {
            mesh.DeleteVertex(3);
            vcg::tri::Allocator<MeshD>::DeleteFace(mesh, mesh.face[7]);
            vcg::tri::Allocator<MeshD>::DeleteEdge(mesh, mesh.edge[2]);
        }
        const SurfaceArrays arrays = vcg::tri::ReadSurface(mesh, Threads(3));
        const SurfaceView view = arrays.View();
        ASSERT_EQ(view.vertexSlots, mesh.vert.size());
        ASSERT_EQ(view.faces, mesh.face.size());
        ASSERT_EQ(view.edges, mesh.edge.size());
        EXPECT_EQ(view.deleted == nullptr, isCompact);
        EXPECT_FALSE(view.isCloud);
        for (std::size_t i = 0; i < view.vertexSlots; ++i) {
            EXPECT_EQ(view.IsDeleted(i), mesh.vert[i].IsD());
            EXPECT_EQ(Eigen::Vector3d(view.At(i)), shape.position[i]);
        }
        for (std::size_t f = 0; f < view.faces; ++f) {
            ASSERT_EQ(view.IsFace(f), !mesh.face[f].IsD());
            for (std::size_t k = 0; k < 3 && view.IsFace(f); ++k)
                EXPECT_EQ(int(view.corner[3 * f + k]), shape.face[f][k]);
        }
        for (std::size_t e = 0; e < view.edges; ++e)
            EXPECT_EQ(view.IsEdge(e), !mesh.edge[e].IsD());
    }
    EXPECT_TRUE(vcg::tri::ReadSurface(MeshD(Points(sheet))).View().isCloud);
}

TEST(SurfaceArrays, ReadPositionsFromElsewhere) {
    const MeshD mesh(Grid(4, 4));
    const SurfaceArrays arrays =
        vcg::tri::ReadSurface(mesh, {}, [](std::size_t i) { return Eigen::Vector3d(i, 1, 2); });
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        EXPECT_EQ(Eigen::Vector3d(arrays.View().At(i)), Eigen::Vector3d(double(i), 1, 2));
}

/// A caller's own arrays give what a mesh gives.
TEST(SurfaceArrays, OfACallerAreDeformedAsAMeshIs) {
    const Case c = CaseOf(
        Tube(24, 30), [](const Eigen::Vector3d &p) { return p[2] < 0.7   ? 0
                                                            : p[2] > 2.2 ? 2
                                                                         : 1; },
        Eigen::Affine3d(Eigen::Translation3d(0.3, 0, 0.1)));
    DeformationParam param;
    param.graph.initialPatches = 40;
    std::vector<double> position;
    std::vector<std::uint32_t> corner;
    for (const Eigen::Vector3d &p : c.shape.position)
        position.insert(position.end(), p.data(), p.data() + 3);
    for (const auto &f : c.shape.face)
        corner.insert(corner.end(), f.begin(), f.end());
    SurfaceView view;
    view.position = position.data();
    view.vertexSlots = c.shape.position.size();
    view.corner = corner.data();
    view.faces = c.shape.face.size();
    view.Validate(Threads(2));
    EXPECT_TRUE(SameBits(DeformSurface(view, {}, c.handles, param).position,
                         vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).position));
}

TEST(SurfaceArrays, SayWhatIsWrongWithACallersArrays) {
    const double position[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::uint32_t corner[6] = {0, 1, 2, SurfaceView::none, 7, 7}, end[4] = {0, 1, 1, 2};
    SurfaceView view;
    view.position = position;
    view.vertexSlots = 3;
    view.corner = corner;
    view.faces = 2;
    view.end = end;
    view.edges = 2;
    EXPECT_NO_THROW(view.Validate());
    end[3] = 3;
    EXPECT_EQ(MessageOf<BadInput>([&] { view.Validate(); }),
              "Edge 1 has a corner that is no vertex: there are 3 vertices.");
    corner[2] = 9;
    EXPECT_EQ(MessageOf<BadInput>([&] { view.Validate(); }),
              "Face 0 has a corner that is no vertex: there are 3 vertices.");
}

/// Numbers that indices cannot hold are refused before any memory is asked for.
TEST(SurfaceArrays, AreNoLargerThanIndicesCanTell) {
    EXPECT_EQ(MessageOf<BadInput>([] { SurfaceArrays(std::size_t(1) << 31, 5, 2, false); }),
              "The mesh has 2147483648 vertices, 5 faces and 2 edges; 2147483647 vertices are the most. Simplify it "
              "first.");
    EXPECT_THROW(SurfaceArrays(3, std::size_t(1) << 32, 0, false), BadInput);
    EXPECT_THROW(SurfaceArrays(3, 0, std::size_t(1) << 32, false), BadInput);
}
