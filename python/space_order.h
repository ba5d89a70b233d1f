// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_SPACE_ORDER_H
#define PYMESHLAB_FCD_SPACE_ORDER_H

#include "arrays.h"

#include <vcg_ext/base/morton.h>
#include <vcg_ext/surface/nearest_place.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

/// Calls body(numbers, hint) for some hundreds at a time of \p n points, by all threads, in an order in which
/// neighbours in space follow each other. Their lookups then hit the processor's cache, which halves the time. Results
/// do not depend on the order. The hint is for the body, from one point to the next. \param box of the surface; farther
/// points are sorted as if on the sides of a cube twice as wide
template <class Body>
void forRangesInSpace(const double *points, std::size_t n, const Eigen::AlignedBox3d &box,
                      const vcg::fcd::Progress &progress, const char *stage, const Body &body) {
    constexpr std::size_t block = 1 << 22, grain = 1 << 12; // a block needs 64 MB of memory at most
    constexpr std::size_t together = 512;                   // what is kept of them fits into the processor's cache
    const double size = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());
    const Eigen::Vector3d center = 0.5 * box.min() + 0.5 * box.max();
    for (std::size_t begin = 0; begin < n; begin += block) {
        const std::size_t count = std::min(block, n - begin);
        const double from = double(begin) / double(n), to = double(begin + count) / double(n);
        std::unique_ptr<std::uint64_t[]> items = vcg::fcd::LargeArray<std::uint64_t>(count);
        vcg::fcd::ParallelForEach(progress.threads, count, grain, [&](std::size_t i) {
            const Eigen::Vector3d p = (rowOf(points, begin + i) - center) / size;
            const bool isPlace = p.allFinite();
            const auto axis = [&](int d) { return isPlace ? float(std::min(1.0, std::max(-1.0, p[d]))) : 0.f; };
            items[i] = std::uint64_t(vcg::fcd::detail::MortonCode(axis(0), axis(1), axis(2))) << 32 | i;
        });
        vcg::fcd::Progress sorting; // takes a twentieth of the time
        sorting.threads = progress.threads;
        vcg::fcd::detail::RadixSortUpper30(items, count, sorting);
        vcg::fcd::ParallelFor(progress.Slice(from, to), stage, count, grain, [&](std::size_t first, std::size_t last) {
            vcg::fcd::NearestPlace::Hint hint;
            std::vector<std::size_t> numbers;
            for (std::size_t i = first; i < last; ++i) {
                numbers.push_back(begin + std::size_t(items[i] & 0xFFFFFFFF));
                if (numbers.size() == together || i + 1 == last) {
                    body(numbers, hint);
                    numbers.clear();
                }
            }
        });
    }
}

/// The same with body(i, hint) for each point.
template <class Body>
void forInSpaceOrder(const double *points, std::size_t n, const Eigen::AlignedBox3d &box,
                     const vcg::fcd::Progress &progress, const char *stage, const Body &body) {
    forRangesInSpace(points, n, box, progress, stage,
                     [&](const std::vector<std::size_t> &numbers, vcg::fcd::NearestPlace::Hint &hint) {
                         for (std::size_t i = 0; i < numbers.size(); ++i) {
                             // The processor cannot foresee the address: saves a tenth of the time.
                             vcg::fcd::Prefetch(points + 3 * numbers[std::min(i + 8, numbers.size() - 1)]);
                             body(numbers[i], hint);
                         }
                     });
}

#endif
