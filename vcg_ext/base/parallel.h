// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PARALLEL_H
#define VCG_FCD_PARALLEL_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>

namespace vcg::fcd {

/// Calls body(first, last) for consecutive ranges of at most \p grain items that cover [0, n). Which thread gets which
/// range is left open, the ranges are not: a body that writes only what belongs to its range gives the same bits for
/// any number of threads. \p threads 0 = one a core. A thread that cannot be started is done without. The first
/// exception is rethrown here. \param whileWaiting if given: called some times a second once this thread has nothing
/// left to do but to wait for others; what it throws is the loop's exception
void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)> &body,
                 const std::function<void()> &whileWaiting = {});

/// How many threads \p threads stands for, where 0 = one a core.
unsigned ThreadsFor(unsigned threads);

/// What may be computed but not yet added by ParallelForAdding, ranges: so few that their results stay in a cache.
constexpr std::size_t rangesAhead = 32;

/// For what is computed in any order and added up in one: compute(first, last) as ParallelFor's body, and for each
/// range after it add(first, last), one after the other in their order, by whichever thread has computed the next one.
/// Their results are in RangeResults. No thread waits for a slow one but where it is as far ahead as these have room:
/// where other programs keep the cores busy, each wait lasts a time slice.
void ParallelForAdding(unsigned threads, std::size_t n, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)> &compute,
                       const std::function<void(std::size_t, std::size_t)> &add);

/// Room for what ParallelForAdding computes of each range, from then until it is added; not initialised.
template <class Result>
class RangeResults {
  public:
    RangeResults(std::size_t n, std::size_t grain)
        : grain(grain), results(new Result[std::min((n + grain - 1) / grain, rangesAhead)]) {}

    /// Of the range that the item \p i is in.
    Result &Of(std::size_t i) const { return results[i / grain % rangesAhead]; }

  private:
    std::size_t grain;
    std::unique_ptr<Result[]> results;
};

} // namespace vcg::fcd

#endif
