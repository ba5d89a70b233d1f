// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/contact/surface_contact.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();

template <class Way>
Matrix3Xd Bent(const MeshD &mesh, const Way &way) {
    Matrix3Xd position = PositionsOf(mesh);
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        position.col(i) = way(Vector3d(position.col(i)));
    return position;
}

SurfaceContact ContactOf(const MeshD &mesh, const Matrix3Xd &position, unsigned threads = 0) {
    Progress progress;
    progress.threads = threads;
    return FindContact(Read(mesh), position, same, defaultWeldDistance, progress);
}

/// Whether an edge of one triangle passes through the other: by the signs of volumes.
bool Cross(const std::array<Vector3d, 3> &a, const std::array<Vector3d, 3> &b) {
    const auto volume = [](const Vector3d &p, const Vector3d &q, const Vector3d &r, const Vector3d &s) {
        return (q - p).cross(r - p).dot(s - p);
    };
    const auto through = [&](const std::array<Vector3d, 3> &t, const std::array<Vector3d, 3> &u) {
        for (int k = 0; k < 3; ++k) {
            const Vector3d &p = u[k], &q = u[(k + 1) % 3];
            if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) >= 0)
                continue;
            const double x = volume(p, q, t[0], t[1]), y = volume(p, q, t[1], t[2]), z = volume(p, q, t[2], t[0]);
            if ((x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0))
                return true;
        }
        return false;
    };
    return through(a, b) || through(b, a);
}

/// All pairs of faces, by brute force. (Shapes are irregular, so that rounding decides nothing.)
std::vector<std::uint32_t> CrossingOneByOne(const Shape &shape, const Matrix3Xd &rest, const Matrix3Xd &position) {
    std::set<std::uint32_t> found;
    const auto corners = [&](const Matrix3Xd &at, std::size_t f) {
        std::array<Vector3d, 3> c;
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = at.col(shape.face[f][k]);
        return c;
    };
    for (std::size_t f = 0; f < shape.face.size(); ++f)
        for (std::size_t g = 0; g < f; ++g) {
            bool touch = false;
            for (const Vector3d &p : corners(rest, f))
                for (const Vector3d &q : corners(rest, g))
                    touch = touch || p == q;
            if (!touch && Cross(corners(position, f), corners(position, g)) &&
                !Cross(corners(rest, f), corners(rest, g)))
                found.insert({std::uint32_t(f), std::uint32_t(g)});
        }
    return {found.begin(), found.end()};
}

/// A tube along z that is folded by \p degrees around its middle, as a finger is.
Vector3d Folded(const Vector3d &p, double degrees) {
    const double share = std::min(1.0, std::max(0.0, p[2] - 2.5)); // between 2.5 and 3.5
    const Vector3d middle(0, 0, 3);
    return middle + Eigen::AngleAxisd(share * degrees * M_PI / 180, Vector3d::UnitX()) * (p - middle);
}

} // namespace

TEST(SurfaceContact, IsWhatLookingAtEachPairFinds) {
    for (const Shape &shape : Rounds<Shape>({Jittered(Tube(25, 10), 0.03), Unwelded(Jittered(Tube(21, 9), 0.01))})) {
        const MeshD mesh(shape);
        const Matrix3Xd rest = PositionsOf(mesh);
        const std::vector<Matrix3Xd> poses = {
            Bent(mesh, [](const Vector3d &p) { return Folded(p, 20); }),
            Bent(mesh, [](const Vector3d &p) { return Folded(p, 160); }),
            Bent(mesh,
                 [](const Vector3d &p) { // pressed in the middle, until the sides pass through each other
                     return Vector3d(p[0], p[1] * (1 - 1.2 * std::exp(-(p[2] - 3) * (p[2] - 3))), p[2]);
                 }),
            PositionsOf(MeshD(Jittered(shape, 0.3, 5)))};
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const SurfaceContact found = ContactOf(mesh, poses[i]);
            EXPECT_EQ(found.face, CrossingOneByOne(shape, rest, poses[i])) << i;
            EXPECT_EQ(found.face.empty(), i == 0);
            EXPECT_EQ(found.face.empty(), found.largest == 0);
        }
    }
}

TEST(SurfaceContact, OfFansIsFoundWhateverFacesShareATip) {
    // Two fans, and one whose tips are apart: leaves of one fan are not compared with each other, but with the others.
    const auto shifted = [](double x) { return Moved(Fan(50), Affine3d(Eigen::Translation3d(x, 0.03, 0.11))); };
    const Shape fans = Join(Jittered(Join(Fan(50), shifted(20)), 0.02), Unwelded(Jittered(shifted(40), 0.02, 2)));
    const MeshD mesh(fans);
    const Matrix3Xd rest = PositionsOf(mesh), posed = Bent(mesh, [](const Vector3d &p) {
                                                  return p[0] > 30   ? Vector3d(p[0] - 40.5, p[1], p[2])
                                                         : p[0] > 10 ? Vector3d(p[0] - 19.5, p[1], p[2])
                                                                     : p;
                                              });
    const SurfaceContact found = ContactOf(mesh, posed);
    EXPECT_EQ(found.face, CrossingOneByOne(fans, rest, posed));
    EXPECT_GT(found.face.size(), 75u);
}

TEST(SurfaceContact, IsNoneAtRestOrAfterOneMotion) {
    const Affine3d motion(Eigen::Translation3d(3e3, -7, 0.1) * Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()));
    // Through itself at rest, coplanar, touching, degenerate, twice, torn.
    const Shape crossed = Join(Grid(9, 9), Moved(Grid(9, 9), Affine3d(Eigen::Translation3d(0.3, 2.2, -2) *
                                                                      Eigen::AngleAxisd(1.3, Vector3d::UnitX()))));
    const Shape flat = Join(Grid(9, 9), Moved(Grid(9, 9), Affine3d(Eigen::Translation3d(0.3, 0.2, 0))));
    const Shape beside = Join(Grid(9, 9), Moved(Grid(9, 9), Affine3d(Eigen::Translation3d(8, 0.5, 0))));
    Shape degenerate = Join(Tube(9, 9), Tube(9, 9));
    degenerate.face.push_back({0, 0, 1});
    degenerate.face.push_back({0, 20, 20});
    Shape pierced = Grid(2, 2); // by a needle, whose corners lie on one line
    for (double z : {-1.0, 0.25, 1.0})
        pierced.position.emplace_back(0.25, 0.5, z);
    pierced.face.push_back({4, 5, 6});
    for (const Shape &shape :
         {pierced, crossed, flat, beside, degenerate, Fan(7), Jittered(Grid(20, 20), 2), TwoSheets(9, 0)}) {
        const MeshD mesh(shape);
        const SurfaceContact atRest = ContactOf(mesh, PositionsOf(mesh));
        EXPECT_TRUE(atRest.face.empty() && atRest.depth.empty() && atRest.pairs == 0);
        EXPECT_TRUE(ContactOf(mesh, Bent(mesh, [&](const Vector3d &p) { return motion * p; })).face.empty());
        // Also in single precision.
        EXPECT_TRUE(ContactOf(mesh, Bent(mesh,
                                         [&](const Vector3d &p) {
                                             return Vector3d((motion.linear() * p).cast<float>().cast<double>());
                                         }))
                        .face.empty());
    }
}

TEST(SurfaceContact, TellsHowDeepABallHasComeThroughASheet) {
    const Shape shape = Join(Grid(81, 81, 0.05, 0), Moved(Sphere(40, 80), Affine3d(Eigen::Translation3d(2, 2, 1.5))));
    const MeshD mesh(shape);
    for (double deep : {0.1, 0.5}) {
        Matrix3Xd position = PositionsOf(mesh);
        position.rightCols(40 * 80 + 2).row(2).array() -= 0.5 + deep;
        const SurfaceContact contact = ContactOf(mesh, position);
        EXPECT_NEAR(contact.largest, deep, 0.01) << deep;
        for (std::size_t i = 81 * 81; i < contact.depth.size(); ++i)
            if (-position(2, Eigen::Index(i)) > 0.06) // an edge is 0.08 long
                EXPECT_NEAR(contact.depth[i], -position(2, Eigen::Index(i)), 0.02);
            else if (position(2, Eigen::Index(i)) > 0.1)
                EXPECT_EQ(contact.depth[i], 0);
        // World units: the layer's matrix counts.
        EXPECT_NEAR(FindContact(Read(mesh), position, 10 * same, defaultWeldDistance).largest, 10 * deep, 0.1);
        EXPECT_EQ(contact.largest, *std::max_element(contact.depth.begin(), contact.depth.end()));
    }
}

TEST(SurfaceContact, HasTheSameBitsForAnyNumberOfThreadsAndLeavesOutWhatIsNotFinite) {
    const Shape shape = Tube(200, 100);
    MeshD mesh(shape);
    Matrix3Xd position = Bent(mesh, [](const Vector3d &p) { return Folded(p, 160); });
    const SurfaceContact one = ContactOf(mesh, position, 1), many = ContactOf(mesh, position, 7);
    EXPECT_FALSE(one.face.empty());
    EXPECT_EQ(one.face, many.face);
    EXPECT_EQ(one.pairs, many.pairs);
    EXPECT_EQ(one.depth, many.depth);
    EXPECT_EQ(one.largest, many.largest);
    position.col(shape.face[one.face[0]][0]).setConstant(NAN);
    mesh.DeleteFace(int(one.face[1]));
    const std::vector<std::uint32_t> left = ContactOf(mesh, position).face;
    EXPECT_FALSE(left.empty());
    EXPECT_FALSE(std::binary_search(left.begin(), left.end(), one.face[0]));
    EXPECT_FALSE(std::binary_search(left.begin(), left.end(), one.face[1]));
    EXPECT_TRUE(ContactOf(MeshD(Points(shape)), position).face.empty()); // a cloud
}

TEST(SurfaceContact, IsToldOfADeformation) {
    const Shape shape = Tube(61, 40, 10);
    const auto tag = [](const Vector3d &p) { return p[2] < 4 ? 0 : p[2] > 6 ? 2 : 1; };
    const Vector3d middle(0, 0, 5);
    const auto about = [&](double degrees) {
        return Affine3d(Eigen::Translation3d(middle) * Eigen::AngleAxisd(degrees * M_PI / 180, Vector3d::UnitX()) *
                        Eigen::Translation3d(-middle));
    };
    Case c = CaseOf(shape, tag, about(170));
    DeformationParam param;
    param.graph.initialPatches = 60;
    const DeformationResult closed = vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param);
    EXPECT_FALSE(closed.contact.face.empty());
    EXPECT_GT(closed.contact.largest, 0.02);
    param.pose = 20;
    EXPECT_TRUE(vcg::tri::DeformCentroidal(MeshD(c.shape), c.handles, param).contact.face.empty());
}
