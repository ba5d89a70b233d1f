// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BENCHMARK_MESH_H
#define FCD_BENCHMARK_MESH_H

#include <vcg/complex/complex.h>

/// A VCG mesh whose vertices are as large as MeshLab's own.
namespace benchmark {
class Vertex;
class Edge;
class Face;
struct Types : vcg::UsedTypes<vcg::Use<Vertex>::AsVertexType, vcg::Use<Edge>::AsEdgeType, vcg::Use<Face>::AsFaceType> {
};
class Vertex : public vcg::Vertex<Types, vcg::vertex::Coord3d, vcg::vertex::BitFlags, vcg::vertex::Normal3d,
                                  vcg::vertex::Qualityd, vcg::vertex::Color4b> {};
class Edge : public vcg::Edge<Types, vcg::edge::VertexRef, vcg::edge::BitFlags> {};
class Face : public vcg::Face<Types, vcg::face::VertexRef, vcg::face::Normal3d, vcg::face::BitFlags> {};
class Mesh : public vcg::tri::TriMesh<std::vector<Vertex>, std::vector<Edge>, std::vector<Face>> {};
} // namespace benchmark

#endif
