// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include "test_support.h"

using vcg::fcd::Together;

TEST(Together, IsOneListAfterTheOtherAndFreesThem) {
    std::vector<std::vector<int>> lists{{3, 1}, {}, {2}, {}, {7, 7, 5}};
    EXPECT_EQ(Together(lists), (std::vector<int>{3, 1, 2, 7, 7, 5}));
    for (const std::vector<int> &list : lists)
        EXPECT_EQ(list.capacity(), 0u);
    std::vector<std::vector<int>> none;
    EXPECT_TRUE(Together(none).empty());
}

TEST(Together, TakesOneListOfEachPart) {
    struct Part {
        std::vector<int> one;
        std::vector<double> other;
    };
    std::vector<Part> parts{{{1, 2}, {0.5}}, {{}, {0.25, 4}}, {{3}, {}}};
    EXPECT_EQ(Together(parts, &Part::one), (std::vector<int>{1, 2, 3}));
    for (const Part &part : parts)
        EXPECT_EQ(part.one.capacity(), 0u);
    EXPECT_EQ(Together(parts, &Part::other), (std::vector<double>{0.5, 0.25, 4}));
}

/// As large as several pages of the memory, with the same items for any number of threads.
TEST(Together, IsWhatThreadsFoundInOrder) {
    const vcg::fcd::Index n = 300000;
    std::vector<vcg::fcd::Index> expected;
    for (vcg::fcd::Index i = 0; i < n; ++i)
        if (i % 3)
            expected.insert(expected.end(), {i, -i});
    for (unsigned threads : {1u, 2u, 7u})
        EXPECT_EQ(vcg::fcd::CollectInOrder(fcd_test::Threads(threads), "", n,
                                           [](vcg::fcd::Index i, std::vector<vcg::fcd::Index> &found) {
                                               if (i % 3)
                                                   found.insert(found.end(), {i, -i});
                                           }),
                  expected);
}

TEST(NumbersThat, AreAscendingForAnyNumberOfThreads) {
    const std::size_t n = 200000; // several ranges
    std::vector<vcg::fcd::Index> expected;
    for (std::size_t i = 0; i < n; i += 7)
        expected.push_back(vcg::fcd::Index(i));
    for (unsigned threads : {1u, 2u, 7u})
        EXPECT_EQ(vcg::fcd::NumbersThat(fcd_test::Threads(threads), "", n, [](std::size_t i) { return i % 7 == 0; }),
                  expected);
}

TEST(SortUnique, KeepsOneOfEqualItems) {
    std::vector<int> list{3, 1, 3, 2, 1};
    vcg::fcd::SortUnique(list);
    EXPECT_EQ(list, (std::vector<int>{1, 2, 3}));
}
