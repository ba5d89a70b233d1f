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

/// Calls body(i, hint) for each of \p n points, by all threads, in an order in which neighbours in space follow each
/// other. Their lookups then hit the processor's cache, which halves the time. Results do not depend on the order. The
/// hint is that of the point before. \param box of the surface; farther points are sorted as if on the sides of a cube
/// twice as wide
template <class Body>
void forInSpaceOrder(const double *points, std::size_t n, const Eigen::AlignedBox3d &box,
                     const vcg::fcd::Progress &progress, const char *stage, const Body &body) {
    constexpr std::size_t block = 1 << 22, grain = 1 << 12; // a block needs 64 MB of memory at most
    const double size = std::max(box.sizes().maxCoeff(), std::numeric_limits<double>::min());
    const Eigen::Vector3d center = 0.5 * box.min() + 0.5 * box.max();
    for (std::size_t begin = 0; begin < n; begin += block) {
        const std::size_t count = std::min(block, n - begin);
        const double from = double(begin) / double(n), to = double(begin + count) / double(n);
        std::unique_ptr<std::uint64_t[]> items = vcg::fcd::LargeArray<std::uint64_t>(count);
        vcg::fcd::ParallelFor(progress.threads, count, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const Eigen::Vector3d p = (rowOf(points, begin + i) - center) / size;
                const bool isPlace = p.allFinite();
                const auto axis = [&](int d) { return isPlace ? float(std::min(1.0, std::max(-1.0, p[d]))) : 0.f; };
                items[i] = std::uint64_t(vcg::fcd::detail::MortonCode(axis(0), axis(1), axis(2))) << 32 | i;
            }
        });
        vcg::fcd::Progress sorting; // takes a twentieth of the time
        sorting.threads = progress.threads;
        vcg::fcd::detail::RadixSortUpper30(items, count, sorting);
        vcg::fcd::ParallelFor(progress.Slice(from, to), stage, count, grain, [&](std::size_t first, std::size_t last) {
            vcg::fcd::NearestPlace::Hint hint;
            const auto number = [&](std::size_t i) { return begin + std::size_t(items[i] & 0xFFFFFFFF); };
            for (std::size_t i = first; i < last; ++i) {
#ifdef __GNUC__
                if (i + 8 < last) // the processor cannot foresee the address: saves a tenth of the time
                    __builtin_prefetch(points + 3 * number(i + 8));
#endif
                body(number(i), hint);
            }
        });
    }
}

#endif
