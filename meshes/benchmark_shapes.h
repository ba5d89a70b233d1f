// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BENCHMARK_SHAPES_H
#define FCD_BENCHMARK_SHAPES_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

/// Shapes for benchmarks, from formulas and therefore at any resolution.
///
/// Every shape is the surface of a few axis-aligned blocks, cut into a grid of nearly square cells and then mapped to
/// its place. The grid is never stored: a vertex number follows from its place in the grid, so the memory needed is one
/// position per vertex for the shapes whose vertices are evened out on an implicit surface, and nothing for the others.
namespace benchmark {

using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Index = std::int32_t;

inline constexpr double pi = 3.14159265358979323846;

// ------------------------------------------------------------------------------------------------ surface of blocks --

/// The lattice of a block surface along one axis.
struct Axis {
    std::vector<double> plane; ///< coordinates of the lattice planes, ascending, [slabs + 1]
    std::vector<double>
        width; ///< width of each slab on the finished surface, in mesh units, [slabs]; sets its cell count
};

/// The surface of some blocks of a lattice, each slab of the lattice cut into cells.
///
/// The lattice elements on the surface are corners, edges and quads. Vertices are numbered corners first, then the
/// inner ones of each edge along its axis, then the inner ones of each quad. A quad of normal axis n has its own axes
/// u = n + 1 and v = n + 2 (mod 3).
class BlockSurface {
  public:
    using Lattice = std::array<int, 3>;
    struct Quad {
        int normal;         ///< axis of the normal
        bool outwardsUp;    ///< whether the outside is in the direction of the axis
        Lattice low;        ///< lattice point with the smallest coordinates
        Index base;         ///< number of the first inner vertex
        Index corner[2][2]; ///< [u][v]
        Index edgeU[2];     ///< first inner vertex of the edges along u, at v low and high
        Index edgeV[2];     ///< first inner vertex of the edges along v, at u low and high
    };

    /// \param solid  tells whether the block at a lattice point is part of the body
    /// \param keep   tells whether a quad (normal axis, outwards up) belongs to the surface; all do for a closed one
    BlockSurface(
        std::array<Axis, 3> axes, const std::function<bool(const Lattice &)> &solid,
        const std::function<bool(int, bool)> &keep = [](int, bool) { return true; })
        : axis(std::move(axes)) {
        for (int a = 0; a < 3; ++a)
            cells[a].assign(axis[a].width.size(), 1);
        auto isSolid = [&](const Lattice &b) {
            for (int a = 0; a < 3; ++a)
                if (b[a] < 0 || b[a] >= int(axis[a].width.size()))
                    return false;
            return solid(b);
        };
        Lattice b;
        for (b[2] = 0; b[2] < int(axis[2].width.size()); ++b[2])
            for (b[1] = 0; b[1] < int(axis[1].width.size()); ++b[1])
                for (b[0] = 0; b[0] < int(axis[0].width.size()); ++b[0])
                    if (isSolid(b))
                        for (int n = 0; n < 3; ++n)
                            for (bool up : {false, true}) {
                                Lattice next = b, low = b;
                                next[n] += up ? 1 : -1;
                                low[n] += up;
                                if (!isSolid(next) && keep(n, up))
                                    AddQuad(n, up, low);
                            }
        Number();
    }

    /// Cuts the slabs so that cells are about h wide.
    void Subdivide(double h) {
        for (int a = 0; a < 3; ++a)
            for (std::size_t s = 0; s < cells[a].size(); ++s)
                cells[a][s] = std::max(1, int(std::lround(axis[a].width[s] / h)));
        Number();
    }

    /// Cuts the slabs into 2^levels times fewer cells than `fine`.
    void Coarsen(const BlockSurface &fine, int levels) {
        for (int a = 0; a < 3; ++a)
            for (std::size_t s = 0; s < cells[a].size(); ++s)
                cells[a][s] = std::max(1, int(std::ceil(std::ldexp(fine.cells[a][s], -levels))));
        Number();
    }

    /// Finds the cell width whose vertex count is nearest to `count`, and cuts the slabs accordingly.
    void SubdivideToCount(std::int64_t count) {
        double low = 1e-9, high = 1e9; // too many and too few vertices
        for (int i = 0; i < 100; ++i) {
            const double mid = std::sqrt(low * high);
            Subdivide(mid);
            (vertices > count ? low : high) = mid;
        }
        Subdivide(low);
        const std::int64_t above = vertices;
        Subdivide(high);
        if (above - count < count - vertices)
            Subdivide(low);
        if (vertices > 1000000000)
            throw std::runtime_error("more than a billion vertices are not supported");
    }

    std::int64_t VertexCount() const { return vertices; }
    std::int64_t CellCount() const {
        std::int64_t n = 0;
        for (const Quad &q : quads)
            n += std::int64_t(CellsU(q)) * CellsV(q);
        return n;
    }
    const std::vector<Quad> &Quads() const { return quads; }
    /// Number of cells along u and v.
    int CellsU(const Quad &q) const { return Cells(U(q), q.low); }
    int CellsV(const Quad &q) const { return Cells(V(q), q.low); }

    /// Number of the vertex (i, j) of a quad, 0 <= i <= CellsU, 0 <= j <= CellsV.
    Index Vertex(const Quad &q, int i, int j) const {
        const int nu = CellsU(q), nv = CellsV(q);
        const bool innerI = i > 0 && i<nu, innerJ = j> 0 && j < nv;
        if (innerI && innerJ)
            return q.base + Index(i - 1) * (nv - 1) + (j - 1);
        if (innerI)
            return q.edgeU[j > 0] + i - 1;
        if (innerJ)
            return q.edgeV[i > 0] + j - 1;
        return q.corner[i > 0][j > 0];
    }

    /// Lattice position of the vertex (i, j) of a quad.
    Vector3d LatticePoint(const Quad &q, int i, int j) const {
        Vector3d p;
        p[q.normal] = axis[q.normal].plane[q.low[q.normal]];
        p[U(q)] = Between(U(q), q.low[U(q)], i);
        p[V(q)] = Between(V(q), q.low[V(q)], j);
        return p;
    }

    /// Calls visit(lattice position) for every vertex in the order of the numbers.
    template <class Visit>
    void ForEachVertex(Visit visit) const {
        for (const auto &[c, id] : SortedByValue(corners))
            visit(Vector3d(axis[0].plane[c[0]], axis[1].plane[c[1]], axis[2].plane[c[2]]));
        for (const auto &[e, id] : SortedByValue(edges)) {
            const int a = e.first;
            Vector3d p(axis[0].plane[e.second[0]], axis[1].plane[e.second[1]], axis[2].plane[e.second[2]]);
            for (int i = 1; i < Cells(a, e.second); ++i) {
                p[a] = Between(a, e.second[a], i);
                visit(p);
            }
        }
        for (const Quad &q : quads)
            for (int i = 1; i < CellsU(q); ++i)
                for (int j = 1; j < CellsV(q); ++j)
                    visit(LatticePoint(q, i, j));
    }

    /// Calls visit(quad, i, j, a, b, c, d) for every cell: a is the vertex (i, j), and a, b, c, d run counter-clockwise
    /// seen from outside.
    template <class Visit>
    void ForEachCell(Visit visit) const {
        for (const Quad &q : quads)
            for (int i = 0; i < CellsU(q); ++i)
                for (int j = 0; j < CellsV(q); ++j) {
                    Index b = Vertex(q, i + 1, j), d = Vertex(q, i, j + 1);
                    if (!q.outwardsUp)
                        std::swap(b, d);
                    visit(q, i, j, Vertex(q, i, j), b, Vertex(q, i + 1, j + 1), d);
                }
    }

  private:
    static int U(const Quad &q) { return (q.normal + 1) % 3; }
    static int V(const Quad &q) { return (q.normal + 2) % 3; }
    int Cells(int a, const Lattice &low) const { return cells[a][low[a]]; }
    double Between(int a, int slab, int i) const {
        const double t = double(i) / cells[a][slab];
        return (1 - t) * axis[a].plane[slab] + t * axis[a].plane[slab + 1];
    }

    template <class Key>
    static std::vector<std::pair<Key, int>> SortedByValue(const std::map<Key, int> &m) {
        std::vector<std::pair<Key, int>> v(m.begin(), m.end());
        std::sort(v.begin(), v.end(), [](const auto &a, const auto &b) { return a.second < b.second; });
        return v;
    }

    void AddQuad(int n, bool up, const Lattice &low) {
        Quad q{n, up, low, 0, {}, {}, {}};
        for (int i : {0, 1}) {
            Lattice atU = low, atV = low;
            atU[U(q)] += i;
            atV[V(q)] += i;
            edges.emplace(std::make_pair(U(q), atV), int(edges.size()));
            edges.emplace(std::make_pair(V(q), atU), int(edges.size()));
            for (int j : {0, 1}) {
                Lattice c = atU;
                c[V(q)] += j;
                corners.emplace(c, int(corners.size()));
            }
        }
        quads.push_back(q);
    }

    void Number() {
        vertices = std::int64_t(corners.size());
        std::vector<std::int64_t> edgeBase;
        for (const auto &[e, id] : SortedByValue(edges)) {
            edgeBase.push_back(vertices);
            vertices += Cells(e.first, e.second) - 1;
        }
        for (Quad &q : quads) {
            for (int i : {0, 1}) {
                Lattice atU = q.low, atV = q.low;
                atU[U(q)] += i;
                atV[V(q)] += i;
                q.edgeU[i] = Index(edgeBase[edges.at({U(q), atV})]);
                q.edgeV[i] = Index(edgeBase[edges.at({V(q), atU})]);
                for (int j : {0, 1}) {
                    Lattice c = atU;
                    c[V(q)] += j;
                    q.corner[i][j] = corners.at(c);
                }
            }
            q.base = Index(vertices);
            vertices += std::int64_t(CellsU(q) - 1) * (CellsV(q) - 1);
        }
    }

    std::array<Axis, 3> axis;
    std::array<std::vector<int>, 3> cells; // of each slab
    std::map<Lattice, int> corners;
    std::map<std::pair<int, Lattice>, int> edges; // (axis, low end)
    std::vector<Quad> quads;
    std::int64_t vertices = 0;
};

// ----------------------------------------------------------------------------------------------------------- shapes --

/// One test case: where the vertices are, which are tagged, and how the handle moves.
class Shape {
  public:
    explicit Shape(BlockSurface s) : surface(std::move(s)) {}
    virtual ~Shape() = default;

    /// Chooses the resolution; the vertex count is the possible one nearest to `count`.
    void Resolve(std::int64_t count) {
        surface.SubdivideToCount(count);
        Prepare();
    }
    /// Calls visit(position) for every vertex in order.
    virtual void ForEachPosition(const std::function<void(const Vector3d &)> &visit) const {
        surface.ForEachVertex([&](const Vector3d &lattice) { visit(Map(lattice)); });
    }
    /// Tag of a vertex: 0 fixed, 1 free, 2, 3, ... handles.
    virtual int Tag(const Vector3d &p) const = 0;
    /// Motions of the handles 2, 3, ...
    virtual std::vector<Matrix4d> Motions() const = 0;
    /// Whether the cell (i, j) of a quad, with the vertices a, b, c, d, is split from a to c.
    virtual bool SplitAC(const BlockSurface::Quad &, int i, int j, const std::array<Index, 4> &) const {
        return (i + j) % 2 == 0;
    }

    const BlockSurface &Surface() const { return surface; }

  protected:
    virtual void Prepare() {}
    virtual Vector3d Map(const Vector3d &lattice) const { return lattice; }
    BlockSurface surface;
};

/// A rotation about an axis through the origin, then a translation.
inline Matrix4d RigidMotion(double degrees, const Vector3d &axis, const Vector3d &translation) {
    Matrix4d m = Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = Eigen::AngleAxisd(degrees * pi / 180, axis).toRotationMatrix();
    m.topRightCorner<3, 1>() = translation;
    return m;
}

/// Tag by a coordinate: fixed up to one plane, handle from another plane on.
inline int TagBetween(double x, double fixedTo, double handleFrom, double epsilon) {
    return x <= fixedTo + epsilon ? 0 : x >= handleFrom - epsilon ? 2 : 1;
}

inline bool Everywhere(const BlockSurface::Lattice &) { return true; }

/// A bar of 12 x 12 x 74.6, twisted by 135 degrees.
class Bar : public Shape {
  public:
    Bar()
        : Shape(BlockSurface({Axis{{-6, 6}, {12}}, Axis{{-6, 6}, {12}}, Axis{{25.4, 29.9, 95.9, 100}, {4.5, 66, 4.1}}},
                             Everywhere)) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.z(), 29.9, 95.9, 1e-3); }
    std::vector<Matrix4d> Motions() const override { return {RigidMotion(135, Vector3d::UnitZ(), Vector3d::Zero())}; }
};

/// A closed tube: the block [-1, 1] x [-1, 1] x [ends of the slabs], whose sections become discs.
class Tube : public Shape {
  public:
    /// \param slabs  along the tube \param radius  mean, in mesh units
    Tube(const Axis &slabs, double radius)
        : Shape(BlockSurface({Axis{{-1, 1}, {pi / 2 * radius}}, Axis{{-1, 1}, {pi / 2 * radius}}, slabs}, Everywhere)) {
    }
    /// On the caps towards the centre, so that no triangle has three vertices on the rim.
    bool SplitAC(const BlockSurface::Quad &q, int i, int j, const std::array<Index, 4> &v) const override {
        if (q.normal != 2)
            return Shape::SplitAC(q, i, j, v);
        return (2 * i + 1 < surface.CellsU(q)) == (2 * j + 1 < surface.CellsV(q));
    }

  protected:
    /// Squares to circles (Shirley and Chiu's concentric map).
    Vector3d Map(const Vector3d &q) const override {
        const double r = std::max(std::abs(q.x()), std::abs(q.y()));
        if (r == 0)
            return q;
        if (std::abs(q.x()) >= std::abs(q.y())) {
            const double a = pi / 4 * q.y() / q.x();
            return {q.x() * std::cos(a), q.x() * std::sin(a), q.z()};
        }
        const double a = pi / 4 * q.x() / q.y();
        return {q.y() * std::sin(a), q.y() * std::cos(a), q.z()};
    }
};

/// A closed cylinder of radius 1 and height 12, bent by 120 degrees.
class Cylinder : public Tube {
  public:
    Cylinder() : Tube({{0, 0.504, 11.496, 12}, {0.504, 10.992, 0.504}}, 1) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.z(), 0.504, 11.496, 1e-4); }
    std::vector<Matrix4d> Motions() const override {
        return {RigidMotion(-120, Vector3d::UnitY(), Vector3d(3 * std::sqrt(3.0), 0, 9))};
    }
};

/// A sheet of 100 x 100 with thirteen bumps of height 10, one side lifted.
class Plane : public Shape {
  public:
    Plane()
        : Shape(BlockSurface({Axis{{0, 4, 96.5, 100}, {4, 92.5, 3.5}}, Axis{{0, 100}, {100}}, Axis{{-1, 0}, {1}}},
                             Everywhere, [](int normal, bool up) { return normal == 2 && up; })) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.x(), 4, 96.5, 1e-3); }
    std::vector<Matrix4d> Motions() const override {
        return {RigidMotion(0, Vector3d::UnitZ(), Vector3d(-32.3, 0, 56.703))};
    }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        constexpr double pitch = 100.0 / 6, height = 10, sigma = 2.4;
        double z = 0;
        for (int i = 1; i <= 5; ++i)
            for (int j = 1 + (i + 1) % 2; j <= 5; j += 2) { // the bumps alternate like the squares of a chessboard
                const double d2 = (q.head<2>() - Vector2d(i * pitch, j * pitch)).squaredNorm();
                z += height * std::exp(-d2 / (2 * sigma * sigma));
            }
        return {q.x(), q.y(), z};
    }
};

/// The zero set of a function near the surface of some blocks. The vertices of a coarse block model are brought onto it
/// and evened out, again on each finer model, with the result of the coarser one as the start.
class ImplicitShape : public Shape {
  public:
    explicit ImplicitShape(const BlockSurface &blocks) : Shape(blocks), coarse(blocks) {}
    void ForEachPosition(const std::function<void(const Vector3d &)> &visit) const override {
        for (const Vector3f &p : position)
            visit(p.cast<double>());
    }
    /// Along the shorter diagonal.
    bool SplitAC(const BlockSurface::Quad &q, int i, int j, const std::array<Index, 4> &v) const override {
        const float ac = (position[v[0]] - position[v[2]]).squaredNorm();
        const float bd = (position[v[1]] - position[v[3]]).squaredNorm();
        return std::abs(ac - bd) > 0.02f * (ac + bd) ? ac < bd : Shape::SplitAC(q, i, j, v);
    }

  protected:
    void Prepare() override {
        int levels = 0; // a model of less than 400 vertices has too few on a cactus's arm: evening out shortens it
        while (std::ldexp(double(surface.VertexCount()), -2 * levels) > 4 * 400)
            ++levels;
        coarse.Coarsen(surface, levels);
        position.assign(coarse.VertexCount(), Vector3f::Zero());
        for (const auto &q : coarse.Quads())
            for (int i = 0; i <= coarse.CellsU(q); ++i)
                for (int j = 0; j <= coarse.CellsV(q); ++j)
                    position[coarse.Vertex(q, i, j)] = Map(coarse.LatticePoint(q, i, j)).cast<float>();
        Project(12);
        Relax(coarse, 60);
        while (levels > 0) {
            BlockSurface fine = surface;
            fine.Coarsen(surface, --levels);
            Refine(coarse, fine);
            coarse = std::move(fine);
            Relax(coarse, levels < 2 ? 4 : 12);
        }
    }

    struct Sample {
        double value;
        Vector3d gradient;
    };
    /// The function: about the signed distance.
    virtual Sample Distance(const Vector3d &p) const = 0;

    /// Signed distance to the points that are nearer than \p radius to \p nearest.
    static Sample Round(const Vector3d &p, const Vector3d &nearest, double radius) {
        const Vector3d d = p - nearest;
        const double length = d.norm();
        return {length - radius, length > 0 ? Vector3d(d / length) : Vector3d::UnitX()};
    }

    template <class Vector>
    static Vector NearestOnSegment(const Vector &p, const Vector &a, const Vector &b) {
        const double t = (p - a).dot(b - a) / (b - a).squaredNorm();
        return a + std::clamp(t, 0.0, 1.0) * (b - a);
    }

    /// Minimum of two distances, smooth (C2) where they differ by less than `blend`.
    static Sample SmoothMin(const Sample &a, const Sample &b, double blend) {
        const double difference = a.value - b.value;
        if (std::abs(difference) >= blend)
            return difference < 0 ? a : b;
        const double h = 1 - std::abs(difference) / blend;
        const double s = 0.5 * h * h; // d/d|difference| of blend * h^3 / 6, reversed
        const Sample &low = difference < 0 ? a : b, &high = difference < 0 ? b : a;
        return {low.value - blend * h * h * h / 6, (1 - s) * low.gradient + s * high.gradient};
    }

  private:
    Vector3f Projected(const Vector3f &start, int steps) const {
        Vector3d p = start.cast<double>();
        for (int i = 0; i < steps; ++i) {
            const Sample s = Distance(p);
            p -= s.value / std::max(s.gradient.squaredNorm(), 0.25) * s.gradient;
            if (std::abs(s.value) < 1e-9)
                break;
        }
        return p.cast<float>();
    }

    void Project(int steps) {
        for (Vector3f &p : position)
            p = Projected(p, steps);
    }

    /// Moves each vertex towards the area-weighted mean of the centres of its cells, on the surface.
    void Relax(const BlockSurface &s, int rounds) {
        std::vector<Eigen::Vector4f> sum(position.size());
        for (int round = 0; round < rounds; ++round) {
            std::fill(sum.begin(), sum.end(), Eigen::Vector4f::Zero());
            s.ForEachCell([&](const BlockSurface::Quad &, int, int, Index a, Index b, Index c, Index d) {
                const Vector3f diagonal1 = position[c] - position[a], diagonal2 = position[d] - position[b];
                const float area = diagonal1.cross(diagonal2).norm();
                Eigen::Vector4f add;
                add << area * 0.25f * (position[a] + position[b] + position[c] + position[d]), area;
                for (Index v : {a, b, c, d})
                    sum[v] += add;
            });
            for (std::size_t v = 0; v < position.size(); ++v)
                if (sum[v].w() > 0)
                    position[v] = Projected(0.2f * position[v] + 0.8f * sum[v].head<3>() / sum[v].w(), 4);
        }
    }

    /// Brings the positions from a coarse model to a finer one, bilinear in each quad, and back onto the surface.
    void Refine(const BlockSurface &from, const BlockSurface &to) {
        std::vector<Vector3f> result(to.VertexCount());
        for (std::size_t k = 0; k < to.Quads().size(); ++k) {
            const auto &qf = from.Quads()[k], &qt = to.Quads()[k];
            const int nu = from.CellsU(qf), nv = from.CellsV(qf), mu = to.CellsU(qt), mv = to.CellsV(qt);
            for (int i = 0; i <= mu; ++i)
                for (int j = 0; j <= mv; ++j) {
                    const float u = float(i) / mu * nu, v = float(j) / mv * nv;
                    const int iu = std::min(int(u), nu - 1), jv = std::min(int(v), nv - 1);
                    const float s = u - iu, t = v - jv;
                    result[to.Vertex(qt, i, j)] = (1 - s) * ((1 - t) * position[from.Vertex(qf, iu, jv)] +
                                                             t * position[from.Vertex(qf, iu, jv + 1)]) +
                                                  s * ((1 - t) * position[from.Vertex(qf, iu + 1, jv)] +
                                                       t * position[from.Vertex(qf, iu + 1, jv + 1)]);
                }
        }
        position = std::move(result);
        Project(6);
    }

    BlockSurface coarse;
    std::vector<Vector3f> position;
};

/// A cactus, a trunk with two arms, bent by 70 degrees: the smooth union of three tubes.
class Cactus : public ImplicitShape {
  public:
    Cactus() : ImplicitShape(Blocks()) {}
    int Tag(const Vector3d &p) const override {
        const bool trunk = std::hypot(p.x() - centerX, p.y() - trunkY) < trunkRadius * 1.15;
        return p.z() <= 0.153 ? 0 : trunk && p.z() >= 0.793 ? 2 : 1;
    }
    std::vector<Matrix4d> Motions() const override {
        return {RigidMotion(-70, Vector3d::UnitX(), Vector3d(0, -0.1343, 0.8211))};
    }

  protected:
    Sample Distance(const Vector3d &p) const override {
        const Vector2d q(p.y(), p.z());
        const Vector2d nearest =
            NearestOnSegment<Vector2d>(q, {trunkY, bottom + trunkRadius}, {trunkY, top - trunkRadius});
        Sample s = Round(p, {centerX, nearest.x(), nearest.y()}, trunkRadius);
        for (const Arm &arm : arms)
            s = SmoothMin(s, ArmDistance(p, arm), blend);
        return s;
    }

  private:
    struct Arm { // starts inside the trunk, level, turns upwards in a quarter circle, ends in a half sphere
        double side, y, level, top;
    };
    static constexpr double centerX = 0.5, trunkY = 0.518, trunkRadius = 0.0605, bottom = 0.069, top = 0.892;
    static constexpr double armRadius = 0.032, elbow = 0.08, blend = 0.035;
    static constexpr Arm arms[2] = {{-1, 0.286, 0.475, 0.800}, {1, 0.714, 0.580, 0.855}};

    static BlockSurface Blocks() {
        const double r = trunkRadius, a = armRadius, quarter = pi / 2 * r, armQuarter = pi / 2 * a;
        const Arm &l = arms[0], &g = arms[1];
        const double half = (quarter - armQuarter) / 2;
        Axis x{{centerX - r, centerX - a, centerX + a, centerX + r}, {half, armQuarter, half}};
        Axis y{{l.y - a, l.y + a, trunkY - r, trunkY + r, g.y - a, g.y + a}, {}};
        y.width = {armQuarter, y.plane[2] - y.plane[1], quarter, y.plane[4] - y.plane[3], armQuarter};
        Axis z{{bottom, l.level - a, l.level + a, g.level - a, g.level + a, l.top, g.top, top}, {}};
        for (std::size_t s = 0; s + 1 < z.plane.size(); ++s)
            z.width.push_back(z.plane[s + 1] - z.plane[s]);
        z.width[1] = z.width[3] = armQuarter;
        return BlockSurface({x, y, z}, [](const BlockSurface::Lattice &b) {
            if (b[1] == 2)
                return true; // trunk
            const bool left = b[1] < 2, column = b[1] == 0 || b[1] == 4;
            const int level = left ? 1 : 3, last = left ? 4 : 5;
            return b[0] == 1 && (column ? b[2] >= level && b[2] <= last : b[2] == level);
        });
    }

    static Sample ArmDistance(const Vector3d &p, const Arm &arm) {
        const Vector2d q(p.y(), p.z());
        const Vector2d hub(arm.y - arm.side * elbow, arm.level + elbow); // centre of the quarter circle
        Vector2d best = NearestOnSegment<Vector2d>(q, {trunkY, arm.level}, {hub.x(), arm.level});
        const Vector2d upright = NearestOnSegment<Vector2d>(q, {arm.y, hub.y()}, {arm.y, arm.top - armRadius});
        if ((upright - q).squaredNorm() < (best - q).squaredNorm())
            best = upright;
        const Vector2d d = q - hub;
        if (d.x() * arm.side > 0 && d.y() < 0) {
            const Vector2d round = hub + elbow * d.normalized();
            if ((round - q).squaredNorm() < (best - q).squaredNorm())
                best = round;
        }
        return Round(p, {centerX, best.x(), best.y()}, armRadius);
    }
};

/// Calls visit(a, b, c) for every triangle, counter-clockwise seen from outside.
template <class Visit>
void ForEachTriangle(const Shape &shape, Visit visit) {
    shape.Surface().ForEachCell([&](const BlockSurface::Quad &q, int i, int j, Index a, Index b, Index c, Index d) {
        if (shape.SplitAC(q, i, j, {a, b, c, d})) {
            visit(a, b, c);
            visit(a, c, d);
        } else {
            visit(a, b, d);
            visit(b, c, d);
        }
    });
}

} // namespace benchmark

#endif
