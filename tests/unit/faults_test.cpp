// SPDX-License-Identifier: GPL-3.0-or-later
//
// Memory that runs out at any allocation, and threads that do not start; linked with faults.cpp.
#include <vcg_ext/centroidal_deformation.h>
#include <vcg_ext/surface/nearest_place.h>
#include "faults.h"
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using namespace fcd_test::faults;
using vcg::tri::BuildCentroidalGraph;
using vcg::tri::DeformCentroidal;

/// A tube with a seam, an isolated vertex and a loose part; few patches for many nodes, so that even so small a mesh
/// makes use of threads.
struct SmallRun {
    Case c = CaseOf(Join(Unwelded(Tube(16, 10)), Join(Grid(3, 3, 0.2, 10), Shape{{{3, 3, 3}}, {}, {}})),
                    [](const Eigen::Vector3d &p) { return p[2] > 6 || p[0] > 2 ? 1 : TubeTag(p); });
    MeshD mesh{c.shape};
    DeformationParam param;

    SmallRun() {
        param.graph.initialPatches = 2;
        param.graph.targetRadius = 2;
        param.maxIterations = 4;
        c.handles.point.push_back({c.handles.tag.size() / 2, Eigen::Vector3d(1, 1, 1)});
        c.handles.tag[c.handles.tag.size() / 2] = 1;
    }
    void Deform(unsigned threads) const { DeformCentroidal(mesh, c.handles, param, Threads(threads)); }
    void BuildGraph(unsigned threads) const { BuildCentroidalGraph(mesh, param.graph, Threads(threads)); }
};

template <class T>
static bool SameBytes(const std::vector<T> &a, const std::vector<T> &b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Lets each allocation of \p body fail in turn: this one only, and this one and all after it.
template <class Body>
static void ExpectNoMemoryIsClean(const MeshD &mesh, const Body &body) {
    body(); // makes allocations that happen only once
    const std::vector<VertexD> vert = mesh.vert;
    const std::vector<FaceD> face = mesh.face;
    const long before = requests;
    body();
    const long count = requests - before;
    ASSERT_GT(count, 50);
    for (bool all : {false, true}) {
        forGood = all;
        long failed = 0;
        for (long k = 0; k < count; k += sanitized ? 7 : 1) {
            const long liveBefore = live;
            countdown = k;
            try {
                body();
            } catch (const std::bad_alloc &) {
                ++failed;
            }
            countdown = never;
            ASSERT_EQ(live, liveBefore) << "allocation " << k << " of " << count;
        }
        EXPECT_GT(failed,
                  count / (sanitized ? 14 : 2)); // some may fail without harm: the buffer of a stable sort, a thread
    }
    EXPECT_TRUE(SameBytes(vert, mesh.vert));
    EXPECT_TRUE(SameBytes(face, mesh.face));
    EXPECT_TRUE(mesh.vert_attr.empty() && mesh.face_attr.empty() && mesh.mesh_attr.empty());
}

TEST(OutOfMemory, WhileDeforming) {
    const SmallRun run;
    for (unsigned threads : {1u, 3u})
        ExpectNoMemoryIsClean(run.mesh, [&] { run.Deform(threads); });
}

TEST(OutOfMemory, WhileBuildingTheGraph) {
    const SmallRun run;
    for (unsigned threads : {1u, 3u})
        ExpectNoMemoryIsClean(run.mesh, [&] { run.BuildGraph(threads); });
}

TEST(OutOfMemory, WhileReadingPoints) {
    const MeshD cloud(PointCloud(300));
    ExpectNoMemoryIsClean(cloud, [&] { BuildCentroidalGraph(cloud, {}, Threads(2)); });
}

TEST(OutOfMemory, InAllThreadsAtOnce) {
    forGood = true;
    for (long k = 0; k < 90; ++k) { // of 100 allocations at least
        const long liveBefore = live;
        countdown = k;
        EXPECT_THROW(ParallelFor(7, 100, 1,
                                 [](std::size_t i, std::size_t) {
                                     const std::vector<int> memory(i + 100);
                                     const int *volatile used =
                                         memory.data(); // else the compiler removes the allocation
                                     (void)used;
                                 }),
                     std::bad_alloc);
        countdown = never;
        ASSERT_EQ(live, liveBefore) << k;
    }
}

TEST(Cancel, LeavesNothingBehind) {
    const SmallRun run;
    run.Deform(3);
    for (unsigned threads : {1u, 3u})
        for (std::size_t k = 0;; ++k) {
            CallbackLog log(k);
            log.percent.reserve(1000);
            log.thread.reserve(1000);
            const long liveBefore = live;
            bool cancelled = false;
            try {
                DeformCentroidal(run.mesh, run.c.handles, run.param, log.Progress(threads));
            } catch (const Cancelled &) {
                cancelled = true;
            }
            ASSERT_EQ(live, liveBefore) << "callback " << k;
            ASSERT_LT(log.percent.size(), 1000u);
            if (!cancelled) { // there are fewer calls
                EXPECT_GT(k, 20u);
                break;
            }
            EXPECT_EQ(log.percent.size(), k + 1) << "called again after the cancel";
        }
}

TEST(NoThreads, TheResultIsTheSame) {
    const SmallRun run;
    const Eigen::Matrix3Xd expected = DeformCentroidal(run.mesh, run.c.handles, run.param, Threads(3)).position;
    for (long left : {0, 1}) {
        threadsLeft = left;
        const DeformationResult fewer = DeformCentroidal(run.mesh, run.c.handles, run.param, Threads(3));
        EXPECT_LT(threadsLeft, 0) << "no thread was asked for";
        std::atomic<int> ran{0};
        threadsLeft = left;
        ParallelFor(8, 100, 1, [&](std::size_t, std::size_t) { ++ran; });
        threadsLeft = never;
        EXPECT_TRUE(SameBits(fewer.position, expected));
        EXPECT_EQ(ran, 100);
    }
}

TEST(NoThreads, ATreeOfTrianglesStartsNoMoreThanAreAskedFor) {
    const Shape sheet = Grid(400, 400); // even its quarters are divided among threads
    Eigen::Matrix3Xd position(3, sheet.Size());
    std::vector<std::array<Index, 3>> triangle;
    for (int i = 0; i < sheet.Size(); ++i)
        position.col(i) = sheet.position[std::size_t(i)];
    for (const auto &f : sheet.face)
        triangle.push_back({f[0], f[1], f[2]});
    for (const unsigned threads : {1u, 2u, 4u, 16u}) {
        const long many = 1000000;
        threadsLeft = many;
        const NearestPlace nearest(position, triangle, {}, Threads(threads));
        const long started = many - threadsLeft;
        threadsLeft = never;
        // Threads for the boxes, for two halves, and for four quarters.
        EXPECT_LE(started, 3 * long(threads - 1) + long(threads)) << threads;
        EXPECT_EQ(started > 0, threads > 1) << threads;
    }
}
