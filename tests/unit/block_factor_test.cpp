// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/block_factor.h>
#include "test_support.h"

#include <Eigen/Eigenvalues>

using namespace vcg::fcd;
using namespace fcd_test;
using BlockFactor = vcg::fcd::detail::BlockFactor<6>;
using BlockMatrix = vcg::fcd::detail::BlockMatrix<6>;
using vcg::fcd::detail::SparseFactor;

/// \param shift of the diagonal: 20 makes it positive definite, 0 does not
static BlockMatrix RandomBlocks(Index n, int beside, double shift) {
    std::mt19937 random(1);
    const auto number = [&] { return double(random() % 1000) / 1000 - 0.5; };
    BlockMatrix matrix;
    for (Index b = 0; b < n; ++b) {
        const BlockMatrix::Block each = BlockMatrix::Block::NullaryExpr(number);
        matrix.diagonal.push_back(each + each.transpose() + shift * BlockMatrix::Block::Identity());
    }
    for (int p = 0; p < beside; ++p) {
        const Index row = Index(random() % unsigned(n)), column = Index(random() % unsigned(n));
        if (row == column)
            continue;
        matrix.where.emplace_back(row, column); // repeated entries are summed
        matrix.beside.push_back(BlockMatrix::Block::NullaryExpr(number));
    }
    return matrix;
}

static Eigen::MatrixXd Dense(const BlockMatrix &matrix) {
    const auto size = Eigen::Index(6 * matrix.diagonal.size());
    Eigen::MatrixXd dense(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
        dense.col(i) = matrix * Eigen::VectorXd(Eigen::VectorXd::Unit(size, i));
    return dense;
}

TEST(BlockFactor, SolvesAndTellsHowManyDirectionsFall) {
    for (const auto &[n, beside] : {std::pair<Index, int>(1, 0), {15, 20}, {15, 200}})
        for (const double shift : {40.0, 0.0}) {
            const BlockMatrix matrix = RandomBlocks(n, beside, shift);
            const Eigen::MatrixXd dense = Dense(matrix);
            ASSERT_TRUE(dense.isApprox(dense.transpose()));
            BlockFactor factor;
            ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
            for (int again = 0; again < 2; ++again) {
                ASSERT_TRUE(factor.Factorise(matrix, {}, "stage"));
                const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(dense.cols(), -1, 2);
                EXPECT_LE((matrix * factor.Solve(right) - right).norm(), 1e-9 * right.norm());
                Eigen::MatrixX2d both(right.size(), 2);
                both << right, right.cwiseAbs();
                EXPECT_TRUE(factor.Solve(both).col(0).isApprox(factor.Solve(right), 1e-12));
            }
            const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
            EXPECT_EQ(factor.Negative(), Index((values.array() < 0).count()));
            EXPECT_EQ(factor.Negative() > 0, shift == 0);
        }
}

TEST(BlockFactor, TellsWhatCannotBeFactorised) {
    BlockMatrix matrix = RandomBlocks(2, 0, 20);
    matrix.diagonal[1].setConstant(std::numeric_limits<double>::quiet_NaN());
    BlockFactor factor;
    ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
    EXPECT_FALSE(factor.Factorise(matrix, {}, "stage"));
}

TEST(BlockFactor, IsNotBegunWhereEverythingIsJoinedAndCanBeCancelled) {
    const Index n = 400;
    const BlockMatrix matrix = RandomBlocks(n, 5 * n, 40);
    BlockFactor factor;
    EXPECT_FALSE(factor.Analyse(matrix, 1e7));
    ASSERT_TRUE(factor.Analyse(matrix, SparseFactor::most));
    CallbackLog log(1);
    EXPECT_THROW(factor.Factorise(matrix, log.Progress(), "stage"), Cancelled);
}
