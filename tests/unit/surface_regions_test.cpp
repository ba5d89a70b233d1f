// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/cloud_parts.h>
#include <vcg_ext/surface/loose_parts.h>
#include <vcg_ext/surface/surface_regions.h>
#include "test_support.h"

#include <random>

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Affine3d;
using Eigen::Vector3d;

namespace {

/// A surface that is held, with loose parts.
struct Crumbs {
    Shape shape;
    std::vector<int> tag;

    explicit Crumbs(Shape whole) : shape(std::move(whole)) {
        for (const Vector3d &p : shape.position)
            tag.push_back(p[2] < -0.8 ? 0 : p[2] > 0.8 ? 2 : 1);
    }
    void Add(const Shape &part) {
        shape = Join(std::move(shape), part);
        tag.resize(std::size_t(shape.Size()), 1);
    }
    /// Adds small ones inside a ball.
    void Scatter(int parts, double radius, unsigned seed) {
        std::mt19937 random(seed);
        const std::vector<Shape> kinds{Sphere(4, 6), Fan(5), Unwelded(Sphere(3, 4)), Fan3()};
        for (int i = 0; i < parts; ++i)
            Add(Moved(kinds[std::size_t(i) % kinds.size()],
                      Eigen::Translation3d(radius * RandomVector(random).normalized()) * Eigen::Scaling(0.003)));
    }
    /// Adds repeated faces, faces without an area, third faces at edges, and coincident free vertices.
    void Spoil() {
        const std::size_t faces = shape.face.size();
        for (std::size_t f = 0; f < faces; f += 7) {
            const auto corner = shape.face[f];
            shape.face.push_back({corner[1], corner[0], corner[2]});
            shape.face.push_back({corner[0], corner[1], corner[1]});
            shape.position.push_back(0.99 * shape.position[std::size_t(corner[0])] +
                                     0.01 * shape.position[std::size_t(corner[2])]);
            tag.push_back(1);
            shape.face.push_back({corner[0], corner[1], shape.Size() - 1});
            if (tag[std::size_t(corner[0])] == 1) {
                shape.position.push_back(shape.position[std::size_t(corner[0])]);
                tag.push_back(1);
                shape.face[f][0] = shape.Size() - 1;
            }
        }
    }

    /// Expects that each region, read by itself, is the same as with all else held. \return number of regions
    Index Check(unsigned threads) const {
        const Arrays arrays = Read(MeshD(shape));
        const SurfaceView view(arrays);
        const Eigen::Matrix3d metric = Vector3d(1, 1.5, 0.7).asDiagonal();
        const Progress progress = Threads(threads);
        RegionSource source;
        source.mesh = view;
        source.tag = tag;
        const SurfaceGraph surface = ReadFreeSurface(view, tag, metric, progress);
        const LooseSurface loose =
            FindLoose(tag, {}, surface, FindComponents(surface, surface.tag, progress), progress);
        const SurfaceRegions regions = FindRegions(surface, FindComponents(surface, surface.tag, progress));
        const std::vector<RegionSource> parts = TakeRegions(source, surface, surface.tag, regions, progress);
        for (Index r = 0; r < regions.count; ++r) {
            const RegionSource &part = parts[std::size_t(r)];
            std::vector<int> alone = tag;
            std::vector<Index> of;
            for (std::size_t i = 0; i < tag.size(); ++i)
                if (tag[i] == 1) {
                    if (surface.nodeOf[i] >= 0)
                        regions.Of(surface.graph, surface.nodeOf[i], of);
                    if (surface.nodeOf[i] < 0 || std::find(of.begin(), of.end(), r) == of.end())
                        alone[i] = loose.partOf.empty() || loose.partOf[i] < 0 ? 0 : noVertex;
                }
            SurfaceGraph own = ReadFreeSurface(part.mesh, part.tag, metric, progress);
            const SurfaceGraph whole = ReadFreeSurface(view, alone, metric, progress);
            std::vector<Index> nodeOf(tag.size(), -1);
            for (std::size_t i = 0; i < part.slotOf.size(); ++i)
                nodeOf[part.slotOf[i]] = own.nodeOf[i];
            own.nodeOf = std::move(nodeOf);
            for (std::uint32_t &slot : own.slots)
                slot = part.slotOf[slot];
            for (std::uint32_t &face : own.faces)
                face = part.faceOf[face];
            ExpectSame(own, whole);
        }
        return regions.count;
    }

    static void ExpectSame(const SurfaceGraph &a, const SurfaceGraph &b) {
        EXPECT_TRUE(SameBits(a.graph.position, b.graph.position));
        EXPECT_EQ(a.graph.adjacency.begin, b.graph.adjacency.begin);
        EXPECT_EQ(a.graph.adjacency.item, b.graph.adjacency.item);
        EXPECT_EQ(a.graph.isCloud, b.graph.isCloud);
        EXPECT_EQ(a.frame.origin, b.frame.origin);
        EXPECT_EQ(a.frame.scale, b.frame.scale);
        EXPECT_EQ(a.frame.metric, b.frame.metric);
        EXPECT_EQ(a.nodeOf, b.nodeOf);
        EXPECT_EQ(a.slots, b.slots);
        EXPECT_EQ(a.faces, b.faces);
        EXPECT_EQ(a.tag, b.tag);
        EXPECT_EQ(a.nodeArea, b.nodeArea);
        EXPECT_EQ(a.area, b.area);
        EXPECT_EQ(a.averageEdge, b.averageEdge);
        EXPECT_EQ(a.report.vertices, b.report.vertices);
        EXPECT_EQ(a.report.welded, b.report.welded);
        EXPECT_EQ(a.report.isolated, b.report.isolated);
        EXPECT_EQ(a.report.components, b.report.components);
        EXPECT_EQ(a.report.nonManifoldEdges, b.report.nonManifoldEdges);
        EXPECT_EQ(a.report.repeatedFaces, b.report.repeatedFaces);
        EXPECT_EQ(a.report.degenerateFaces, b.report.degenerateFaces);
        EXPECT_EQ(a.report.seams, b.report.seams);
        EXPECT_EQ(a.report.gaps, b.report.gaps);
        EXPECT_EQ(a.report.oneSided, b.report.oneSided);
        EXPECT_EQ(a.report.pointCloud, b.report.pointCloud);
    }
};

} // namespace

TEST(TakeRegions, GivesTheBitsOfReadingEachAlone) {
    for (int rings : {20, 150}) // of one block of nodes, and of several
        for (bool spoiled : {false, true}) {
            Crumbs crumbs(Sphere(rings, rings));
            crumbs.Scatter(rings > 100 ? 80 : 40, 1.5, unsigned(rings));
            if (spoiled)
                crumbs.Spoil();
            for (unsigned threads : {1u, 3u})
                EXPECT_EQ(std::min(crumbs.Check(threads), Index(2)), spoiled ? 2 : 1) << rings << " rings";
        }
}

TEST(TakeRegions, DividesAtWhatIsHeld) {
    for (bool spoiled : {false, true}) {
        Crumbs crumbs(Sphere(60, 60));
        for (std::size_t i = 0; i < crumbs.tag.size(); ++i) // belts
            if (std::abs(crumbs.shape.position[i][2]) < 0.1)
                crumbs.tag[i] = crumbs.shape.position[i][2] > 0 ? 3 : 0;
        crumbs.Scatter(20, 0.7, 3);
        if (spoiled)
            crumbs.Spoil();
        for (unsigned threads : {1u, 3u})
            EXPECT_EQ(std::min(crumbs.Check(threads), Index(3)), spoiled ? 3 : 2);
    }
}

TEST(TakeRegions, TakesSeamsAndHeldVerticesBesideFreeOnes) {
    Crumbs seam(Sphere(20, 24));
    seam.Add(Moved(Grid(3, 3), Affine3d(Eigen::Scaling(0.1))));
    std::fill(seam.tag.end() - 2, seam.tag.end(), 0);
    seam.Add(Moved(Grid(3, 3), Eigen::Translation3d(0.2 + 1e-8, 0, 0) * Affine3d(Eigen::Scaling(0.1))));
    // A fixed vertex at the position of a free one, without a common face.
    const auto free = std::find(seam.tag.begin(), seam.tag.end(), 1) - seam.tag.begin();
    Shape fixed = Moved(Triangle(), Affine3d(Eigen::Translation3d(seam.shape.position[std::size_t(free)])));
    fixed.position[1] = fixed.position[2] = Vector3d::Zero();
    seam.Add(fixed);
    std::fill(seam.tag.end() - 3, seam.tag.end(), 0);
    EXPECT_EQ(seam.Check(2), 2);
}

TEST(FindRegions, JoinsTheSmallestWhereThereAreVeryMany) {
    Crumbs many(Sphere(20, 24));
    for (int i = 0; i < SurfaceRegions::most + 20; ++i) {
        many.Add(Moved(Fan(4 + i % 3), Eigen::Translation3d(20.0 * i, 30, 0) * Eigen::Scaling(1.0 + i % 5)));
        many.tag.back() = 2;
    }
    const Arrays arrays = Read(MeshD(many.shape));
    const SurfaceGraph surface = ReadFreeSurface(SurfaceView(arrays), many.tag, Eigen::Matrix3d::Identity(), {});
    const SurfaceRegions regions = FindRegions(surface, FindComponents(surface, surface.tag, {}));
    EXPECT_EQ(regions.count, SurfaceRegions::most);
    EXPECT_EQ(regions.together, 22); // with the sphere, and the one that they become
    std::vector<double> area(std::size_t(regions.count), 0);
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (const Index region = regions.regionOf[std::size_t(u)]; region >= 0)
            area[std::size_t(region)] += double(surface.nodeArea[std::size_t(u)]);
    for (std::size_t r = 1; r + 1 < area.size(); ++r)
        EXPECT_LE(area[r], area[r - 1]);
}

TEST(CloudParts, GiveAllThatIsInReach) {
    const Shape cloud = Points(Sphere(60, 60));
    const Arrays arrays = Read(MeshD(cloud));
    const SurfaceView view(arrays);
    const auto isLive = [](std::size_t i) { return i % 7 != 3; };
    Eigen::Matrix3d metric = Eigen::Matrix3d::Identity();
    metric(0, 1) = 0.5;
    const detail::CloudParts parts(view, isLive, metric, {});
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 0; i < view.vertexSlots; ++i)
        if (isLive(i) && view.At(i)[2] > 0.9)
            some.push_back(i);
    bool isPart = false;
    double reach = 0;
    for (double asked = 0; std::isfinite(reach); asked = 2 * reach) {
        reach = asked;
        const std::vector<std::uint32_t> around = parts.Around(some, 20, reach);
        isPart |= around.size() < cloud.position.size() / 2;
        EXPECT_TRUE(std::is_sorted(around.begin(), around.end()));
        EXPECT_GT(reach, 0);
        EXPECT_GE(reach, asked);
        for (std::uint32_t i = 0; i < view.vertexSlots; ++i) {
            const bool isNear = std::any_of(some.begin(), some.end(), [&](std::uint32_t j) {
                return (metric * (view.At(i) - view.At(j))).norm() <= reach;
            });
            if (std::binary_search(around.begin(), around.end(), i))
                EXPECT_TRUE(isLive(i));
            else
                EXPECT_FALSE(isLive(i) && isNear);
        }
    }
    EXPECT_TRUE(isPart);
}

TEST(CloudParts, ReachBeyondTheNeighboursAlsoOnAPlaneAndALine) {
    for (const auto &[nx, ny] : {std::pair(100, 100), std::pair(10000, 1)}) {
        const Arrays arrays = Read(MeshD(Points(Grid(nx, ny)))); // one apart
        const SurfaceView view(arrays);
        const detail::CloudParts parts(view, [](std::size_t) { return true; }, Eigen::Matrix3d::Identity(), {});
        double reach = 0;
        const std::vector<std::uint32_t> around = parts.Around({0, 1, 2, 3, 4, 5, 6, 7}, 8, reach);
        EXPECT_GT(reach, 1.5);
        EXPECT_LT(around.size(), 1000U);
    }
}
