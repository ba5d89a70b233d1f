// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/deformer.h>
#include "test_support.h"

#include <algorithm>
#include <cmath>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Vector3d;

namespace {

constexpr int hoops = 61, sides = 40;
constexpr double tubeLength = 10;

/// A tube whose ends are held: 0 the first, 2 the last.
Handles EndsOf(const Shape &tube, const Eigen::Affine3d &motion, int first = 0) {
    Handles handles;
    handles.tag = TagsOf(tube, [&](const Vector3d &p) { return p[2] < 2 - 1e-9 ? first : p[2] > 8 + 1e-9 ? 2 : 1; });
    for (int tag : {first, 2})
        if (tag > 0)
            handles.motion[tag] = Motion(motion.matrix());
    return handles;
}

DeformationResult Deformed(const Shape &shape, const Handles &handles, bool elastic, unsigned threads = 2) {
    DeformationParam param;
    param.elastic = elastic;
    const Arrays arrays = Read(MeshD(shape));
    return DeformSurface(SurfaceView(arrays), {}, handles, param, Threads(threads));
}

/// The volume of a tube whose ends are closed by flat caps.
double VolumeOf(const Shape &tube, const Eigen::Matrix3Xd &position) {
    double volume = 0;
    const auto add = [&](const Vector3d &a, const Vector3d &b, const Vector3d &c) { volume += a.dot(b.cross(c)) / 6; };
    for (const auto &face : tube.face)
        add(position.col(face[0]), position.col(face[1]), position.col(face[2]));
    for (const int first : {0, (hoops - 1) * sides}) {
        const Vector3d middle = position.middleCols(first, sides).rowwise().mean();
        for (int i = 0; i < sides; ++i) {
            const Vector3d a = position.col(first + i), b = position.col(first + (i + 1) % sides);
            if (first == 0)
                add(b, a, middle);
            else
                add(a, b, middle);
        }
    }
    return std::abs(volume);
}

Eigen::Matrix3Xd RestOf(const Shape &shape) {
    Eigen::Matrix3Xd rest(3, Eigen::Index(shape.position.size()));
    for (std::size_t i = 0; i < shape.position.size(); ++i)
        rest.col(Eigen::Index(i)) = shape.position[i];
    return rest;
}

Eigen::Affine3d Along(double way) { return Eigen::Affine3d(Eigen::Translation3d(0, 0, way)); }

Eigen::Affine3d Turned() {
    const Vector3d middle(0, 0, tubeLength / 2);
    return Eigen::Translation3d(middle) * Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitY()) *
           Eigen::Translation3d(-middle);
}

} // namespace

TEST(KeptVolume, ABendAPullAndASqueezeKeepIt) {
    const Shape tube = Tube(hoops, sides, tubeLength);
    const Eigen::Matrix3Xd rest = RestOf(tube);
    const double volume = VolumeOf(tube, rest);
    for (const Eigen::Affine3d &motion : {Turned(), Along(1.8), Along(-1.8)}) { // a third of what is free
        const Handles handles = EndsOf(tube, motion);
        const DeformationResult plain = Deformed(tube, handles, false), kept = Deformed(tube, handles, true);
        EXPECT_GT(std::abs(VolumeOf(tube, plain.position) / volume - 1), 0.05);
        EXPECT_LT(std::abs(VolumeOf(tube, kept.position) / volume - 1), 0.002);
        EXPECT_EQ(kept.surface.unenclosed, 0);
        EXPECT_EQ(kept.check.flipped, 0);
        for (std::size_t i = 0; i < handles.tag.size(); ++i)
            if (handles.tag[i] != 1)
                EXPECT_EQ(kept.position.col(Eigen::Index(i)), plain.position.col(Eigen::Index(i)));
    }
}

TEST(KeptVolume, ItBulgesSmoothlyAndAlikeAllAround) {
    const Shape tube = Tube(hoops, sides, tubeLength);
    const DeformationResult kept = Deformed(tube, EndsOf(tube, Along(-1.8)), true);
    std::vector<double> radius; // mean of each hoop
    for (int ring = 0; ring < hoops; ++ring) {
        const Vector3d middle = kept.position.middleCols(ring * sides, sides).rowwise().mean();
        double sum = 0, least = 1e9, most = 0;
        for (int i = 0; i < sides; ++i) {
            const double r = (kept.position.col(ring * sides + i) - middle).norm();
            sum += r / sides;
            least = std::min(least, r);
            most = std::max(most, r);
        }
        EXPECT_LT(most - least, 0.05) << ring; // patches lie irregularly
        radius.push_back(sum);
    }
    EXPECT_GT(*std::max_element(radius.begin(), radius.end()), 1.15);
    for (std::size_t ring = 1; ring + 1 < radius.size(); ++ring) {
        EXPECT_LT(std::abs(radius[ring - 1] - 2 * radius[ring] + radius[ring + 1]), 0.02) << ring;
        EXPECT_GE((radius[ring + 1] - radius[ring]) * (int(ring) < hoops / 2 ? 1 : -1), -5e-3) << ring; // one bulge
    }
}

TEST(KeptVolume, OneMotionOfAllChangesNoBit) {
    const Shape tube = Tube(hoops, sides, tubeLength);
    const Handles handles = EndsOf(tube, Turned(), 3);
    EXPECT_TRUE(SameBits(Deformed(tube, handles, true).position, Deformed(tube, handles, false).position));
}

TEST(KeptVolume, WhereThereIsNoneNothingChanges) {
    const auto tag = [](const Vector3d &p) { return p[0] < 4 ? 0 : p[0] > 25 ? 2 : 1; };
    for (const Shape &shape : {Grid(30, 30), Points(Grid(30, 30))}) {
        Handles handles;
        handles.tag = TagsOf(shape, tag);
        handles.motion[2] = Motion(Eigen::Affine3d(Eigen::Translation3d(-3, 0, 8)).matrix());
        const DeformationResult kept = Deformed(shape, handles, true);
        EXPECT_TRUE(SameBits(kept.position, Deformed(shape, handles, false).position));
        EXPECT_EQ(kept.surface.unenclosed, 1);
    }
}

TEST(KeptVolume, SmallHolesAreCapped) {
    Shape tube = Tube(hoops, sides, tubeLength);
    const Eigen::Matrix3Xd rest = RestOf(tube);
    const double volume = VolumeOf(tube, rest);
    Shape torn = tube;
    torn.face.erase(torn.face.begin() + 30 * sides * 2, torn.face.begin() + 30 * sides * 2 + 8);
    const DeformationResult kept = Deformed(torn, EndsOf(torn, Turned()), true);
    EXPECT_EQ(kept.surface.unenclosed, 0);
    EXPECT_LT(std::abs(VolumeOf(tube, kept.position) / volume - 1), 0.005);
}

TEST(KeptVolume, EachPartKeepsItsOwn) {
    const Shape tube = Tube(hoops, sides, tubeLength);
    const Shape both = Join(tube, Moved(tube, Eigen::Affine3d(Eigen::Translation3d(20, 0, 0))));
    Handles handles = EndsOf(both, Along(-1.8));
    for (std::size_t i = tube.position.size(); i < both.position.size(); ++i) // the other one is pulled
        if (handles.tag[i] == 2)
            handles.tag[i] = 3;
    handles.motion[3] = Motion(Along(1.8).matrix());
    DeformationParam param;
    param.elastic = true;
    param.weights = MappingWeights::Euclidean; // both are one region
    const Arrays arrays = Read(MeshD(both));
    const Eigen::Matrix3Xd position = DeformSurface(SurfaceView(arrays), {}, handles, param, Threads(2)).position;
    const auto n = Eigen::Index(tube.position.size());
    const double volume = VolumeOf(tube, RestOf(tube));
    EXPECT_LT(std::abs(VolumeOf(tube, position.leftCols(n)) / volume - 1), 0.002);
    EXPECT_LT(std::abs(VolumeOf(tube, position.rightCols(n)) / volume - 1), 0.002);
}

TEST(KeptVolume, TheSameBitsForAnyNumberOfThreadsAndAnyMeshOrientation) {
    Shape tube = Tube(hoops, sides, tubeLength);
    const Handles handles = EndsOf(tube, Turned());
    const DeformationResult one = Deformed(tube, handles, true, 1);
    EXPECT_TRUE(SameBits(one.position, Deformed(tube, handles, true, 7).position));
    for (auto &face : tube.face)
        std::swap(face[0], face[1]);
    EXPECT_LT((one.position - Deformed(tube, handles, true).position).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(KeptVolume, TheTwoSidesOfASheetEncloseNone) {
    Shape sheet = Grid(40, 20);
    for (Vector3d &p : sheet.position)
        p[2] = std::sin(0.3 * p[0]) * std::cos(0.4 * p[1]);
    const std::size_t faces = sheet.face.size();
    for (std::size_t f = 0; f < faces; ++f)
        sheet.face.push_back({sheet.face[f][0], sheet.face[f][2], sheet.face[f][1]});
    Handles handles;
    handles.tag = TagsOf(sheet, [](const Vector3d &p) { return p[0] < 5 ? 0 : p[0] > 34 ? 2 : 1; });
    handles.motion[2] = Motion(Eigen::Affine3d(Eigen::Translation3d(-3, 0, 8)).matrix());
    const DeformationResult kept = Deformed(sheet, handles, true);
    EXPECT_TRUE(SameBits(kept.position, Deformed(sheet, handles, false).position));
    EXPECT_EQ(kept.surface.unenclosed, 1);
}

TEST(KeptVolume, WhatOnlyGoesAlongIsAsItWas) {
    // A squeezed trunk with an arm at right angles.
    const Shape trunk = Tube(hoops, sides, tubeLength);
    Shape both = trunk;
    const int rows = 40, around = 12, first = int(both.position.size());
    const double radius = 0.4;
    const auto angle = [&](int i) { return 2 * EIGEN_PI * i / around; };
    // The arm begins at a hole of the trunk with as many vertices.
    const int hoop = 28, side = 0;
    std::vector<int> rim;
    for (int i = 0; i < 4; ++i)
        rim.push_back((hoop + i) * sides + side);
    for (int i = 0; i < 3; ++i)
        rim.push_back((hoop + 3) * sides + side + 1 + i);
    for (int i = 2; i >= 0; --i)
        rim.push_back((hoop + i) * sides + side + 3);
    for (int i = 2; i > 0; --i)
        rim.push_back(hoop * sides + side + i);
    ASSERT_EQ(int(rim.size()), around);
    const auto isInside = [&](int v) {
        const int h = v / sides, s = v % sides;
        return v < hoops * sides && h >= hoop && h <= hoop + 3 && s >= side && s <= side + 3;
    };
    both.face.erase(std::remove_if(both.face.begin(), both.face.end(),
                                   [&](const auto &f) { return isInside(f[0]) && isInside(f[1]) && isInside(f[2]); }),
                    both.face.end());
    Vector3d middle = Vector3d::Zero();
    for (const int v : rim)
        middle += both.position[std::size_t(v)] / around;
    const Vector3d out = Vector3d(middle[0], middle[1], 0).normalized(), up = Vector3d::UnitZ(), across = up.cross(out);
    std::vector<int> last = rim;
    const double begin = std::atan2(across.dot(both.position[std::size_t(rim[0])] - middle),
                                    (both.position[std::size_t(rim[0])] - middle)[2]),
                 second = std::atan2(across.dot(both.position[std::size_t(rim[1])] - middle),
                                     (both.position[std::size_t(rim[1])] - middle)[2]);
    const double turn = std::remainder(second - begin, 2 * EIGEN_PI) > 0 ? 1 : -1;
    for (int row = 1; row <= rows; ++row) {
        std::vector<int> next;
        for (int i = 0; i < around; ++i) {
            next.push_back(int(both.position.size()));
            const double a = begin + turn * angle(i);
            both.position.push_back(middle + 0.12 * row * out + radius * (std::cos(a) * up + std::sin(a) * across));
        }
        for (int i = 0; i < around; ++i) {
            const int j = (i + 1) % around;
            for (const auto &f : {std::array<int, 3>{last[std::size_t(i)], next[std::size_t(i)], next[std::size_t(j)]},
                                  {last[std::size_t(i)], next[std::size_t(j)], last[std::size_t(j)]}})
                both.face.push_back({f[0], f[1], f[2]});
        }
        last = next;
    }
    Handles handles = EndsOf(trunk, Along(-1.8));
    handles.tag.resize(both.position.size(), 1);
    const DeformationResult plain = Deformed(both, handles, false), kept = Deformed(both, handles, true);
    EXPECT_EQ(kept.surface.unenclosed, 0);
    EXPECT_LT(kept.check.volumeOff, 0.002);
    double trunkMoved = 0, lengthOff = 0;
    for (Eigen::Index i = 0; i < first; ++i)
        trunkMoved = std::max(trunkMoved, (kept.position.col(i) - plain.position.col(i)).norm());
    const auto tip = Eigen::Index(both.position.size()) - 1, root = Eigen::Index(first) + 5 * around;
    const auto along = [&](const DeformationResult &result) {
        return Vector3d(result.position.col(tip) - result.position.col(root));
    };
    lengthOff = (along(kept) - along(plain)).norm();
    EXPECT_GT(trunkMoved, 0.1);
    EXPECT_LT(lengthOff, 0.02 * along(plain).norm()) << "it swings, or gets longer";
}

TEST(KeptVolume, WhereItWouldHaveToGoTooFarItSaysSo) {
    const Shape tube = Tube(hoops, sides, tubeLength);
    const Handles handles = EndsOf(tube, Along(40));
    const DeformationResult plain = Deformed(tube, handles, false), kept = Deformed(tube, handles, true);
    const double volume = VolumeOf(tube, RestOf(tube));
    EXPECT_EQ(plain.check.volumeOff, 0);
    EXPECT_GT(kept.check.volumeOff, 0.05);
    EXPECT_LT(VolumeOf(tube, kept.position), 0.6 * VolumeOf(tube, plain.position));
    EXPECT_GT(VolumeOf(tube, kept.position), volume);
    EXPECT_LT((kept.position - plain.position).colwise().norm().maxCoeff(), 0.6) << "radii: half of one";
}
