// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/loose_parts.h>
#include <vcg_ext/surface/part_removal.h>
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
    /// So many small ones inside of the ball of a radius.
    void Scatter(int parts, double radius, unsigned seed) {
        std::mt19937 random(seed);
        const std::vector<Shape> kinds{Sphere(4, 6), Fan(5), Unwelded(Sphere(3, 4)), Fan3()};
        for (int i = 0; i < parts; ++i)
            Add(Moved(kinds[std::size_t(i) % kinds.size()],
                      Eigen::Translation3d(radius * RandomVector(random).normalized()) * Eigen::Scaling(0.003)));
    }
    /// Faces that are there twice, without an area, and a third one at an edge, and free vertices at one place,
    /// everywhere.
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

    /// \return whether the parts could be taken out; then all is as if they were not read
    bool Check(unsigned threads) const {
        const Arrays arrays = Read(MeshD(shape));
        const SurfaceView view(arrays);
        const Eigen::Matrix3d metric = Vector3d(1, 1.5, 0.7).asDiagonal();
        const Progress progress = Threads(threads);
        SurfaceGraph surface = ReadFreeSurface(view, tag, {}, metric, progress);
        const LooseSurface loose = FindLoose(tag, {}, surface, surface.tag, progress);
        EXPECT_TRUE(loose.isPartOfSurface);
        const SurfaceGraph before = surface, again = ReadFreeSurface(view, tag, loose.partOf, metric, progress);
        const bool removed = RemoveParts(view, loose.partOf, progress, surface);
        ExpectSame(surface, removed ? again : before);
        return removed;
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
        EXPECT_EQ(a.apart, b.apart);
        EXPECT_EQ(a.tag, b.tag);
        EXPECT_EQ(a.nodeArea, b.nodeArea);
        EXPECT_EQ(a.area, b.area);
        EXPECT_EQ(a.averageEdge, b.averageEdge);
        EXPECT_EQ(a.componentOf, b.componentOf);
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

TEST(RemoveParts, GivesTheBitsOfReadingWithoutThem) {
    for (int rings : {20, 150}) // of one block of nodes, and of several
        for (bool spoiled : {false, true}) {
            Crumbs crumbs(Sphere(rings, rings));
            crumbs.Scatter(rings > 100 ? 300 : 40, 0.7, unsigned(rings));
            if (spoiled)
                crumbs.Spoil();
            for (unsigned threads : {1u, 3u})
                EXPECT_TRUE(crumbs.Check(threads)) << rings << " rings, " << spoiled;
        }
}

TEST(RemoveParts, LeavesASurfaceOfWhichMoreWouldChange) {
    const Crumbs whole(Sphere(20, 24));
    Crumbs outside = whole; // the frame would be another one
    outside.Scatter(5, 1.5, 1);
    EXPECT_FALSE(outside.Check(2));
    Crumbs gap = whole; // two sheets whose borders nearly touch
    gap.Add(Moved(Grid(3, 3), Affine3d(Eigen::Scaling(0.1))));
    gap.Add(Moved(Grid(3, 3), Eigen::Translation3d(0.205, 0, 0) * Affine3d(Eigen::Scaling(0.1))));
    EXPECT_FALSE(gap.Check(2));
    Crumbs seam = whole;
    seam.Add(Moved(Grid(3, 3), Affine3d(Eigen::Scaling(0.1))));
    seam.Add(Moved(Grid(3, 3), Eigen::Translation3d(0.2 + 1e-7, 0, 0) * Affine3d(Eigen::Scaling(0.1))));
    EXPECT_FALSE(seam.Check(2));
    Crumbs cloud(Points(Sphere(40, 40)));
    cloud.Add(Moved(Points(Sphere(10, 10)), Affine3d(Eigen::Scaling(0.01))));
    EXPECT_FALSE(cloud.Check(2));
}

TEST(RemoveParts, LeavesASurfaceWithHeldVerticesBesideFreeOnes) {
    Crumbs beside(Sphere(20, 24));
    beside.Scatter(5, 0.7, 1);
    // A fixed vertex that no face joins with a free one, but which is at the place of one.
    const auto free = std::find(beside.tag.begin(), beside.tag.end(), 1) - beside.tag.begin();
    Shape fixed = Moved(Triangle(), Affine3d(Eigen::Translation3d(beside.shape.position[std::size_t(free)])));
    fixed.position[1] = fixed.position[2] = Vector3d::Zero();
    beside.Add(fixed);
    std::fill(beside.tag.end() - 3, beside.tag.end(), 0);
    EXPECT_FALSE(beside.Check(2));
}
