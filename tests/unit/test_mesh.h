// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TEST_MESH_H
#define FCD_TEST_MESH_H

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <vcg/complex/complex.h>
#include <vector>

namespace fcd_test {

/// Positions, triangles and edge elements, from which a mesh of any type is made.
struct Shape {
    std::vector<Eigen::Vector3d> position;
    std::vector<std::array<int, 3>> face;
    std::vector<std::array<int, 2>> edge;

    int Size() const { return int(position.size()); }
};

// VCG meshes with only what vcg_ext may rely on, with double and float coordinates.
class VertexD;
class FaceD;
class EdgeD;
struct TypesD
    : vcg::UsedTypes<vcg::Use<VertexD>::AsVertexType, vcg::Use<EdgeD>::AsEdgeType, vcg::Use<FaceD>::AsFaceType> {};
class VertexD : public vcg::Vertex<TypesD, vcg::vertex::Coord3d, vcg::vertex::BitFlags> {};
class FaceD : public vcg::Face<TypesD, vcg::face::VertexRef, vcg::face::BitFlags> {};
class EdgeD : public vcg::Edge<TypesD, vcg::edge::VertexRef, vcg::edge::BitFlags> {};

class VertexF;
class FaceF;
class EdgeF;
struct TypesF
    : vcg::UsedTypes<vcg::Use<VertexF>::AsVertexType, vcg::Use<EdgeF>::AsEdgeType, vcg::Use<FaceF>::AsFaceType> {};
class VertexF : public vcg::Vertex<TypesF, vcg::vertex::Coord3f, vcg::vertex::BitFlags> {};
class FaceF : public vcg::Face<TypesF, vcg::face::VertexRef, vcg::face::BitFlags> {};
class EdgeF : public vcg::Edge<TypesF, vcg::edge::VertexRef, vcg::edge::BitFlags> {};

template <class Vertex, class Edge, class Face>
class MeshOf : public vcg::tri::TriMesh<std::vector<Vertex>, std::vector<Edge>, std::vector<Face>> {
  public:
    explicit MeshOf(const Shape &shape = {}) {
        using Scalar = typename Vertex::ScalarType;
        using Allocator = vcg::tri::Allocator<MeshOf>;
        if (shape.Size())
            Allocator::AddVertices(*this, shape.position.size());
        for (int i = 0; i < shape.Size(); ++i)
            for (int d = 0; d < 3; ++d)
                this->vert[i].P()[d] = Scalar(shape.position[i][d]);
        if (!shape.face.empty())
            Allocator::AddFaces(*this, shape.face.size());
        for (std::size_t i = 0; i < shape.face.size(); ++i)
            for (int c = 0; c < 3; ++c)
                this->face[i].V(c) = &this->vert[shape.face[i][c]];
        for (const auto &e : shape.edge)
            Allocator::AddEdge(*this, &this->vert[e[0]], &this->vert[e[1]]);
    }

    void DeleteVertex(int i) { vcg::tri::Allocator<MeshOf>::DeleteVertex(*this, this->vert[i]); }
    void DeleteFace(int i) { vcg::tri::Allocator<MeshOf>::DeleteFace(*this, this->face[i]); }
    void DeleteEdge(int i) { vcg::tri::Allocator<MeshOf>::DeleteEdge(*this, this->edge[i]); }

    Eigen::Vector3d At(int i) const {
        const auto &p = this->vert[i].cP();
        return Eigen::Vector3d(p[0], p[1], p[2]);
    }
};
using MeshD = MeshOf<VertexD, EdgeD, FaceD>;
using MeshF = MeshOf<VertexF, EdgeF, FaceF>;

// Miniature meshes.

inline Shape Triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}}; }

/// nx x ny vertices, \p spacing apart, in the plane z = \p z.
inline Shape Grid(int nx, int ny, double spacing = 1, double z = 0) {
    Shape s;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
            s.position.emplace_back(x * spacing, y * spacing, z);
    for (int y = 0; y + 1 < ny; ++y)
        for (int x = 0; x + 1 < nx; ++x) {
            const int i = y * nx + x;
            s.face.push_back({i, i + 1, i + nx + 1});
            s.face.push_back({i, i + nx + 1, i + nx});
        }
    return s;
}

inline Shape Quad() { return Grid(2, 2); }
inline Shape Strip(int n) { return Grid(n, 2); }

/// \p rings circles of \p segments vertices and radius 1 along z from 0 to \p length, open at both ends.
inline Shape Tube(int rings, int segments, double length = 6) {
    Shape s;
    for (int r = 0; r < rings; ++r)
        for (int i = 0; i < segments; ++i) {
            const double a = 2 * M_PI * i / segments;
            s.position.emplace_back(std::cos(a), std::sin(a), length * r / (rings - 1));
        }
    for (int r = 0; r + 1 < rings; ++r)
        for (int i = 0; i < segments; ++i) {
            const int a = r * segments + i, b = r * segments + (i + 1) % segments;
            s.face.push_back({a, b, b + segments});
            s.face.push_back({a, b + segments, a + segments});
        }
    return s;
}

/// Unit sphere: \p rings circles between two poles.
inline Shape Sphere(int rings, int segments) {
    Shape s = Tube(rings, segments);
    for (int r = 0; r < rings; ++r) {
        const double a = M_PI * (r + 1) / (rings + 1);
        for (int i = 0; i < segments; ++i) {
            Eigen::Vector3d &p = s.position[r * segments + i];
            p = Eigen::Vector3d(p[0] * std::sin(a), p[1] * std::sin(a), -std::cos(a));
        }
    }
    const int south = s.Size(), north = south + 1, last = (rings - 1) * segments;
    s.position.emplace_back(0, 0, -1);
    s.position.emplace_back(0, 0, 1);
    for (int i = 0; i < segments; ++i) {
        s.face.push_back({south, (i + 1) % segments, i});
        s.face.push_back({north, last + i, last + (i + 1) % segments});
    }
    return s;
}

/// \p n triangles that share the edge of the vertices 0 and 1.
inline Shape Fan(int n) {
    Shape s{{{0, 0, 0}, {0, 0, 1}}, {}, {}};
    for (int i = 0; i < n; ++i) {
        s.position.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0.5);
        s.face.push_back({0, 1, i + 2});
    }
    return s;
}
inline Shape Fan3() { return Fan(3); }

inline Shape Join(Shape a, const Shape &b) {
    const int n = a.Size();
    a.position.insert(a.position.end(), b.position.begin(), b.position.end());
    for (const auto &f : b.face)
        a.face.push_back({f[0] + n, f[1] + n, f[2] + n});
    for (const auto &e : b.edge)
        a.edge.push_back({e[0] + n, e[1] + n});
    return a;
}

inline Shape Moved(Shape s, const Eigen::Affine3d &motion) {
    for (Eigen::Vector3d &p : s.position)
        p = motion * p;
    return s;
}

/// Two n x n grids, unconnected, \p gap apart; the vertices of the upper one come last.
inline Shape TwoSheets(int n, double gap) { return Join(Grid(n, n), Grid(n, n, 1, gap)); }

/// The same faces, each with vertices of its own.
inline Shape Unwelded(const Shape &s) {
    Shape u;
    for (const auto &f : s.face) {
        const int n = u.Size();
        for (int c : f)
            u.position.push_back(s.position[c]);
        u.face.push_back({n, n + 1, n + 2});
    }
    return u;
}
inline Shape UnweldedGrid(int nx, int ny) { return Unwelded(Grid(nx, ny)); }

/// \p n random points in the unit cube.
inline Shape PointCloud(int n, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    Shape s;
    for (int i = 0; i < n; ++i) {
        const double x = unit(random), y = unit(random), z = unit(random);
        s.position.emplace_back(x, y, z);
    }
    return s;
}

/// Vertices without faces.
inline Shape Points(const Shape &s) { return {s.position, {}, {}}; }

/// The grid's border and rows as edge elements, without faces.
inline Shape Wireframe(int nx, int ny) {
    Shape s = Points(Grid(nx, ny));
    for (int i = 0; i < nx * ny; ++i) {
        if (i % nx + 1 < nx)
            s.edge.push_back({i, i + 1});
        if (i + nx < nx * ny)
            s.edge.push_back({i, i + nx});
    }
    return s;
}

/// Each position moved by up to \p amount along each axis.
inline Shape Jittered(Shape s, double amount, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> offset(-amount, amount);
    for (Eigen::Vector3d &p : s.position)
        for (int d = 0; d < 3; ++d)
            p[d] += offset(random);
    return s;
}

} // namespace fcd_test

#endif
