// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PARALLEL_H
#define VCG_FCD_PARALLEL_H

#include <cstddef>
#include <functional>

namespace vcg {
namespace fcd {

/// Calls body(first, last) for consecutive ranges of at most \p grain items that cover [0, n). Which thread gets which
/// range is left open, the ranges are not: a body that writes only what belongs to its range gives the same bits for
/// any number of threads. \p threads 0 = one a core. A thread that cannot be started is done without. The first
/// exception is rethrown here.
void ParallelFor(unsigned threads, std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)> &body);

} // namespace fcd
} // namespace vcg

#endif
