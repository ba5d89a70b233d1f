// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/morton.h>

#include <gtest/gtest.h>
#include <random>

using vcg::fcd::Progress;
using vcg::fcd::detail::MortonCode;
using vcg::fcd::detail::RadixSortUpper30;

static std::vector<std::uint64_t> RandomItems(std::size_t n, std::uint32_t codes) {
    std::mt19937 random(1);
    std::vector<std::uint64_t> items(n);
    for (std::uint64_t &item : items) {
        const std::uint64_t code = random() % codes;
        item = code << 32 | random();
    }
    return items;
}

TEST(RadixSortUpper30, IsStableSort) {
    for (std::size_t n : {0, 1, 2, 1000, 65536, 200001})
        for (std::uint32_t codes : {1u, 5u, 3000u, 1u << 30}) {
            std::vector<std::uint64_t> expected = RandomItems(n, codes);
            std::stable_sort(expected.begin(), expected.end(),
                             [](std::uint64_t a, std::uint64_t b) { return a >> 32 < b >> 32; });
            for (unsigned threads : {1u, 2u, 7u}) {
                const std::vector<std::uint64_t> unsorted = RandomItems(n, codes);
                std::unique_ptr<std::uint64_t[]> items(new std::uint64_t[n]);
                std::copy(unsorted.begin(), unsorted.end(), items.get());
                Progress progress;
                progress.threads = threads;
                RadixSortUpper30(items, n, progress);
                ASSERT_TRUE(std::equal(expected.begin(), expected.end(), items.get()))
                    << n << " items, " << codes << " codes";
            }
        }
}

TEST(MortonCode, OfTheCorners) {
    const std::uint32_t all = (1u << 30) - 1, z = 0x09249249, y = z << 1, x = z << 2;
    EXPECT_EQ(x | y | z, all);
    EXPECT_EQ(MortonCode(-0.5f, -0.5f, -0.5f), 0u);
    EXPECT_EQ(MortonCode(0.5f, -0.5f, -0.5f), x);
    EXPECT_EQ(MortonCode(-0.5f, 0.5f, -0.5f), y);
    EXPECT_EQ(MortonCode(-0.5f, -0.5f, 0.5f), z);
    EXPECT_EQ(MortonCode(0.5f, 0.5f, 0.5f), all);
}

TEST(MortonCode, OutsideTheFrameIsThatOfItsBorder) { EXPECT_EQ(MortonCode(-9, 7, 100), MortonCode(-0.5f, 0.5f, 0.5f)); }

TEST(MortonCode, InterleavesTheBits) {
    std::mt19937 random(1);
    for (int i = 0; i < 1000; ++i) {
        std::uint32_t cell[3], expected = 0;
        float p[3];
        for (int d = 0; d < 3; ++d) {
            cell[d] = random() % 1024;
            p[d] = (float(cell[d]) + 0.5f) / 1024 - 0.5f;
        }
        for (int bit = 9; bit >= 0; --bit)
            for (std::uint32_t c : cell)
                expected = expected << 1 | (c >> bit & 1);
        ASSERT_EQ(MortonCode(p[0], p[1], p[2]), expected);
    }
}
