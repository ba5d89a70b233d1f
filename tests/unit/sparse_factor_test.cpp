// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/sparse_factor.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using vcg::fcd::detail::SparseFactor;

/// A matrix with a diagonal, dominant or not, and random entries beside it.
static SparseFactor::Matrix RandomMatrix(Index n, int entries, double diagonal) {
    std::mt19937 random(1);
    std::vector<Eigen::Triplet<double>> all;
    for (int e = 0; e < entries; ++e) {
        const Index i = Index(random() % unsigned(n)), j = Index(random() % unsigned(n));
        const double value = double(random() % 1000) / 1000 - 0.5;
        all.emplace_back(i, j, value);
        all.emplace_back(j, i, value);
    }
    for (Index i = 0; i < n; ++i)
        all.emplace_back(i, i, diagonal + double(random() % 1000) / 1000);
    SparseFactor::Matrix matrix(n, n);
    matrix.setFromTriplets(all.begin(), all.end());
    return matrix;
}

static SparseFactor::Matrix Lower(const SparseFactor::Matrix &matrix) { return matrix.triangularView<Eigen::Lower>(); }

TEST(SparseFactor, HasTheBitsOfEigens) {
    for (const auto &[n, entries] : {std::pair<Index, int>(1, 0), {300, 900}, {300, 20000}, {2000, 3000}})
        for (const double diagonal : {20.0, 0.1}) { // the second one has negative values, too
            const SparseFactor::Matrix matrix = Lower(RandomMatrix(n, entries, diagonal));
            const Eigen::SimplicialLDLT<SparseFactor::Matrix> expected(matrix);
            SparseFactor factor;
            ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
            for (int again = 0; again < 2; ++again) {
                ASSERT_TRUE(factor.Factorise(matrix, {}, "stage"));
                EXPECT_EQ(factor.info(), Eigen::Success);
                const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n, -1, 2);
                EXPECT_TRUE(SameBits(Eigen::VectorXd(factor.solve(right)), Eigen::VectorXd(expected.solve(right))));
                EXPECT_TRUE(SameBits(Eigen::VectorXd(factor.vectorD()), Eigen::VectorXd(expected.vectorD())));
                double work = 0;
                const SparseFactor::Matrix &l = expected.matrixL().nestedExpression();
                for (Index c = 0; c < n; ++c) {
                    const double below = double(l.outerIndexPtr()[c + 1] - l.outerIndexPtr()[c]);
                    work += below * (below - 1) / 2;
                }
                EXPECT_EQ(factor.Work(), work);
            }
        }
}

TEST(SparseFactor, TellsWhatCannotBeFactorised) {
    SparseFactor::Matrix matrix(2, 2);
    matrix.insert(0, 0) = 1;
    matrix.insert(1, 0) = 1;
    matrix.insert(1, 1) = 1;
    SparseFactor factor;
    ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
    EXPECT_FALSE(factor.Factorise(matrix, {}, "stage"));
    EXPECT_EQ(factor.info(), Eigen::NumericalIssue);
}

TEST(SparseFactor, IsNotBegunWhereEverythingIsJoinedAndCanBeCancelled) {
    const Index n = sanitized ? 3000 : 6000;
    const SparseFactor::Matrix matrix = Lower(RandomMatrix(n, 5 * n, 20));
    SparseFactor factor;
    const Stopwatch watch;
    EXPECT_FALSE(factor.Analyse(matrix, SparseFactor::Worthwhile(n) / (sanitized ? 10 : 1)));
    EXPECT_LT(watch.Seconds(), sanitized ? 60 : 5);
    ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
    CallbackLog log(3);
    EXPECT_THROW(factor.Factorise(matrix, log.Progress(), "stage"), Cancelled);
}
