// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PARALLEL_H
#define VCG_FCD_PARALLEL_H

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace vcg {
namespace fcd {

/// Calls body(first, last) for consecutive ranges of at most \p grain items that cover [0, n). Which thread gets which
/// range is left open, the ranges are not: a body that writes only what belongs to its range gives the same bits for
/// any number of threads. \p threads 0 = one a core. A thread that cannot be started is done without. The first
/// exception is rethrown here.
inline void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)> &body) {
    const std::size_t ranges = (n + grain - 1) / grain;
    const std::size_t wanted = threads ? threads : std::max(1u, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failureLock;
    auto work = [&] {
        try {
            for (std::size_t i; (i = next++) < ranges;)
                body(i * grain, std::min(n, (i + 1) * grain));
        } catch (...) {
            next = ranges;
            std::lock_guard<std::mutex> guard(failureLock);
            if (!failure)
                failure = std::current_exception();
        }
    };
    std::vector<std::thread> helpers;
    const std::size_t count = std::min(wanted, ranges);
    helpers.reserve(count);
    try {
        for (std::size_t t = 1; t < count; ++t)
            helpers.emplace_back(work);
    } catch (const std::exception &) { // no thread to be had, or no memory for one
    }
    work();
    for (std::thread &t : helpers)
        t.join();
    if (failure)
        std::rethrow_exception(failure);
}

} // namespace fcd
} // namespace vcg

#endif
