// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_cases.h"

#include "case_files.h"
#include "cgal_deformation.h"

#include <meshes/benchmark_shapes.h>

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <vcg/complex/algorithms/refine.h>

namespace benchmark {
namespace {

// ---------------------------------------------------------------------------------------------------------- motions --

Matrix4d Translation(double x, double y, double z) { return RigidMotion(0, Vector3d::UnitZ(), {x, y, z}); }

/// A rotation about an axis through a point.
Matrix4d Turn(double degrees, const Vector3d &axis, const Vector3d &point) {
    const Matrix4d turn = RigidMotion(degrees, axis, Vector3d::Zero());
    return RigidMotion(degrees, axis, point - turn.topLeftCorner<3, 3>() * point);
}

/// What the end `to` makes when the straight line from `from` becomes an arc of the same length.
Matrix4d Bend(double degrees, const Vector3d &axis, const Vector3d &from, const Vector3d &to) {
    const double angle = degrees * pi / 180, radius = (to - from).norm() / angle;
    const Vector3d along = (to - from).normalized(), aside = axis.cross(along);
    const Vector3d end = from + radius * (std::sin(angle) * along + (1 - std::cos(angle)) * aside);
    const Matrix4d turn = RigidMotion(degrees, axis, Vector3d::Zero());
    return RigidMotion(degrees, axis, end - turn.topLeftCorner<3, 3>() * to);
}

// ---------------------------------------------------------------------------------------------------------- training
// --

/// Three quarters of a torus of radii 4 and 1, closed, twisted by 150 degrees.
class Torus : public Tube {
  public:
    Torus() : Tube({{0, begin, end, whole}, {4 * begin, 4 * (end - begin), 4 * (whole - end)}}, 1) {}
    int Tag(const Vector3d &p) const override {
        double a = std::atan2(p.z(), p.x());
        if (a < -pi / 4) // the gap is between the end, at -90 degrees, and the begin, at 0
            a += 2 * pi;
        return TagBetween(a, begin, end, 1e-4);
    }
    std::vector<Matrix4d> Motions() const override { return {Turn(150, Vector3d::UnitX(), {0, 0, -4})}; }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        const Vector3d d = Tube::Map(q);
        return {(4 + d.x()) * std::cos(q.z()), d.y(), (4 + d.x()) * std::sin(q.z())};
    }

  private:
    static constexpr double whole = 1.5 * pi, begin = 0.15, end = whole - 0.15;
};

/// An ellipsoid with bumps, its ends bent by 60 degrees against each other.
class Potato : public Shape {
  public:
    Potato()
        : Shape(BlockSurface({Axis{{-1, 1}, {pi / 2}}, Axis{{-1, 1}, {pi / 2 * 1.2}}, Axis{{-1, 1}, {pi / 2 * 2.5}}},
                             Everywhere)) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.z(), -1.9, 1.9, 0); }
    std::vector<Matrix4d> Motions() const override { return {Bend(60, Vector3d::UnitY(), {0, 0, -1.9}, {0, 0, 1.9})}; }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        const Vector3d d = (q * pi / 4).array().tan().matrix().normalized(); // evener than without the tangent
        const double bumps =
            std::sin(5 * d.x() + 1) + std::sin(4 * d.y() + 6 * d.z()) + std::sin(7 * d.z() - 3 * d.x());
        return (1 + 0.06 * bumps) * d.cwiseProduct(Vector3d(1, 1.2, 2.5));
    }
};

/// A closed wavy cone of height 12 from radius about 1.5 to 0.5, bent by 90 degrees.
class Cone : public Tube {
  public:
    Cone() : Tube({{0, 0.6, 11.4, 12}, {0.6, 10.8, 0.6}}, 1) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.z(), 0.6, 11.4, 1e-4); }
    std::vector<Matrix4d> Motions() const override { return {Bend(90, Vector3d::UnitY(), {0, 0, 0.6}, {0, 0, 11.4})}; }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        const double radius = (1.5 - q.z() / 12) * (1 + 0.08 * std::sin(2.2 * q.z()));
        return Tube::Map(q).cwiseProduct(Vector3d(radius, radius, 1));
    }
};

/// A stem that parts in two; one arm is raised, the other one turned aside.
class Fork : public ImplicitShape {
  public:
    Fork() : ImplicitShape(Blocks()) {}
    int Tag(const Vector3d &p) const override { return p.z() <= -4 ? 0 : p.x() <= -2.9 ? 2 : p.x() >= 2.9 ? 3 : 1; }
    std::vector<Matrix4d> Motions() const override {
        const Vector3d joint = Vector3d::Zero();
        return {Turn(50, Vector3d::UnitY(), joint), Turn(60, Vector3d::UnitZ(), joint)};
    }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        return {q.x(), q.y(), q.z() + 2.0 / 3 * std::max(0.0, std::abs(q.x()) - 0.8)};
    }
    Sample Distance(const Vector3d &p) const override {
        const Vector3d joint = Vector3d::Zero();
        Sample s = Round(p, NearestOnSegment<Vector3d>(p, joint, {0, 0, -3.8}), 0.8);
        for (double side : {-1, 1})
            s = SmoothMin(s, Round(p, NearestOnSegment<Vector3d>(p, joint, {side * 3, 0, 2}), 0.7), 0.5);
        return s;
    }

  private:
    static BlockSurface Blocks() {
        return BlockSurface({Axis{{-3.4, -0.8, 0.8, 3.4}, {3.1, 1.26, 3.1}}, Axis{{-0.8, 0.8}, {1.26}},
                             Axis{{-4.6, -0.8, 0.8}, {3.8, 1.26}}},
                            [](const BlockSurface::Lattice &b) { return b[0] == 1 || b[2] == 1; });
    }
};

/// A wavy strip of 100 x 30, open, twisted by 150 degrees.
class Strip : public Shape {
  public:
    Strip()
        : Shape(BlockSurface({Axis{{0, 5, 95, 100}, {5, 90, 5}}, Axis{{0, 30}, {30}}, Axis{{-1, 0}, {1}}}, Everywhere,
                             [](int normal, bool up) { return normal == 2 && up; })) {}
    int Tag(const Vector3d &p) const override { return TagBetween(p.x(), 5, 95, 1e-3); }
    std::vector<Matrix4d> Motions() const override { return {Turn(150, Vector3d::UnitX(), {0, 15, 0})}; }

  protected:
    Vector3d Map(const Vector3d &q) const override {
        const double x = q.x(), y = q.y();
        return {x, y, 0.8 * (std::sin(0.21 * x + 0.4 * y) + std::sin(0.37 * y - 0.53 * x) + std::sin(0.61 * x))};
    }
};

/// A slab of 60 x 40 x 6, held on one side.
class Slab : public Shape {
  public:
    Slab() : Shape(BlockSurface({Axis{{0, 4, 60}, {4, 56}}, Axis{{0, 40}, {40}}, Axis{{-3, 3}, {6}}}, Everywhere)) {}
    int Tag(const Vector3d &p) const override { return p.x() <= 4 + 1e-3 ? 0 : 1; }
    std::vector<Matrix4d> Motions() const override { return {}; }
};

// ---------------------------------------------------------------------------------------------------------- the list
// --

/// A shape with other tags and motions.
template <class Base>
class Posed : public Base {
  public:
    using TagOf = std::function<int(const Vector3d &)>;
    Posed(const TagOf &tag, const std::vector<Matrix4d> &motions) : tag(tag), motions(motions) {}
    int Tag(const Vector3d &p) const override { return tag ? tag(p) : Base::Tag(p); }
    std::vector<Matrix4d> Motions() const override { return motions; }

  private:
    TagOf tag;
    std::vector<Matrix4d> motions;
};

template <class Kind>
std::unique_ptr<Shape> New() {
    return std::make_unique<Kind>();
}

using Motions = std::vector<Matrix4d>;

std::unique_ptr<Shape> PressedPotato() {
    return std::make_unique<Posed<Potato>>(nullptr, Motions{Translation(0.2, 0, -1.5)});
}
std::unique_ptr<Shape> PressedBar() { return std::make_unique<Posed<Bar>>(nullptr, Motions{Translation(6, 0, -26)}); }
/// One arm bends upwards, the rest is held.
std::unique_ptr<Shape> ForkArm() {
    return std::make_unique<Posed<Fork>>([](const Vector3d &p) { return TagBetween(p.x(), 1.3, 2.8, 0); },
                                         Motions{Bend(-60, Vector3d::UnitY(), {1.3, 0, 0.87}, {2.8, 0, 1.87})});
}
/// One arm bends outwards, the rest is held.
std::unique_ptr<Shape> CactusArm() {
    return std::make_unique<Posed<Cactus>>(
        [](const Vector3d &p) { return p.y() < 0.61    ? 0
                                       : p.z() >= 0.79 ? 2
                                                       : 1; },
        Motions{Bend(-70, Vector3d::UnitX(), {0.5, 0.714, 0.62}, {0.5, 0.714, 0.79})});
}
/// The trunk bends, and the arms turn each in its own way.
std::unique_ptr<Shape> CactusHands() {
    return std::make_unique<Posed<Cactus>>(
        [](const Vector3d &p) {
            return p.y() < 0.4 && p.z() >= 0.73 ? 3 : p.y() > 0.6 && p.z() >= 0.79 ? 4 : Cactus().Tag(p);
        },
        Motions{Bend(-40, Vector3d::UnitX(), {0.5, 0.518, 0.153}, {0.5, 0.518, 0.793}),
                Turn(-60, Vector3d::UnitY(), {0.5, 0.286, 0.6}), Turn(-90, Vector3d::UnitX(), {0.5, 0.65, 0.6})});
}
/// One side is held.
std::unique_ptr<Shape> HeldPlane() {
    return std::make_unique<Posed<Plane>>([](const Vector3d &p) { return p.x() <= 4 + 1e-3 ? 0 : 1; }, Motions{});
}

/// A vertex that is a handle, the one nearest to \p at, and how it moves.
struct Point {
    Vector3d at, by;
};

struct Spec {
    std::string name, what;
    Half half;
    std::unique_ptr<Shape> (*make)();
    int vertices;
    std::vector<Point> points = {};
    std::function<bool(const Vector3d &)> refine = nullptr; ///< where it is made 16 times denser
    double keep = 1;                                        ///< share of the edges when it is decimated
};

const std::vector<Spec> &Specs() {
    const Half training = Half::Training, heldOut = Half::HeldOut;
    static const std::vector<Spec> specs = {
        {"torus", "even, closed, thick, twisted by 150 degrees", training, New<Torus>, 4000},
        {"potato_uneven",
         "a part 16 times denser, closed, thick",
         training,
         New<Potato>,
         1500,
         {},
         [](const Vector3d &p) { return p.y() > 0.5; }},
        {"cone_slivers", "decimated to slivers, closed", training, New<Cone>, 6000, {}, nullptr, 0.25},
        {"fork_arm", "a sixth of a scan is free", training, ForkArm, 30000},
        {"fork", "three handles, closed", training, New<Fork>, 5000},
        {"strip", "even, open, thin, twisted by 150 degrees", training, New<Strip>, 4000},
        {"slab_points",
         "single vertices are handles, closed, thin",
         training,
         New<Slab>,
         5000,
         {{{56, 4, 3}, {-8, 0, 16}}, {{56, 36, 3}, {-3, 0, -8}}, {{30, 20, 3}, {0, 0, 6}}}},
        {"potato_press", "pressed to 60 %, closed, thick", training, PressedPotato, 4000},

        {"bar", "even, closed, thick, twisted by 135 degrees", heldOut, New<Bar>, 6084},
        {"cactus", "even, closed, bent by 70 degrees", heldOut, New<Cactus>, 5261},
        {"cylinder", "even, closed, bent by 120 degrees", heldOut, New<Cylinder>, 4802},
        {"plane", "even, open, thin, lifted", heldOut, New<Plane>, 6000},
        {"bar_uneven",
         "a part 16 times denser, closed, thick",
         heldOut,
         New<Bar>,
         1200,
         {},
         [](const Vector3d &p) { return p.z() > 50 && p.z() < 70; }},
        {"cactus_slivers", "decimated to slivers, closed", heldOut, New<Cactus>, 6000, {}, nullptr, 0.4},
        {"cactus_arm", "a tenth of a scan is free", heldOut, CactusArm, 30000},
        {"cactus_hands", "four handles, closed", heldOut, CactusHands, 5261},
        {"plane_points",
         "single vertices are handles, open, thin",
         heldOut,
         HeldPlane,
         5000,
         {{{96, 10, 0}, {-8, 0, 30}}, {{96, 90, 0}, {-5, 0, -15}}, {{50, 50, 10}, {0, 0, 10}}}},
        {"bar_press", "pressed to 60 %, closed, thick", Half::Buckles, PressedBar, 4000},
    };
    return specs;
}

// ------------------------------------------------------------------------------------------------------------ meshes
// --

std::unique_ptr<Problem> ToProblem(const std::vector<Vector3d> &position,
                                   const std::vector<std::array<int, 3>> &faces) {
    auto problem = std::make_unique<Problem>();
    Mesh &mesh = problem->mesh;
    vcg::tri::Allocator<Mesh>::AddVertices(mesh, position.size());
    for (std::size_t i = 0; i < position.size(); ++i)
        mesh.vert[i].P() = vcg::Point3d(position[i].x(), position[i].y(), position[i].z());
    vcg::tri::Allocator<Mesh>::AddFaces(mesh, faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            mesh.face[f].V(corner) = &mesh.vert[faces[f][corner]];
    vcg::tri::UpdateBounding<Mesh>::Box(mesh);
    return problem;
}

// vcg refines meshes that know the neighbours of their faces.
class RefinedVertex;
class RefinedFace;
struct RefinedTypes : vcg::UsedTypes<vcg::Use<RefinedVertex>::AsVertexType, vcg::Use<RefinedFace>::AsFaceType> {};
class RefinedVertex : public vcg::Vertex<RefinedTypes, vcg::vertex::Coord3d, vcg::vertex::BitFlags> {};
class RefinedFace : public vcg::Face<RefinedTypes, vcg::face::VertexRef, vcg::face::FFAdj, vcg::face::BitFlags> {};
class RefinedMesh : public vcg::tri::TriMesh<std::vector<RefinedVertex>, std::vector<RefinedFace>> {};

/// Halves the edges whose middle lies there, twice: each face becomes sixteen, and their neighbours fit.
std::unique_ptr<Problem> Refined(const Mesh &coarse, const std::function<bool(const Vector3d &)> &there) {
    RefinedMesh mesh;
    vcg::tri::Append<RefinedMesh, Mesh>::MeshCopyConst(mesh, coarse);
    const auto chosen = [&](const vcg::face::Pos<RefinedFace> &edge) {
        const vcg::Point3d p = (edge.V()->cP() + edge.VFlip()->cP()) / 2;
        return there({p[0], p[1], p[2]});
    };
    for (int level = 0; level < 2; ++level) {
        vcg::tri::UpdateTopology<RefinedMesh>::FaceFace(mesh);
        vcg::tri::MidPoint<RefinedMesh> middle(&mesh);
        vcg::tri::RefineE(mesh, middle, chosen);
    }
    std::vector<Vector3d> position;
    std::vector<std::array<int, 3>> faces;
    for (const RefinedVertex &v : mesh.vert)
        position.emplace_back(v.cP()[0], v.cP()[1], v.cP()[2]);
    for (const RefinedFace &f : mesh.face)
        faces.push_back({int(vcg::tri::Index(mesh, f.cV(0))), int(vcg::tri::Index(mesh, f.cV(1))),
                         int(vcg::tri::Index(mesh, f.cV(2)))});
    return ToProblem(position, faces);
}

/// Collapses edges by what it costs in shape alone, as scans are decimated when nobody asks for good triangles. The
/// vertices that are left stay where they are, and those that are held are left.
struct Decimator {
    using Vertices = std::map<Kernel::Point_3, int>;
    const Vertices &numberOf;
    const std::vector<int> &tag;

    template <class Profile>
    boost::optional<Kernel::Point_3> operator()(const Profile &edge) const {
        const bool held0 = tag[numberOf.at(edge.p0())] != 1, held1 = tag[numberOf.at(edge.p1())] != 1;
        if (held0 && held1)
            return boost::none;
        return held1 ? edge.p1() : edge.p0();
    }
};

std::unique_ptr<Problem> Decimated(const Problem &fine, double keep, std::vector<int> &inFine) {
    namespace Simplification = CGAL::Surface_mesh_simplification;
    Surface surface = ToCgal(fine.mesh);
    Decimator::Vertices numberOf;
    for (Surface::Vertex_index v : vertices(surface))
        numberOf[surface.point(v)] = int(v);
    Simplification::edge_collapse(surface, Simplification::Count_ratio_stop_predicate<Surface>(keep),
                                  CGAL::parameters::get_cost(Simplification::LindstromTurk_cost<Surface>())
                                      .get_placement(Decimator{numberOf, fine.handles.tag}));
    surface.collect_garbage();
    std::vector<Vector3d> position;
    std::vector<std::array<int, 3>> faces;
    for (Surface::Vertex_index v : vertices(surface)) {
        const Kernel::Point_3 &p = surface.point(v);
        position.emplace_back(p.x(), p.y(), p.z());
        inFine.push_back(numberOf.at(p));
    }
    for (Surface::Face_index f : surface.faces()) {
        const Surface::Halfedge_index h = surface.halfedge(f);
        faces.push_back({int(surface.source(h)), int(surface.target(h)), int(surface.target(surface.next(h)))});
    }
    auto problem = ToProblem(position, faces);
    for (int v : inFine)
        problem->handles.tag.push_back(fine.handles.tag[v]);
    problem->handles.motion = fine.handles.motion;
    return problem;
}

Instance Make(const Spec &spec) {
    const std::unique_ptr<Shape> shape = spec.make();
    shape->Resolve(spec.vertices);
    std::vector<Vector3d> position;
    std::vector<std::array<int, 3>> faces;
    shape->ForEachPosition([&](const Vector3d &p) { position.push_back(p); });
    ForEachTriangle(*shape, [&](Index a, Index b, Index c) { faces.push_back({a, b, c}); });
    Instance made;
    made.problem = ToProblem(position, faces);
    if (spec.refine)
        made.problem = Refined(made.problem->mesh, spec.refine);

    const Mesh &mesh = made.problem->mesh;
    vcg::fcd::Handles &handles = made.problem->handles;
    for (const Vertex &v : mesh.vert)
        handles.tag.push_back(shape->Tag({v.cP()[0], v.cP()[1], v.cP()[2]}));
    int next = 2;
    for (const Matrix4d &motion : shape->Motions())
        handles.motion[next++] = vcg::fcd::Motion(motion);
    for (const Point &point : spec.points) {
        const vcg::Point3d at(point.at.x(), point.at.y(), point.at.z());
        const auto nearest =
            std::min_element(mesh.vert.begin(), mesh.vert.end(), [&](const Vertex &a, const Vertex &b) {
                return vcg::SquaredDistance(a.cP(), at) < vcg::SquaredDistance(b.cP(), at);
            });
        handles.tag[nearest - mesh.vert.begin()] = next;
        handles.motion[next++] = vcg::fcd::Motion(Translation(point.by.x(), point.by.y(), point.by.z()));
    }
    if (spec.keep < 1) {
        made.fine = std::move(made.problem);
        made.problem = Decimated(*made.fine, spec.keep, made.inFine);
    }
    return made;
}

} // namespace

std::vector<Case> MakeCases() {
    std::vector<Case> cases;
    for (const Spec &spec : Specs())
        cases.push_back({spec.name, spec.what, spec.half, [&spec] { return Make(spec); }});
    return cases;
}

Case CaseOfFiles(const std::string &stem) {
    return {NameOf(stem), stem, Half::Given, [stem] {
                Instance read;
                read.problem = std::make_unique<Problem>();
                ReadCase(stem, read.problem->mesh, read.problem->handles);
                return read;
            }};
}

} // namespace benchmark
