// SPDX-License-Identifier: GPL-3.0-or-later
// Bends a mesh: its lowest tenth stays, its highest one is turned by 60 degrees, and the rest follows.
//   bend_mesh IN.ply OUT.ply
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/handles/motion_text.h>

#include <wrap/io_trimesh/export_ply.h>
#include <wrap/io_trimesh/import_ply.h>

class Vertex;
class Face;
class Edge;
struct Types : vcg::UsedTypes<vcg::Use<Vertex>::AsVertexType, vcg::Use<Edge>::AsEdgeType, vcg::Use<Face>::AsFaceType> {
};
class Vertex : public vcg::Vertex<Types, vcg::vertex::Coord3d, vcg::vertex::Normal3d, vcg::vertex::BitFlags> {};
class Face : public vcg::Face<Types, vcg::face::VertexRef, vcg::face::BitFlags> {};
class Edge : public vcg::Edge<Types, vcg::edge::VertexRef, vcg::edge::BitFlags> {};
class Mesh : public vcg::tri::TriMesh<std::vector<Vertex>, std::vector<Face>, std::vector<Edge>> {};

int main(int argc, char **argv) try {
    Mesh mesh;
    if (argc != 3 || vcg::tri::io::ImporterPLY<Mesh>::Open(mesh, argv[1]) != 0)
        return std::fprintf(stderr, "bend_mesh IN.ply OUT.ply\n"), 2;
    vcg::tri::UpdateBounding<Mesh>::Box(mesh);
    vcg::fcd::Handles handles;
    for (const Vertex &v : mesh.vert) { // 0 stays, 1 is free, 2 is a handle
        const double height = (v.cP()[2] - mesh.bbox.min[2]) / mesh.bbox.DimZ();
        handles.tag.push_back(height < 0.1 ? 0 : height > 0.9 ? 2 : 1);
    }
    handles.motion[2] = vcg::fcd::ToMotion({vcg::fcd::MotionStep::Rotate({0, 1, 0}, 60)}, {0, 0, mesh.bbox.max[2]});
    const vcg::fcd::DeformationResult result = vcg::tri::DeformCentroidal(mesh, handles, vcg::fcd::DeformationParam());
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        for (int d = 0; d < 3; ++d)
            mesh.vert[i].P()[d] = result.position(d, Eigen::Index(i));
    std::printf("%d nodes, %d iterations\n", int(result.rest.position.cols()), result.iterations);
    return vcg::tri::io::ExporterPLY<Mesh>::Save(mesh, argv[2]);
} catch (const vcg::fcd::Error &error) { // says what to do
    return std::fprintf(stderr, "%s\n", error.what()), 1;
}
