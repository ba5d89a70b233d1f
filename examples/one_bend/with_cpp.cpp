#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/handles/handle_file.h>
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

int main() {
    Mesh mesh;
    if (vcg::tri::io::ImporterPLY<Mesh>::Open(mesh, "meshes/cylinder.ply") != 0)
        return 1;
    vcg::fcd::Handles handles;
    handles.tag = vcg::fcd::ReadTagFile("meshes/cylinder.sel");
    const auto motions = vcg::fcd::ReadMotionText("2: rotate 0 1 0 90 about 0 0 12 translate 4 0 -3");
    handles.motion[2] = vcg::fcd::ToMotion(motions.at(2), Eigen::Vector3d::Zero());

    const vcg::fcd::DeformationResult result = vcg::tri::DeformCentroidal(mesh, handles, vcg::fcd::DeformationParam());
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        for (int d = 0; d < 3; ++d)
            mesh.vert[i].P()[d] = result.position(d, Eigen::Index(i));
    return vcg::tri::io::ExporterPLY<Mesh>::Save(mesh, "bent_cpp.ply");
}
