// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/progress.h>
#include "test_support.h"

using namespace vcg::fcd;
using fcd_test::CallbackLog;

TEST(Progress, WithoutCallbackDoesNothing) { EXPECT_NO_THROW(Progress()(0.5, "stage")); }

TEST(Progress, ReportsPercentOfItsSlice) {
    CallbackLog log;
    const Progress all = log.Progress();
    for (double f : {0.0, 0.25, 0.5, 1.0})
        all(f, "stage");
    EXPECT_EQ(log.percent, (std::vector<int>{0, 25, 50, 100}));
}

TEST(Progress, SlicesNest) {
    CallbackLog log;
    const Progress inner = log.Progress().Slice(0.2, 0.6).Slice(0.5, 1);
    for (double f : {0.0, 0.5, 1.0})
        inner(f, "stage");
    EXPECT_EQ(log.percent, (std::vector<int>{40, 50, 60}));
}

TEST(Progress, SlicesInRowAreMonotone) {
    CallbackLog log;
    const Progress all = log.Progress();
    for (int slice = 0; slice < 7; ++slice)
        for (double f = 0; f <= 1; f += 0.05)
            all.Slice(slice / 7.0, (slice + 1) / 7.0)(f, "stage");
    EXPECT_TRUE(std::is_sorted(log.percent.begin(), log.percent.end()));
    EXPECT_EQ(log.percent.front(), 0);
}

TEST(Progress, StaysInItsSlice) {
    CallbackLog log;
    const Progress slice = log.Progress().Slice(0.25, 0.75);
    slice(-3, "stage");
    slice(42, "stage");
    EXPECT_EQ(log.percent, (std::vector<int>{25, 75}));
}

TEST(Progress, SliceKeepsTheThreads) {
    Progress progress;
    progress.threads = 5;
    EXPECT_EQ(progress.Slice(0, 0.5).Slice(0, 0.5).threads, 5u);
}

TEST(Progress, ThrowsWhenTheCallbackCancels) {
    CallbackLog log(1);
    const Progress slice = log.Progress().Slice(0.1, 0.2);
    EXPECT_NO_THROW(slice(0, "stage"));
    EXPECT_THROW(slice(0.5, "stage"), Cancelled);
}

TEST(Progress, PassesTheStageOn) {
    static std::string told;
    const Progress progress(+[](const int, const char *stage) {
        told = stage;
        return true;
    });
    progress(0, "Growing patches");
    EXPECT_EQ(told, "Growing patches");
}

TEST(ProgressParallelFor, ReportsFromTheCallingThread) {
    for (unsigned threads : {1u, 2u, 7u}) {
        CallbackLog log;
        std::atomic<std::size_t> done{0};
        ParallelFor(log.Progress(threads).Slice(0.5, 1), "stage", 1000, 10,
                    [&](std::size_t first, std::size_t last) { done += last - first; });
        EXPECT_EQ(done, 1000u);
        EXPECT_TRUE(std::is_sorted(log.percent.begin(), log.percent.end()));
        for (int percent : log.percent)
            EXPECT_GE(percent, 50);
        for (const std::thread::id &id : log.thread)
            EXPECT_EQ(id, std::this_thread::get_id());
        if (threads == 1) {
            EXPECT_EQ(log.percent.size(), 100u);
        }
    }
}

TEST(ProgressParallelFor, CanBeCancelled) {
    CallbackLog log(3);
    int calls = 0;
    EXPECT_THROW(ParallelFor(log.Progress(1), "stage", 1000, 10, [&](std::size_t, std::size_t) { ++calls; }),
                 Cancelled);
    EXPECT_EQ(calls, 3);
}

TEST(ParallelTasks, ReportOneThreadAndAllOfThemCanBeCancelled) {
    for (unsigned threads : {1u, 2u, 4u})
        for (const bool nested : {false, true}) {
            CallbackLog log(30);
            std::atomic<int> begun{0};
            const auto task = [&](std::size_t, const Progress &progress) {
                ++begun;
                for (;;) { // until it is cancelled
                    progress(0.5, "stage");
                    std::this_thread::sleep_for(std::chrono::milliseconds(1));
                }
            };
            const auto run = [&](const Progress &progress) { ParallelTasks(progress, "stage", 4, task); };
            EXPECT_THROW(nested ? ParallelTasks(log.Progress(threads), "stage", 2,
                                                [&](std::size_t, const Progress &inner) { run(inner); })
                                : run(log.Progress(threads)),
                         Cancelled);
            EXPECT_GE(begun, 1);
            EXPECT_EQ(log.percent.size(), 31u);
            for (const std::thread::id &id : log.thread)
                EXPECT_EQ(id, std::this_thread::get_id());
        }
}

TEST(ParallelTasks, CanBeCancelledWhileThisThreadHasNothingLeftToDo) {
    const std::thread::id caller = std::this_thread::get_id();
    CallbackLog log(2);
    std::atomic<bool> otherBegan{false};
    EXPECT_THROW(ParallelTasks(log.Progress(2), "stage", 2,
                               [&](std::size_t, const Progress &progress) {
                                   if (std::this_thread::get_id() == caller) {
                                       while (!otherBegan)
                                           std::this_thread::yield();
                                       return;
                                   }
                                   for (otherBegan = true;; std::this_thread::yield())
                                       progress(0.5, "stage");
                               }),
                 Cancelled);
    EXPECT_EQ(log.percent.size(), 3u);
}
