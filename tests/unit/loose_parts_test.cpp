// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/loose_parts.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/centroidal_deformation.h>
#include "test_support.h"

#include <map>
#include <set>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using vcg::tri::DeformCentroidal;

static std::vector<std::size_t> PointsOf(const Handles &handles) {
    std::vector<std::size_t> slot;
    for (const PointHandle &point : handles.point)
        slot.push_back(point.vertex);
    return slot;
}

static LooseSurface LooseOf(const MeshD &mesh, const Handles &handles, SurfaceGraph &surface, unsigned threads = 0) {
    surface = ReadFreeSurface(Read(mesh), handles.tag, Eigen::Matrix3d::Identity(), Threads(threads));
    return FindLoose(handles.tag, PointsOf(handles), surface, FindComponents(surface, surface.tag, Threads(threads)),
                     Threads(threads));
}

/// Tubes, spheres, triangles and single vertices, each partly held or loose.
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
        // Components of the free vertices, with held ones at the same position or beside them.
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
        // Without loose parts, the surface is all held.
        std::vector<int> tag = c.handles.tag;
        for (std::size_t i = 0; i < loose.partOf.size(); ++i)
            if (loose.partOf[i] >= 0)
                tag[i] = noVertex;
        const SurfaceGraph rest = ReadFreeSurface(Read(mesh), tag, Eigen::Matrix3d::Identity(), {});
        for (int i = 0; i < n; ++i) {
            if (!loose.partOf.empty() && loose.partOf[i] >= 0) {
                EXPECT_EQ(rest.nodeOf[i], -1);
            } else {
                EXPECT_EQ(rest.nodeOf[i] >= 0, surface.nodeOf[i] >= 0);
            }
        }
        EXPECT_FALSE(FindLoose(tag, {}, rest, FindComponents(rest, rest.tag, {}), {}).isPartOfSurface);
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

/// A fixed plate at x = 0, a handle's plate at x = 10, and loose specks between them.
struct Plates {
    Case c;
    std::vector<Index> speckOf; // of each vertex
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
    Matrix3Xd Deformed(LooseParts looseParts) const {
        DeformationParam param;
        param.looseParts = looseParts;
        return DeformCentroidal(MeshD(c.shape), c.handles, param).position;
    }
};

TEST(LooseParts, MoveAsTheNearestHeldPlace) {
    const Plates plates;
    ASSERT_EQ(plates.loose.parts, 8);
    const Matrix3Xd follow = plates.Deformed(LooseParts::Follow), stay = plates.Deformed(LooseParts::Stay);
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
        for (int i = 50; i < plates.c.shape.Size(); ++i)
            if (plates.loose.partOf[i] == part) {
                const Vector3d &p = plates.c.shape.position[i];
                EXPECT_LE((follow.col(i) - (tag == 2 ? bend * p : p)).norm(), 1e-12) << "part " << part;
                if (tag == 0) {
                    EXPECT_EQ(follow.col(i), p) << "to the bit";
                }
                EXPECT_EQ(stay.col(i), p);
            }
    }
    EXPECT_GT(with[0], 1);
    EXPECT_GT(with[2], 1);
}

TEST(LooseParts, MoveRigidlyThoughTheHandleScales) {
    Plates plates;
    Affine3d large = bend;
    large.linear() *= 2;
    plates.c.handles.motion[2] = Motion(large.matrix());
    const Matrix3Xd x = plates.Deformed(LooseParts::Follow);
    for (int i = 51; i < x.cols(); ++i)
        if (plates.loose.partOf[i] == plates.loose.partOf[i - 1]) {
            EXPECT_NEAR((x.col(i) - x.col(i - 1)).norm(),
                        (plates.c.shape.position[i] - plates.c.shape.position[i - 1]).norm(), 1e-12);
        }
}

/// A tube that is held at both ends, and more loose shapes.
static Case TubeWith(const Shape &more) {
    const Shape tube = Tube(40, 16);
    Case c{Join(tube, more), {}};
    for (int i = 0; i < c.shape.Size(); ++i)
        c.handles.tag.push_back(i < tube.Size() ? TubeTag(c.shape.position[i]) : 1);
    c.handles.motion[2] = Motion(bend.matrix());
    return c;
}

TEST(LooseParts, MoveAsTheSurfaceThatBendsBesideThem) {
    const Shape button = Moved(Sphere(4, 6), Affine3d(Eigen::Translation3d(1.4, 0, 3) * Eigen::Scaling(0.1)));
    const Case c = TubeWith(button);
    const int first = c.shape.Size() - button.Size();
    const Matrix3Xd x = DeformCentroidal(MeshD(c.shape), c.handles, {}).position;
    // As far from the tube as before, and as large.
    const auto gap = [&](const Matrix3Xd &p) {
        double least = 1e9;
        for (int i = first; i < p.cols(); ++i)
            for (int j = 0; j < first; ++j)
                least = std::min(least, (p.col(i) - p.col(j)).norm());
        return least;
    };
    EXPECT_NEAR(gap(x), gap(PositionsOf(MeshD(c.shape))), 0.05);
    EXPECT_GT((x.col(first) - c.shape.position[first]).norm(), 0.1);
    for (int i = first + 1; i < x.cols(); ++i)
        EXPECT_NEAR((x.col(i) - x.col(i - 1)).norm(), (c.shape.position[i] - c.shape.position[i - 1]).norm(), 1e-9);
}

TEST(LooseParts, TurnAsTheSurfaceDoesWhereItIsNearest) {
    constexpr int buttons = 6; // in different patches, at different places of them
    Shape more;
    for (int b = 0; b < buttons; ++b)
        more = Join(std::move(more),
                    Moved(Sphere(4, 6), Affine3d(Eigen::Translation3d(1.4, 0, 2 + 0.43 * b) * Eigen::Scaling(0.1))));
    const Case c = TubeWith(more);
    const int each = more.Size() / buttons, first = c.shape.Size() - more.Size();
    DeformationParam param;
    param.linear = true;
    const DeformationResult result = DeformCentroidal(MeshD(c.shape), c.handles, param);
    for (int begin = first; begin < c.shape.Size(); begin += each) {
        double least = 1e9;
        int nearest = -1;
        Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
        for (int i = begin; i < begin + each; ++i) {
            turned += (result.position.col(i) - result.position.col(begin)) *
                      (c.shape.position[i] - c.shape.position[begin]).transpose();
            for (int j = 0; j < first; ++j)
                if (const double d = (c.shape.position[i] - c.shape.position[j]).norm(); d < least) {
                    least = d;
                    nearest = j;
                }
        }
        const Eigen::Matrix3d there = vcg::fcd::detail::RotationOf(result.linear[nearest].cast<double>());
        EXPECT_LE((vcg::fcd::detail::RotationOf(turned) - there).norm(), 1e-4) << "vertex " << begin;
    }
}

TEST(LooseParts, LongOnesFollowPartByPart) {
    // A sleeve around all of the tube.
    Shape sleeve = Tube(40, 24);
    for (Vector3d &p : sleeve.position)
        p.head<2>() *= 1.2;
    const Case c = TubeWith(sleeve);
    const int first = c.shape.Size() - sleeve.Size();
    const Matrix3Xd x = DeformCentroidal(MeshD(c.shape), c.handles, {}).position;
    double nearest = 1e9, farthest = 0, uneven[2] = {0, 0}; // of the tube, of the sleeve
    for (int i = first; i < x.cols(); ++i) {
        double gap = 1e9;
        for (int j = 0; j < first; ++j)
            gap = std::min(gap, (x.col(i) - x.col(j)).norm());
        nearest = std::min(nearest, gap);
        farthest = std::max(farthest, gap);
    }
    for (const auto &f : c.shape.face)
        for (int k = 0; k < 3; ++k) {
            const int a = f[k], b = f[(k + 1) % 3];
            const double ratio = (x.col(a) - x.col(b)).norm() / (c.shape.position[a] - c.shape.position[b]).norm();
            uneven[a >= first] = std::max(uneven[a >= first], std::abs(std::log(ratio)));
        }
    EXPECT_GE(nearest, 0.05) << "0.2 at rest, and the tube's inside is pressed";
    EXPECT_LE(farthest, 0.35);
    EXPECT_LE(uneven[1], 2 * uneven[0]) << "farther from the axis of the bend, but no steps";
}

TEST(FollowNearest, ListsEachPlaceOnce) {
    const Shape body = Tube(13, 12), sleeve = Tube(60, 40, 4); // much finer
    const Shape both = Join(body, sleeve);
    LooseSurface loose;
    loose.partOf.assign(std::size_t(both.Size()), 0);
    std::fill_n(loose.partOf.begin(), body.Size(), -1);
    loose.parts = 1;
    const LooseFollowing following = FollowNearest(
        PositionsOf(MeshD(both)), std::vector<int>(std::size_t(both.Size()), 1), Frame(), loose,
        [](std::size_t) { return 0.1; }, Threads(1));
    ASSERT_EQ(following.vertex.size(), std::size_t(sleeve.Size()));
    const std::set<std::size_t> places(following.place.begin(), following.place.end());
    EXPECT_EQ(places.size(), following.place.size());
    EXPECT_LT(*places.rbegin(), std::size_t(body.Size()));
    for (const LooseFollowing::Vertex &vertex : following.vertex)
        for (int k = 0; k < LooseFollowing::several; ++k)
            EXPECT_TRUE(vertex.weight[k] == 0 || std::size_t(vertex.place[k]) < places.size());
}

TEST(LooseParts, FollowAnUnweldedSurfaceAsAWeldedOne) {
    const Shape body = Tube(13, 12), sleeve = [] { // much finer, and wider
        Shape s = Tube(60, 40, 4);
        for (Vector3d &p : s.position)
            p = Vector3d(1.4 * p[0], 1.4 * p[1], p[2] + 1);
        return s;
    }();
    const auto deformed = [&](const Shape &first) {
        Case c{Join(first, sleeve), {}};
        for (int i = 0; i < c.shape.Size(); ++i)
            c.handles.tag.push_back(i < first.Size() ? TubeTag(c.shape.position[i]) : 1);
        c.handles.motion[2] = Motion(bend.matrix());
        return Matrix3Xd(DeformCentroidal(MeshD(c.shape), c.handles, {}).position.rightCols(sleeve.Size()));
    };
    const Matrix3Xd welded = deformed(body), unwelded = deformed(Unwelded(body));
    EXPECT_LE((welded - unwelded).colwise().norm().maxCoeff(), 1e-4);
}

TEST(LooseParts, FollowASingleHeldVertexOrNothing) {
    const Case c{Join(Triangle(), Shape{{{9, 9, 9}}, {}, {}}), {{1, 1, 1, 2}, {{2, Motion(bend.matrix())}}, {}}};
    const Matrix3Xd x = DeformCentroidal(MeshD(c.shape), c.handles, {}).position;
    for (int i = 0; i < 4; ++i)
        EXPECT_LE((x.col(i) - bend * c.shape.position[i]).norm(), 1e-12);
    SurfaceGraph surface;
    const Handles free{{1, 1, 1, 1}, {}, {}};
    const LooseSurface all = LooseOf(MeshD(c.shape), free, surface);
    EXPECT_EQ(all.parts, 2);
    const LooseFollowing nothing = FollowNearest(
        PositionsOf(MeshD(c.shape)), free.tag, surface.frame, all, [](std::size_t) { return 1.0; }, Threads(1));
    EXPECT_EQ(nothing.leader, std::vector<std::size_t>(2, LooseFollowing::none));
    EXPECT_TRUE(nothing.vertex.empty());
}
