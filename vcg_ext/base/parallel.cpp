// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/parallel.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace vcg::fcd {

unsigned ThreadsFor(unsigned threads) { return threads ? threads : std::max(1u, std::thread::hardware_concurrency()); }

void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)> &body, const std::function<void()> &whileWaiting) {
    assert(grain > 0);
    const std::size_t ranges = (n + grain - 1) / grain;
    const std::size_t count = std::min<std::size_t>(ThreadsFor(threads), ranges);
    if (count <= 1) {
        for (std::size_t i = 0; i < ranges; ++i)
            body(i * grain, std::min(n, (i + 1) * grain));
        return;
    }
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex lock; // of failure and of finished
    std::condition_variable isFinished;
    std::size_t finished = 0; // helpers
    auto attempt = [&](const auto &what) {
        try {
            what();
            return true;
        } catch (...) {
            next = ranges;
            std::lock_guard<std::mutex> guard(lock);
            if (!failure)
                failure = std::current_exception();
            return false;
        }
    };
    auto work = [&] {
        attempt([&] {
            for (std::size_t i; (i = next++) < ranges;)
                body(i * grain, std::min(n, (i + 1) * grain));
        });
    };
    std::vector<std::thread> helpers;
    helpers.reserve(count);
    try {
        for (std::size_t t = 1; t < count; ++t)
            helpers.emplace_back([&] {
                work();
                std::lock_guard<std::mutex> guard(lock);
                ++finished;
                isFinished.notify_one();
            });
    } catch (const std::exception &) { // no further thread: do with fewer
    }
    work();
    for (bool waits = bool(whileWaiting); waits;) {
        {
            std::unique_lock<std::mutex> guard(lock);
            waits =
                !isFinished.wait_for(guard, std::chrono::milliseconds(50), [&] { return finished == helpers.size(); });
        }
        waits = waits && attempt(whileWaiting);
    }
    for (std::thread &t : helpers)
        t.join();
    if (failure)
        std::rethrow_exception(failure);
}

void ParallelForAdding(unsigned threads, std::size_t n, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)> &compute,
                       const std::function<void(std::size_t, std::size_t)> &add) {
    // Sequentially consistent: a thread that finds another one adding may leave, since that one looks again.
    std::array<std::atomic<bool>, rangesAhead> ready{};
    std::atomic<std::size_t> added{0}; // items
    std::atomic<bool> isAdding{false}, failed{false};
    const auto place = [&](std::size_t first) -> std::atomic<bool> & { return ready[first / grain % rangesAhead]; };
    const auto addReady = [&] {
        while (added < n && place(added) && !isAdding.exchange(true)) {
            for (std::size_t first; (first = added) < n && place(first);) {
                const std::size_t last = std::min(n, first + grain);
                add(first, last);
                place(first) = false;
                added = last;
            }
            isAdding = false;
        }
    };
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        try {
            while (first >= added + rangesAhead * grain) {
                if (failed)
                    return;
                std::this_thread::sleep_for(std::chrono::microseconds(100));
            }
            compute(first, last);
            place(first) = true;
            addReady();
        } catch (...) {
            failed = true;
            throw;
        }
    });
}

} // namespace vcg::fcd
