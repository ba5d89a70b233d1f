// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <gtest/gtest.h>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

using vcg::fcd::ParallelFor;
using Ranges = std::multiset<std::pair<std::size_t, std::size_t>>;

static Ranges RangesOf(unsigned threads, std::size_t n, std::size_t grain) {
    Ranges ranges;
    std::mutex lock;
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        std::lock_guard<std::mutex> guard(lock);
        ranges.emplace(first, last);
    });
    return ranges;
}

TEST(ParallelFor, CoversEverythingOnceInTheSameRanges) {
    for (std::size_t n : {0, 1, 2, 15, 16, 17, 1000})
        for (std::size_t grain : {1, 3, 16, 5000}) {
            Ranges expected;
            for (std::size_t first = 0; first < n; first += grain)
                expected.emplace(first, std::min(n, first + grain));
            for (unsigned threads : {0u, 1u, 2u, 7u, 64u})
                EXPECT_EQ(RangesOf(threads, n, grain), expected) << n << " by " << grain << ", " << threads;
        }
}

TEST(ParallelForEach, CallsEachItemOnce) {
    std::vector<std::atomic<int>> calls(100);
    vcg::fcd::ParallelForEach(3, calls.size(), 8, [&](std::size_t i) { ++calls[i]; });
    EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const std::atomic<int> &each) { return each == 1; }));
}

TEST(ParallelFor, DoesNothingForNoItems) {
    ParallelFor(3, 0, 10, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(ParallelFor, RethrowsTheFirstException) {
    try {
        ParallelFor(1, 100, 1, [](std::size_t first, std::size_t) {
            if (first >= 10)
                throw std::out_of_range(std::to_string(first));
        });
        FAIL();
    } catch (const std::out_of_range &e) {
        EXPECT_STREQ(e.what(), "10");
    }
}

TEST(ParallelFor, RethrowsOneOfSeveralExceptions) {
    for (unsigned threads : {2u, 7u})
        for (int round = 0; round < 50; ++round)
            EXPECT_THROW(
                ParallelFor(threads, 100, 1, [](std::size_t, std::size_t) { throw std::length_error("range"); }),
                std::length_error);
}

TEST(ParallelFor, StopsAfterAnException) {
    int calls = 0;
    EXPECT_THROW(ParallelFor(1, 100, 1,
                             [&](std::size_t, std::size_t) {
                                 ++calls;
                                 throw std::runtime_error("stop");
                             }),
                 std::runtime_error);
    EXPECT_EQ(calls, 1);
}

TEST(ParallelFor, MayBeNested) {
    std::atomic<int> items{0};
    ParallelFor(3, 8, 1, [&](std::size_t, std::size_t) {
        ParallelFor(3, 10, 4, [&](std::size_t first, std::size_t last) { items += int(last - first); });
    });
    EXPECT_EQ(items, 80);
}

TEST(LoopHelpers, ServeAllLoopsOfACall) {
    std::set<std::thread::id> threads;
    std::mutex lock;
    const auto note = [&](std::size_t, std::size_t) {
        const std::lock_guard<std::mutex> guard(lock);
        threads.insert(std::this_thread::get_id());
    };
    const vcg::fcd::LoopHelpers helpers;
    std::atomic<int> begun{0};
    ParallelFor(3, 3, 1, [&](std::size_t first, std::size_t last) {
        ++begun;
        while (begun < 3) // until all three threads are here
            std::this_thread::yield();
        for (int round = 0; round < 30; ++round) {
            const vcg::fcd::LoopHelpers others; // of no effect
            ParallelFor(3, 5, 1, note);
        }
        note(first, last);
    });
    for (int round = 0; round < 30; ++round)
        ParallelFor(2, 5, 1, note);
    EXPECT_EQ(threads.size(), 3u);
}

TEST(LoopHelpers, AreNotWaitedForUnlessTheyTakePart) {
    const vcg::fcd::LoopHelpers helpers;
    std::atomic<bool> hasEnded{false};
    int rounds = 0;
    ParallelFor(2, 2, 1, [&](std::size_t first, std::size_t) {
        if (first == 1) // the other thread, until the loops within have ended
            while (!hasEnded)
                std::this_thread::yield();
        for (; first == 0 && rounds < 50; ++rounds)
            ParallelFor(2, 2, 1, [](std::size_t, std::size_t) {});
        hasEnded = true;
    });
    EXPECT_EQ(rounds, 50);
}

TEST(LoopHelpers, LeaveEachLoopItsOwnException) {
    const vcg::fcd::LoopHelpers helpers;
    std::atomic<int> caught{0};
    ParallelFor(3, 12, 1, [&](std::size_t first, std::size_t) {
        try {
            ParallelFor(3, 20, 1, [&](std::size_t i, std::size_t) {
                if (i == 7)
                    throw std::out_of_range(std::to_string(first));
            });
        } catch (const std::out_of_range &e) {
            caught += e.what() == std::to_string(first);
        }
    });
    EXPECT_EQ(caught, 12);
}

TEST(ParallelForAdding, AddsInOrderWhatIsComputedBeforeItAndStillThere) {
    using vcg::fcd::rangesAhead;
    for (std::size_t grain : {1, 3})
        for (std::size_t n : {std::size_t(0), std::size_t(1), rangesAhead, 7 * rangesAhead * grain - 1})
            for (unsigned threads : {1u, 2u, 5u}) {
                std::vector<std::size_t> place(rangesAhead, n); // the last range computed in each place
                std::vector<std::size_t> added;
                vcg::fcd::ParallelForAdding(
                    threads, n, grain,
                    [&](std::size_t first, std::size_t last) {
                        EXPECT_LE(last - first, grain);
                        place[first / grain % rangesAhead] = first;
                    },
                    [&](std::size_t first, std::size_t last) {
                        EXPECT_EQ(place[first / grain % rangesAhead], first);
                        for (std::size_t i = first; i < last; ++i)
                            added.push_back(i);
                    });
                ASSERT_EQ(added.size(), n);
                for (std::size_t i = 0; i < n; ++i)
                    ASSERT_EQ(added[i], i);
            }
}

TEST(ParallelForAdding, GoesOnWhileAThreadIsSlow) {
    std::atomic<std::size_t> computed{0};
    std::size_t ahead = 0;
    vcg::fcd::ParallelForAdding(
        2, 10 * vcg::fcd::rangesAhead, 1,
        [&](std::size_t first, std::size_t) {
            if (first == 0)
                while (computed < vcg::fcd::rangesAhead - 1) // the other thread has no more room
                    std::this_thread::yield();
            ++computed;
        },
        [&](std::size_t first, std::size_t) { ahead = std::max(ahead, computed - first); });
    EXPECT_EQ(ahead, vcg::fcd::rangesAhead);
}

TEST(ParallelForAdding, EndsAfterAnException) {
    for (bool adding : {false, true})
        for (unsigned threads : {1u, 3u})
            EXPECT_THROW(vcg::fcd::ParallelForAdding(
                             threads, 100 * vcg::fcd::rangesAhead, 1,
                             [&](std::size_t first, std::size_t) {
                                 if (first == 5 && !adding)
                                     throw std::length_error("range");
                             },
                             [&](std::size_t first, std::size_t) {
                                 if (first == 5 && adding)
                                     throw std::length_error("range");
                             }),
                         std::length_error);
}
