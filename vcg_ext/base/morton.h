// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MORTON_H
#define VCG_FCD_MORTON_H

#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace vcg::fcd::detail {

/// Sorts the \p n \p items by (item >> 32) with three passes over 30 bits, stable, in parallel.
inline void RadixSortUpper30(std::unique_ptr<std::uint64_t[]> &items, std::size_t n, const Progress &progress = {},
                             const char *stage = "Sorting") {
    const std::size_t grain = 1 << 16, chunks = (n + grain - 1) / grain, digits = 1024;
    std::unique_ptr<std::uint64_t[]> other = LargeArray<std::uint64_t>(n);
    std::vector<std::uint32_t> count(chunks * digits);
    for (int pass = 0; pass < 3; ++pass) {
        const int shift = 32 + 10 * pass;
        auto digit = [shift](std::uint64_t item) { return (item >> shift) & 1023; };
        std::fill(count.begin(), count.end(), 0);
        ParallelFor(progress.Slice(pass / 3.0, pass / 3.0), stage, n, grain, [&](std::size_t first, std::size_t last) {
            std::uint32_t *c = &count[first / grain * digits];
            for (std::size_t i = first; i < last; ++i)
                ++c[digit(items[i])];
        });
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < digits; ++d)
            for (std::size_t c = 0; c < chunks; ++c) {
                const std::uint32_t here = count[c * digits + d];
                count[c * digits + d] = sum;
                sum += here;
            }
        ParallelFor(progress.Slice(pass / 3.0, (pass + 1) / 3.0), stage, n, grain,
                    [&](std::size_t first, std::size_t last) {
                        std::uint32_t *at = &count[first / grain * digits];
                        for (std::size_t i = first; i < last; ++i)
                            other[at[digit(items[i])]++] = items[i];
                    });
        items.swap(other);
    }
}

/// 30-bit Morton code of a point of the frame: 10 bits an axis over [-0.5, 0.5].
inline std::uint32_t MortonCode(float x, float y, float z) {
    auto spread = [](float t) {
        std::uint32_t v = std::uint32_t(std::min(1023.f, std::max(0.f, (t + 0.5f) * 1024.f)));
        v = (v | v << 16) & 0x030000FF;
        v = (v | v << 8) & 0x0300F00F;
        v = (v | v << 4) & 0x030C30C3;
        v = (v | v << 2) & 0x09249249;
        return v;
    };
    return spread(x) << 2 | spread(y) << 1 | spread(z);
}

} // namespace vcg::fcd::detail

#endif
