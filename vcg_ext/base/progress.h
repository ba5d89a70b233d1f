// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PROGRESS_H
#define VCG_FCD_PROGRESS_H

#include <vcg_ext/base/error.h>
#include <vcg_ext/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace vcg::fcd {

/// Gets the percentage that is done and the name of the stage; returns false to cancel. As vcg::CallBackPos.
using ProgressCallback = bool(const int, const char *);

/// The name of the stage in which a mesh is read.
constexpr const char *readingStage = "Reading the mesh";

/// Reports progress, can cancel, and tells how many threads a run may use. Covers a slice [lo, hi] (percent) of a
/// ProgressCallback. The callback is called from the thread that calls the operator only.
class Progress {
  public:
    unsigned threads = 0; ///< threads of the parallel loops; 0 = one a core. The result does not depend on it.

    Progress() = default;
    explicit Progress(ProgressCallback *callback, double lo = 0, double hi = 100)
        : callback(callback), lo(lo), hi(hi) {}

    /// The part of this slice between the fractions \p from and \p to (0 ... 1).
    Progress Slice(double from, double to) const {
        Progress slice = *this;
        slice.lo = lo + from * (hi - lo);
        slice.hi = lo + to * (hi - lo);
        return slice;
    }

    /// A copy for tasks in several threads. In this thread it reports; in others it only checks for cancellation.
    /// \param isCancelled shared by all tasks; not used if this is already such a copy, whose flag then counts
    Progress Shared(std::atomic<bool> &isCancelled) const {
        Progress shared = *this;
        if (!shared.isCancelled) {
            shared.isCancelled = &isCancelled;
            shared.reporter = std::this_thread::get_id();
        }
        return shared;
    }

    /// Reports that \p fraction (0 ... 1) of this slice is done. \throw Cancelled the callback returned false
    void operator()(double fraction, const char *stage) const {
        if (isCancelled && *isCancelled)
            throw Cancelled();
        if (isCancelled && std::this_thread::get_id() != reporter)
            return;
        const double percent = lo + std::min(1.0, std::max(0.0, fraction)) * (hi - lo);
        if (callback && !callback(int(percent), stage)) {
            if (isCancelled)
                *isCancelled = true;
            throw Cancelled();
        }
    }

    /// The same for round \p i of \p n of a loop, every 65536 rounds.
    void Round(std::size_t i, std::size_t n, const char *stage) const {
        if (i % (1 << 16) == 0)
            (*this)(double(i) / double(n), stage);
    }

  private:
    ProgressCallback *callback = nullptr;
    double lo = 0, hi = 100;
    std::atomic<bool> *isCancelled = nullptr; ///< shared by tasks in several threads; null: no tasks
    std::thread::id reporter;                 ///< the thread of the tasks that reports
};

/// ParallelFor that reports progress from the calling thread. \throw Cancelled
inline void ParallelFor(const Progress &progress, const char *stage, std::size_t n, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)> &body) {
    const std::thread::id caller = std::this_thread::get_id();
    ParallelFor(progress.threads, n, grain, [&](std::size_t first, std::size_t last) {
        if (std::this_thread::get_id() == caller)
            progress(double(first) / double(n), stage);
        body(first, last);
    });
}

/// The same for each i in [0, n), one after the other in its range.
template <class Body>
void ParallelForEach(const Progress &progress, const char *stage, std::size_t n, std::size_t grain, const Body &body) {
    ParallelFor(progress, stage, n, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            body(i);
    });
}

/// Calls body(i, progress) for each of \p tasks long tasks, in parallel, with a slice of the progress each. All of them
/// can be cancelled by it, also while this thread only waits. \throw Cancelled
inline void ParallelTasks(const Progress &progress, const char *stage, std::size_t tasks,
                          const std::function<void(std::size_t, const Progress &)> &body) {
    std::atomic<bool> isCancelled{false};
    const Progress shared = progress.Shared(isCancelled);
    ParallelFor(
        progress.threads, tasks, 1,
        [&](std::size_t i, std::size_t) {
            body(i, shared.Slice(double(i) / double(tasks), double(i + 1) / double(tasks)));
        },
        [&] { shared(1, stage); });
}

/// Wall-clock time since it was made.
class Stopwatch {
  public:
    double Seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start = Clock::now();
};

} // namespace vcg::fcd

#endif
