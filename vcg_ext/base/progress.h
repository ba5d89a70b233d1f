// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PROGRESS_H
#define VCG_FCD_PROGRESS_H

#include <vcg_ext/base/error.h>
#include <vcg_ext/base/parallel.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

namespace vcg {
namespace fcd {

/// Percent that are done, and what is being done; false cancels. As vcg::CallBackPos.
using ProgressCallback = bool(const int, const char *);

/// What Progress calls the time in which a mesh is read.
constexpr const char *readingStage = "Reading the mesh";

/// Progress and cancel as one object, and how many threads the run may use: a [lo, hi] slice (percent) of a
/// ProgressCallback. Copies are cheap; the callback is called only from the thread that calls the operator.
class Progress {
  public:
    unsigned threads = 0; ///< threads of the parallel loops; 0 = one a core. The result does not depend on it.

    Progress() = default;
    explicit Progress(ProgressCallback *callback, double lo = 0, double hi = 100)
        : callback(callback), lo(lo), hi(hi) {}

    /// The part of this slice between the fractions \p from and \p to (0 ... 1).
    Progress Slice(double from, double to) const {
        Progress slice(callback, lo + from * (hi - lo), lo + to * (hi - lo));
        slice.threads = threads;
        return slice;
    }

    /// Reports that \p fraction (0 ... 1) of this slice is done. \throw Cancelled when the callback returns false.
    void operator()(double fraction, const char *stage) const {
        const double percent = lo + std::min(1.0, std::max(0.0, fraction)) * (hi - lo);
        if (callback && !callback(int(percent), stage))
            throw Cancelled();
    }

  private:
    ProgressCallback *callback = nullptr;
    double lo = 0, hi = 100;
};

/// ParallelFor that reports progress as it goes, from the calling thread, which takes its turn. \throw Cancelled
inline void ParallelFor(const Progress &progress, const char *stage, std::size_t n, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)> &body) {
    const std::thread::id caller = std::this_thread::get_id();
    ParallelFor(progress.threads, n, grain, [&](std::size_t first, std::size_t last) {
        if (std::this_thread::get_id() == caller)
            progress(double(first) / double(n), stage);
        body(first, last);
    });
}

/// Wall-clock time since it was made.
class Stopwatch {
  public:
    double Seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start = Clock::now();
};

} // namespace fcd
} // namespace vcg

#endif
