// SPDX-License-Identifier: GPL-3.0-or-later
//
// Memory that runs out at any allocation, and threads that do not start. A program of its own: it replaces the
// allocation functions (the linker's --wrap leads Eigen's calls of malloc and its kin here, see CMakeLists.txt).
#include "centroidal_deformation.h"
#include "test_support.h"

#include <cstdlib>
#include <dlfcn.h>
#include <new>
#include <pthread.h>

// --- allocations ---

extern "C" {
void *__real_malloc(std::size_t);
void *__real_calloc(std::size_t, std::size_t);
void *__real_realloc(void *, std::size_t);
void __real_free(void *);
}

static const long never = std::numeric_limits<long>::max();
static std::atomic<long> countdown{never}; // allocations until one fails
static std::atomic<bool> forGood{false};   // and all after it do
static std::atomic<long> requests{0}, live{0};

static bool Fails() {
    ++requests;
    const long left = countdown == never ? 1 : countdown--;
    return left == 0 || (left < 0 && forGood);
}
static void *Counted(void *memory) {
    live += memory != nullptr;
    return memory;
}

extern "C" {
void *__wrap_malloc(std::size_t size) { return Fails() ? nullptr : Counted(__real_malloc(size)); }
void *__wrap_calloc(std::size_t n, std::size_t size) { return Fails() ? nullptr : Counted(__real_calloc(n, size)); }
void *__wrap_realloc(void *old, std::size_t size) {
    if (Fails())
        return nullptr;
    void *memory = __real_realloc(old, size);
    live += !old && memory;
    return memory;
}
void __wrap_free(void *memory) {
    live -= memory != nullptr;
    __real_free(memory);
}
}

void *operator new(std::size_t size) {
    if (void *memory = __wrap_malloc(size))
        return memory;
    throw std::bad_alloc();
}
void *operator new(std::size_t size, const std::nothrow_t &) noexcept { return __wrap_malloc(size); }
void *operator new[](std::size_t size) { return operator new(size); }
void operator delete(void *memory) noexcept { __wrap_free(memory); }
void operator delete(void *memory, std::size_t) noexcept { __wrap_free(memory); }
void operator delete(void *memory, const std::nothrow_t &) noexcept { __wrap_free(memory); }
void operator delete[](void *memory) noexcept { __wrap_free(memory); }
void operator delete[](void *memory, std::size_t) noexcept { __wrap_free(memory); }

// --- threads ---

[[maybe_unused]] static std::atomic<long> threadsLeft{never}; // that can be started
#ifndef FCD_TEST_SANITIZED                                    // sanitizers have a pthread_create of their own
#define FCD_TEST_THREADS
extern "C" int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *data) {
    using Create = int (*)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    return threadsLeft-- > 0 ? create(thread, attributes, run, data) : EAGAIN;
}
#endif

// --- tests ---

using namespace vcg::fcd;
using namespace fcd_test;
using vcg::tri::BuildCentroidalGraph;
using vcg::tri::DeformCentroidal;

/// A tube with a seam, an isolated vertex and a loose part; few patches for many nodes, so that even so small a mesh
/// makes use of threads.
struct SmallRun {
    Case c = CaseOf(Join(Unwelded(Tube(30, 12)), Join(Grid(3, 3, 0.2, 10), Shape{{{3, 3, 3}}, {}, {}})),
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
    body(); // what is allocated once and for all
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
                  count / (sanitized ? 14 : 2)); // some can be done without: the buffer of a stable sort, a thread
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
        EXPECT_THROW(ParallelFor(7, 100, 1, [](std::size_t i, std::size_t) { std::vector<int> memory(i + 100); }),
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

#ifdef FCD_TEST_THREADS
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
#endif
