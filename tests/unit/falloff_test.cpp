// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/deformer.h>
#include <vcg_ext/graph/falloff.h>
#include "test_support.h"

#include <cmath>
#include <map>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Vector3d;

namespace {

constexpr int rings = 61, around = 40;
constexpr double length = 10;

/// A tube whose ends are held.
Handles EndsOf(const Shape &tube, int first, int last) {
    Handles handles;
    handles.tag = TagsOf(tube, [&](const Vector3d &p) { return p[2] < 2 - 1e-9 ? first : p[2] > 8 + 1e-9 ? last : 1; });
    return handles;
}

/// The move of each ring along an axis, from the first held one to the last, over that of the handle.
std::vector<double> ProfileOf(const Handles &handles, const Shape &tube, Falloff falloff, int axis, int patches = 0) {
    DeformationParam param;
    param.falloff = falloff;
    param.graph.initialPatches = patches;
    const Arrays arrays = Read(MeshD(tube));
    const SurfaceView view(arrays);
    const DeformationResult result = DeformSurface(view, {}, handles, param, Threads(2));
    EXPECT_TRUE(result.converged);
    std::vector<double> profile;
    for (int ring = 0; ring < rings; ++ring) {
        double sum = 0;
        for (int i = 0; i < around; ++i) {
            const auto at = std::size_t(ring * around + i);
            sum += result.position(axis, Eigen::Index(at)) - tube.position[at][axis];
        }
        if (const double z = tube.position[std::size_t(ring * around)][2]; z > 2 - 1e-9 && z < 8 + 1e-9)
            profile.push_back(sum / around);
    }
    return profile;
}

std::vector<double> Shifted(Falloff falloff, int patches = 0, int axis = 0) {
    const Shape tube = Tube(rings, around, length);
    Handles handles = EndsOf(tube, 0, 2);
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.translation()[axis] = 1;
    handles.motion[2] = Motion(motion.matrix());
    return ProfileOf(handles, tube, falloff, axis, patches);
}

/// The rms difference of two profiles, or of a profile and a function of the distance from the handle.
template <class Other>
double Off(const std::vector<double> &profile, const Other &other) {
    double squares = 0;
    for (std::size_t i = 0; i < profile.size(); ++i)
        squares += std::pow(profile[i] - other(i, 1 - double(i) / double(profile.size() - 1)), 2);
    return std::sqrt(squares / double(profile.size()));
}

const std::map<Falloff, double (*)(std::size_t, double)> ideals = {
    {Falloff::Smooth, [](std::size_t, double t) { return 1 - t * t * (3 - 2 * t); }},
    {Falloff::Linear, [](std::size_t, double t) { return 1 - t; }},
    {Falloff::Sharp, [](std::size_t, double t) { return (1 - t) * (1 - t); }},
    {Falloff::Constant, [](std::size_t, double t) { return 1 - t * t; }}};

} // namespace

TEST(Falloff, AShiftFadesAsItsNameSays) {
    for (const Falloff falloff : {Falloff::Linear, Falloff::Sharp, Falloff::Constant}) {
        const std::vector<double> profile = Shifted(falloff);
        for (const auto &[each, ideal] : ideals)
            if (each == falloff)
                EXPECT_LT(Off(profile, ideal), 0.03) << int(falloff);
            else
                EXPECT_GT(Off(profile, ideal), 0.04) << int(falloff) << " is as " << int(each);
    }
}

TEST(Falloff, TheNumberOfNodesHardlyChangesIt) {
    for (const auto &each : ideals) {
        const std::vector<double> few = Shifted(each.first, 150), many = Shifted(each.first, 600);
        EXPECT_LT(Off(few, [&](std::size_t i, double) { return many[i]; }), 0.02) << int(each.first);
    }
}

TEST(Falloff, APullStretchesWhereItIsSoft) {
    const std::vector<double> sharp = Shifted(Falloff::Sharp, 0, 2), constant = Shifted(Falloff::Constant, 0, 2);
    EXPECT_LT(sharp[sharp.size() / 2], 0.25);
    EXPECT_GT(constant[constant.size() / 2], 0.75);
}

TEST(Falloff, BetweenTwoHandlesBothEndsAreAlike) {
    const Shape tube = Tube(rings, around, length);
    Handles handles = EndsOf(tube, 2, 3);
    for (const int tag : {2, 3}) {
        Eigen::Affine3d motion = Eigen::Affine3d::Identity();
        motion.translation()[0] = tag == 3 ? 1 : -1;
        handles.motion[tag] = Motion(motion.matrix());
    }
    const std::vector<double> profile = ProfileOf(handles, tube, Falloff::Sharp, 0);
    EXPECT_LT(Off(profile, [&](std::size_t i, double) { return -profile[profile.size() - 1 - i]; }), 0.02);
    const std::vector<double> smooth = ProfileOf(handles, tube, Falloff::Smooth, 0);
    EXPECT_LT(profile[profile.size() * 9 / 10], smooth[profile.size() * 9 / 10] - 0.02); // it bends at the handles
}

TEST(Falloff, AHandleOfOneVertexAndAPointFadeAsALargeOneDoes) {
    constexpr int n = 41, middle = n / 2;
    const Shape sheet = Grid(n, n, 0.1);
    const std::size_t lifted = middle * n + middle;
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.translation()[2] = 1;
    for (const bool isPoint : {false, true}) {
        std::map<Falloff, double> half; // how high the sheet is half way to its border
        for (const auto &each : ideals) {
            Handles handles;
            handles.tag = TagsOf(sheet, [&](const Vector3d &p) {
                return std::min({p[0], p[1], 4 - p[0], 4 - p[1]}) < 1e-3 ? 0 : 1;
            });
            if (isPoint) {
                handles.point.push_back({lifted, Vector3d(sheet.position[lifted] + Vector3d::UnitZ())});
            } else {
                handles.tag[lifted] = 2;
                handles.motion[2] = Motion(motion.matrix());
            }
            DeformationParam param;
            param.falloff = each.first;
            const Arrays arrays = Read(MeshD(sheet));
            const DeformationResult result = DeformSurface(SurfaceView(arrays), {}, handles, param, Threads(2));
            half[each.first] = result.position(2, Eigen::Index(middle * n + middle / 2));
        }
        EXPECT_LT(half[Falloff::Sharp], half[Falloff::Smooth] - 0.1) << isPoint;
        EXPECT_GT(half[Falloff::Constant], half[Falloff::Smooth] + 0.1) << isPoint;
    }
}

TEST(Falloff, SmoothLeavesAllWeights) {
    Rig rig(Tube(24, 24), 0.6, [](const Vector3d &p) { return TubeTag(p); });
    const std::vector<float> before = rig.graph.weight;
    std::vector<Index> part = rig.patches.tag;
    WeighFalloff(rig.graph, part, Falloff::Smooth);
    EXPECT_EQ(rig.graph.weight, before);
    WeighFalloff(rig.graph, part, Falloff::Constant);
    EXPECT_NE(rig.graph.weight, before);
}

TEST(Falloff, WeightsStaySymmetricAndFinite) {
    for (const Falloff falloff : {Falloff::Linear, Falloff::Sharp, Falloff::Constant})
        for (const int held : {-1, 0, 2}) { // nothing held, only fixed, only a handle
            Rig rig(Tube(24, 24), 0.6, [&](const Vector3d &p) { return held >= 0 && p[2] < 1 ? held : 1; });
            const std::vector<float> before = rig.graph.weight;
            WeighFalloff(rig.graph, rig.patches.tag, falloff);
            const Csr &adjacency = rig.graph.graph.adjacency;
            for (Index i = 0; i < rig.graph.Size(); ++i)
                for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
                    const Index j = adjacency.item[e];
                    const Csr::Row row = adjacency[j];
                    const auto back =
                        adjacency.begin[j] + std::uint32_t(std::lower_bound(row.begin(), row.end(), i) - row.begin());
                    EXPECT_EQ(rig.graph.weight[e], rig.graph.weight[back]);
                    const float ratio = rig.graph.weight[e] / before[e];
                    EXPECT_TRUE(ratio > 0.1f && ratio < 10.f) << ratio;
                }
        }
}
