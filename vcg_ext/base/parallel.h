// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PARALLEL_H
#define VCG_FCD_PARALLEL_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>

namespace vcg::fcd {

/// Calls body(first, last) for the ranges of \p grain items that cover [0, n). The ranges do not depend on the threads.
/// So a body that writes only to its range gives the same bits for any number of threads. The first exception is
/// rethrown here.
/// \param threads 0 = one a core; fewer if they cannot be started
/// \param whileWaiting if given, called some times a second while this thread waits for others; its exception counts as
/// the loop's
void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)> &body,
                 const std::function<void()> &whileWaiting = {});

/// Calls body(i) for each i in [0, n), as ParallelFor.
template <class Body>
void ParallelForEach(unsigned threads, std::size_t n, std::size_t grain, const Body &body) {
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            body(i);
    });
}

/// While one lives, the loops of the thread that made it share helper threads, and so do loops within their bodies.
/// The first loop that can use helpers starts them; they end with this object. A loop then waits only for helpers that
/// have taken a range. Without this object, each loop starts its own helpers and waits for their end: some time slices
/// on a busy machine. One LoopHelpers within another does nothing. Use it as a local variable.
class LoopHelpers {
  public:
    LoopHelpers();
    ~LoopHelpers();
    LoopHelpers(const LoopHelpers &) = delete;
    LoopHelpers &operator=(const LoopHelpers &) = delete;

  private:
    class Crew;
    const std::unique_ptr<Crew> own; // null within another
    friend void ParallelFor(unsigned, std::size_t, std::size_t, const std::function<void(std::size_t, std::size_t)> &,
                            const std::function<void()> &);
};

/// The number of threads that \p threads stands for (0 = one a core).
unsigned ThreadsFor(unsigned threads);

/// How many ranges ParallelForAdding may compute ahead of adding: so few that their results stay in a cache.
constexpr std::size_t rangesAhead = 32;

/// Computes in any order, but adds in one. Calls compute(first, last) as ParallelFor calls its body, then add(first,
/// last) for one range after the other. The thread that has computed the next range adds it. RangeResults keeps the
/// results between the two. A thread waits only if it is rangesAhead ranges ahead: with the cores busy, each wait would
/// last a time slice.
void ParallelForAdding(unsigned threads, std::size_t n, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)> &compute,
                       const std::function<void(std::size_t, std::size_t)> &add);

/// Holds the results of ParallelForAdding's compute until they are added; not initialised.
template <class Result>
class RangeResults {
  public:
    RangeResults(std::size_t n, std::size_t grain)
        : grain(grain), results(new Result[std::min((n + grain - 1) / grain, rangesAhead)]) {}

    /// The result of the range with item \p i.
    Result &Of(std::size_t i) const { return results[i / grain % rangesAhead]; }

  private:
    std::size_t grain;
    std::unique_ptr<Result[]> results;
};

} // namespace vcg::fcd

#endif
