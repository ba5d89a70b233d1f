// SPDX-License-Identifier: GPL-3.0-or-later
// Each region has the bits that it would have if nothing else were free.
#include <vcg_ext/deformer.h>
#include "sanitizers.h"
#include "test_support.h"

#include <random>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Vector3d;

namespace {

/// A shape with random tags.
struct Tagged {
    Shape shape;
    Handles handles;

    /// Tags balls around random vertices, one after the other, with random tags.
    Tagged(Shape whole, unsigned seed) : shape(std::move(whole)) {
        std::mt19937 random(seed);
        handles.tag.assign(std::size_t(shape.Size()), 0);
        const auto vertex = [&] { return std::size_t(random() % unsigned(shape.Size())); };
        for (int ball = 0; ball < 12; ++ball) {
            const Vector3d center = shape.position[vertex()];
            const double radius = 0.2 + 0.1 * double(random() % 8);
            const int tag = int(random() % 6) - 1;
            for (std::size_t i = 0; i < handles.tag.size(); ++i)
                if ((shape.position[i] - center).norm() < radius)
                    handles.tag[i] = ball < 6 ? 1 : tag;
        }
        for (int tag = 2; tag <= 4; ++tag) {
            Eigen::Affine3d motion(Eigen::AngleAxisd(0.3 * tag, RandomVector(random).normalized()));
            motion.translation() = 0.1 * RandomVector(random);
            handles.motion[tag] = Motion(motion.matrix());
        }
    }

    bool HasWork() const {
        const TagCount count = CountTags(handles.tag, nullptr);
        return count.free > 0 && count.handle > 0;
    }
};

struct Posed {
    std::unique_ptr<Deformer> deformer;
    Matrix3Xd position;
    Deformer::Pose pose;
};

Posed PosedBy(const SurfaceView &view, const Handles &handles, const DeformationParam &param,
              const Deformer *kept = nullptr) {
    Posed posed;
    posed.deformer = PrepareDeformer(view, handles, param, Threads(2), kept);
    posed.pose = posed.deformer->Solve(handles, param, Threads(2));
    posed.position = view.Copy();
    Carrier(*posed.deformer, posed.pose).Apply(posed.position);
    return posed;
}

/// The tags with all regions but one, and all that is loose, tagged as \p other.
Handles Alone(const Posed &all, const Handles &handles, std::size_t region, int other) {
    Handles alone = handles;
    for (std::size_t i = 0; i < alone.tag.size(); ++i)
        if (const auto place = all.deformer->At(i);
            alone.tag[i] == 1 && !(place.region && (place.number == region || !place.region->IsFree(place.node))))
            alone.tag[i] = other;
    return alone;
}

constexpr int unmoving = 9; // a handle without a motion

/// \return how many regions were compared
int ExpectUnion(const Tagged &each, const DeformationParam &param) {
    const Arrays arrays = Read(MeshD(each.shape));
    const SurfaceView view(arrays);
    const Posed all = PosedBy(view, each.handles, param);
    const std::size_t regions = all.deformer->regions.size();
    int compared = 0;
    for (std::size_t r = 0; r < regions && regions > 1; ++r) {
        const Handles alone = Alone(all, each.handles, r, r % 2 ? 0 : unmoving);
        const Posed one = PosedBy(view, alone, param);
        for (const MovingRegion::Bent &vertex : all.deformer->regions[r]->bent)
            EXPECT_EQ(all.position.col(vertex.slot), one.position.col(vertex.slot))
                << "vertex " << vertex.slot << " of region " << r << " of " << regions;
        ++compared;
        if (testing::Test::HasFailure())
            break;
        // Prepared regions are taken over, in both directions.
        const Posed kept = PosedBy(view, alone, param, all.deformer.get()),
                    again = PosedBy(view, each.handles, param, one.deformer.get());
        EXPECT_EQ(kept.deformer->regions[0], all.deformer->regions[r]);
        EXPECT_EQ(again.deformer->regions[r], one.deformer->regions[0]);
        if (!view.isCloud) { // of a cloud, not all edges between held points are read
            EXPECT_EQ(kept.deformer->report.components, one.deformer->report.components);
            EXPECT_EQ(again.deformer->report.components, all.deformer->report.components);
        }
        EXPECT_TRUE(SameBits(kept.position, one.position));
        EXPECT_TRUE(SameBits(again.position, all.position));
    }
    return compared;
}

} // namespace

TEST(Regions, AResultIsTheUnionOfTheirResults) {
    DeformationParam param;
    param.graph.initialPatches = 0;
    int compared = 0;
    for (unsigned seed = 1; seed <= (sanitized ? 4 : 12); ++seed) {
        param.falloff = Falloff((seed - 1) % 4);
        param.elastic = seed % 3 == 0;
        param.rigidity = seed % 3 == 1 ? 0 : seed % 12 == 2 ? 0.5 : 1;
        for (const Shape &shape : {Sphere(40, 40), Unwelded(Sphere(30, 30)), Tube(24, 60)})
            if (const Tagged each(shape, seed); each.HasWork())
                compared += ExpectUnion(each, param);
    }
    EXPECT_GT(compared, sanitized ? 6 : 20);
}

TEST(Regions, APointHandleChangesNoneOfTheOthers) {
    DeformationParam param;
    int compared = 0;
    for (unsigned seed = 1; seed <= (sanitized ? 3 : 8); ++seed)
        for (const Shape &shape :
             {Sphere(30, 30), Points(Sphere(36, 36)), Points(Join(Sphere(22, 22), Sphere(22, 22)))}) {
            const Tagged each(shape, seed);
            if (!each.HasWork())
                continue;
            const Arrays arrays = Read(MeshD(shape));
            const SurfaceView view(arrays);
            const Posed without = PosedBy(view, each.handles, param);
            if (without.deformer->regions.empty())
                continue;
            Handles more = each.handles;
            const auto &bent = without.deformer->regions.back()->bent;
            const std::size_t vertex = bent[bent.size() / 2].slot;
            more.point.push_back({vertex, shape.position[vertex] + Vector3d(0.05, 0, 0)});
            const Posed anew = PosedBy(view, more, param), kept = PosedBy(view, more, param, without.deformer.get()),
                        again = PosedBy(view, each.handles, param, anew.deformer.get());
            EXPECT_TRUE(SameBits(kept.position, anew.position)) << "seed " << seed;
            EXPECT_TRUE(SameBits(again.position, without.position)) << "seed " << seed;
            compared += without.deformer->regions.size() > 1;
        }
    EXPECT_GT(compared, sanitized ? 1 : 5);
}

TEST(Regions, AlsoOfClouds) {
    DeformationParam param;
    int compared = 0;
    const auto compare = [&](const Shape &shape, unsigned seeds) {
        for (unsigned seed = 1; seed <= seeds; ++seed)
            if (const Tagged each(Points(shape), seed); each.HasWork())
                compared += ExpectUnion(each, param);
    };
    compare(Sphere(36, 36), sanitized ? 3 : 8);
    compare(Sphere(6, 260), sanitized ? 2 : 5); // points in lines
    EXPECT_GT(compared, sanitized ? 1 : 5);
}
