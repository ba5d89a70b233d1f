// SPDX-License-Identifier: GPL-3.0-or-later
#include "loose_parts.h"
#include "test_support.h"

#include <map>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using vcg::tri::FindLoose;
using vcg::tri::LooseMotions;
using vcg::tri::ReadFreeSurface;

static LooseSurface LooseOf(const MeshD &mesh, const Handles &handles, SurfaceGraph &surface, unsigned threads = 0) {
    surface = ReadFreeSurface(mesh, handles.tag, {}, Eigen::Matrix3d::Identity(), Threads(threads));
    return FindLoose(mesh, handles, surface, surface.tag, Threads(threads));
}

/// Tubes, spheres, triangles and single vertices, each held in places or not at all.
static Case Things(unsigned seed) {
    Case c{Shape(), Handles()};
    std::mt19937 random(seed);
    const std::vector<Shape> kinds{Tube(6, 8), Sphere(4, 6), Triangle(), Shape{{{0, 0, 0}}, {}, {}}, Grid(4, 4)};
    for (int i = 0; i < 25; ++i) {
        const Shape thing = Moved(kinds[i % 5], Affine3d(Eigen::Translation3d(10 * (i % 6), 10 * (i / 6), 0)));
        const int tag = int(random() % 4) - 1, every = tag == 1 ? 1 : int(random() % 4) + 1;
        for (int v = 0; v < thing.Size(); ++v)
            c.handles.tag.push_back(random() % every ? 1 : tag);
        c.shape = Join(std::move(c.shape), thing);
    }
    return c;
}

TEST(FindLoose, IsWhatNothingHolds) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Case c = Things(seed);
        const MeshD mesh(c.shape);
        SurfaceGraph surface;
        const LooseSurface loose = LooseOf(mesh, c.handles, surface);
        // Components of the free vertices and of what is held at the same place or beside them.
        const int n = c.shape.Size();
        UnionFind sets(n);
        std::map<std::array<double, 3>, int> first;
        std::vector<char> isAlone(n, 1);
        for (int i = 0; i < n; ++i) {
            const Vector3d &p = c.shape.position[i];
            sets.Join(i, first.emplace(std::array<double, 3>{p[0], p[1], p[2]}, i).first->second);
        }
        for (const auto &f : c.shape.face)
            if (c.handles.tag[f[0]] == 1 || c.handles.tag[f[1]] == 1 || c.handles.tag[f[2]] == 1)
                for (int corner : f) {
                    sets.Join(f[0], corner);
                    isAlone[corner] = 0;
                }
        std::set<Index> held, all;
        for (int i = 0; i < n; ++i)
            if (c.handles.tag[i] != 1)
                held.insert(sets.Root(i));
        std::map<Index, Index> partOf; // by root
        std::set<Index> parts;
        Index isolated = 0;
        for (int i = 0; i < n; ++i) {
            const bool isLoose = c.handles.tag[i] == 1 && !held.count(sets.Root(i));
            const Index part = loose.partOf.empty() ? -1 : loose.partOf[i];
            ASSERT_EQ(part >= 0, isLoose) << i;
            if (c.handles.tag[i] == 1)
                all.insert(sets.Root(i));
            if (!isLoose)
                continue;
            ASSERT_LT(part, loose.parts);
            EXPECT_EQ(partOf.emplace(sets.Root(i), part).first->second, part);
            parts.insert(part);
            isolated += isAlone[i];
        }
        EXPECT_EQ(Index(parts.size()), loose.parts);
        EXPECT_EQ(Index(partOf.size()), loose.parts);
        EXPECT_EQ(loose.isolated, isolated);
        EXPECT_EQ(loose.components, Index(all.size()));
        EXPECT_EQ(loose.isPartOfSurface, loose.parts > loose.isolated);
        // Read without them, the surface is held everywhere.
        const SurfaceGraph rest = ReadFreeSurface(mesh, c.handles.tag, loose.partOf, Eigen::Matrix3d::Identity(), {});
        for (int i = 0; i < n; ++i) {
            if (!loose.partOf.empty() && loose.partOf[i] >= 0) {
                EXPECT_EQ(rest.nodeOf[i], -1);
            } else {
                EXPECT_EQ(rest.nodeOf[i] >= 0, surface.nodeOf[i] >= 0);
            }
        }
        EXPECT_FALSE(FindLoose(mesh, c.handles, rest, rest.tag, {}).isPartOfSurface);
        for (unsigned threads : {1u, 7u}) {
            const LooseSurface same = LooseOf(mesh, c.handles, surface, threads);
            EXPECT_EQ(same.partOf, loose.partOf);
            EXPECT_EQ(same.parts, loose.parts);
        }
    }
}

TEST(FindLoose, FindsNoneWhereAllIsHeld) {
    const Case c = CaseOf(Tube(12, 8), [](const Vector3d &p) { return TubeTag(p); });
    SurfaceGraph surface;
    const LooseSurface loose = LooseOf(MeshD(c.shape), c.handles, surface);
    EXPECT_TRUE(loose.partOf.empty());
    EXPECT_EQ(loose.parts, 0);
    EXPECT_EQ(loose.components, 1);
    EXPECT_FALSE(loose.isPartOfSurface);
}

TEST(FindLoose, APointHandleOnAnIsolatedVertexIsNotLoose) {
    Case c = CaseOf(Join(Tube(12, 8), Shape{{{3, 0, 0}, {4, 0, 0}}, {}, {}}),
                    [](const Vector3d &p) { return p[0] > 2 ? 1 : TubeTag(p); });
    c.handles.point = {{97, Vector3d(1, 2, 3)}};
    SurfaceGraph surface;
    const LooseSurface loose = LooseOf(MeshD(c.shape), c.handles, surface);
    EXPECT_EQ(loose.parts, 1);
    EXPECT_EQ(loose.partOf[96], 0);
    EXPECT_EQ(loose.partOf[97], -1);
}

/// A fixed plate at x = 0, a handle's at x = 10, and between them, held by none, specks.
struct Plates {
    Case c;
    std::vector<Index> speckOf; // of each vertex
    std::map<Index, Matrix4d> motion{{0, Matrix4d::Identity()}, {2, bend.matrix()}};
    SurfaceGraph surface;
    LooseSurface loose;

    Plates() {
        const Shape plate = Moved(Grid(5, 5), Affine3d(Eigen::AngleAxisd(1, Vector3d::UnitY())));
        c.shape = Join(plate, Moved(plate, Affine3d(Eigen::Translation3d(10, 0, 0))));
        c.handles.tag.assign(25, 0);
        c.handles.tag.resize(50, 2);
        speckOf.assign(50, -1);
        for (int i = 0; i < 8; ++i) {
            c.shape = Join(std::move(c.shape),
                           Moved(Sphere(3, 5), Affine3d(Eigen::Translation3d(i + 1.2, 2, 8) * Eigen::Scaling(0.1))));
            c.handles.tag.resize(c.shape.position.size(), 1);
            speckOf.resize(c.shape.position.size(), i);
        }
        c.handles.motion[2] = Motion(bend.matrix());
        loose = LooseOf(MeshD(c.shape), c.handles, surface);
    }
    std::vector<Matrix4d> Motions(bool follow) const {
        return LooseMotions(MeshD(c.shape), c.handles, surface, loose, follow, motion, {},
                            [](Index, const Vector3d &) -> Affine3d { throw Error("nothing bends here"); });
    }
};

TEST(LooseMotions, AreThoseOfTheNearestHeldPlace) {
    const Plates plates;
    ASSERT_EQ(plates.loose.parts, 8);
    const std::vector<Matrix4d> follow = plates.Motions(true), stay = plates.Motions(false);
    ASSERT_EQ(follow.size(), 8u);
    std::map<Index, int> with;
    for (Index part = 0; part < 8; ++part) {
        double nearest = 1e9;
        Index tag = -1;
        for (int i = 50; i < plates.c.shape.Size(); ++i)
            if (plates.loose.partOf[i] == part)
                for (int j = 0; j < 50; ++j) {
                    const double d = (plates.c.shape.position[i] - plates.c.shape.position[j]).norm();
                    if (d < nearest) {
                        nearest = d;
                        tag = plates.c.handles.tag[j];
                    }
                }
        ++with[tag];
        EXPECT_LE((follow[part] - plates.motion.at(tag)).norm(), 1e-12) << "part " << part;
        if (tag == 0) {
            EXPECT_EQ(follow[part], Matrix4d::Identity()) << "to the bit";
        }
        EXPECT_EQ(stay[part], Matrix4d::Identity());
    }
    EXPECT_GT(with[0], 1);
    EXPECT_GT(with[2], 1);
}

TEST(LooseMotions, AreRigidThoughTheHandleScales) {
    Plates plates;
    Affine3d large = bend;
    large.linear() *= 2;
    plates.motion[2] = large.matrix();
    for (const Matrix4d &m : plates.Motions(true)) {
        EXPECT_TRUE((m.topLeftCorner<3, 3>() * m.topLeftCorner<3, 3>().transpose()).isIdentity(1e-12));
        EXPECT_EQ(m.row(3), Eigen::RowVector4d(0, 0, 0, 1));
    }
}

TEST(LooseMotions, AreThoseOfTheSurfaceThatBends) {
    const Shape button = Moved(Sphere(4, 6), Affine3d(Eigen::Translation3d(1.4, 0, 3) * Eigen::Scaling(0.1)));
    const Case c = CaseOf(Join(Tube(40, 16), button), [](const Vector3d &p) { return p[0] > 1.1 ? 1 : TubeTag(p); });
    const MeshD mesh(c.shape);
    SurfaceGraph surface;
    const LooseSurface loose = LooseOf(mesh, c.handles, surface);
    ASSERT_EQ(loose.parts, 1);
    const Affine3d there = RandomRigid(3); // mesh units
    Vector3d at(0, 0, 0);
    const std::vector<Matrix4d> motion =
        LooseMotions(mesh, c.handles, surface, loose, true, {{0, Matrix4d::Identity()}, {2, bend.matrix()}}, {},
                     [&](Index u, const Vector3d &p) {
                         EXPECT_EQ(surface.tag[u], 1);
                         at = surface.frame.FromFrame(p);
                         return surface.frame.ToFrame(there.matrix());
                     });
    EXPECT_LE((at - Vector3d(1, 0, 3)).norm(), 0.2) << "the nearest place of the tube";
    EXPECT_LE((motion[0] - there.matrix()).norm(), 1e-12);
}

TEST(LooseMotions, TakesASingleHeldVertexAndNone) {
    const Case c{Join(Triangle(), Shape{{{9, 9, 9}}, {}, {}}), {{1, 1, 1, 2}, {}, {}}};
    const MeshD mesh(c.shape);
    SurfaceGraph surface;
    const LooseSurface loose = LooseOf(mesh, c.handles, surface);
    ASSERT_EQ(loose.parts, 1);
    const auto never = [](Index, const Vector3d &) { return Affine3d::Identity(); };
    const std::vector<Matrix4d> with =
        LooseMotions(mesh, c.handles, surface, loose, true, {{0, Matrix4d::Identity()}, {2, bend.matrix()}}, {}, never);
    EXPECT_LE((with[0] - bend.matrix()).norm(), 1e-12);
    const Handles free{{1, 1, 1, 1}, {}, {}};
    const LooseSurface all = LooseOf(mesh, free, surface);
    EXPECT_EQ(all.parts, 2);
    for (const Matrix4d &m : LooseMotions(mesh, free, surface, all, true, {}, {}, never))
        EXPECT_EQ(m, Matrix4d::Identity());
}
