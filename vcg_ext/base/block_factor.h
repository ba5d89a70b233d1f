// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BLOCK_FACTOR_H
#define VCG_FCD_BLOCK_FACTOR_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/sparse_factor.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// A sparse symmetric matrix of n x n blocks, each \p width x \p width.
template <int width>
struct BlockMatrix {
    using Block = Eigen::Matrix<double, width, width>;

    /// Block row \p b of a vector, or of several side by side.
    template <class Vector>
    static auto RowOf(Vector &x, Index b) {
        return x.template middleRows<width>(width * b);
    }

    std::vector<Block> diagonal;                ///< n, symmetric
    std::vector<std::pair<Index, Index>> where; ///< row and column of each other block, once, without its transpose
    std::vector<Block> beside;                  ///< these blocks

    Eigen::VectorXd operator*(const Eigen::VectorXd &x) const {
        Eigen::VectorXd y(x.size());
        for (std::size_t b = 0; b < diagonal.size(); ++b)
            RowOf(y, Index(b)) = diagonal[b] * RowOf(x, Index(b));
        for (std::size_t p = 0; p < beside.size(); ++p) {
            RowOf(y, where[p].first) += beside[p] * RowOf(x, where[p].second);
            RowOf(y, where[p].second) += beside[p].transpose() * RowOf(x, where[p].first);
        }
        return y;
    }
};

template <int width>
struct EntryArithmetic<Eigen::Matrix<double, width, width>> {
    using Block = Eigen::Matrix<double, width, width>;
    static void Clear(Block &y) { y.setZero(); }
    static void TakeProduct(Block &y, const Block &l, const Block &yi) { y.noalias() -= yi * l.transpose(); }
    static Block Over(const Block &yi, const Block &inverse) { return yi * inverse; }
    static bool Invert(Block &d) {
        d = Eigen::LDLT<Block>(d).solve(Block::Identity()).eval();
        return d.allFinite();
    }
};

/// L D L^T of a BlockMatrix, by blocks: several times as fast as by numbers if most entries of a block are not 0.
template <int width>
class BlockFactor : private SparseFactor {
  public:
    using BlockMatrix = detail::BlockMatrix<width>;
    using Block = typename BlockMatrix::Block;

    /// \param limit multiplications \return whether no more are needed; if false, do not factorise
    bool Analyse(const BlockMatrix &matrix, double limit) {
        const auto n = Index(matrix.diagonal.size());
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(matrix.diagonal.size() + matrix.where.size());
        for (Index b = 0; b < n; ++b)
            entries.emplace_back(b, b, 1);
        for (const auto &[row, column] : matrix.where)
            entries.emplace_back(std::max(row, column), std::min(row, column), 1);
        Matrix pattern(n, n);
        pattern.setFromTriplets(entries.begin(), entries.end());
        if (!SparseFactor::Analyse(pattern, limit / (width * width * width)))
            return false;
        rows.assign(std::size_t(n), {});
        for (std::size_t p = 0; p < matrix.where.size(); ++p) {
            const Index row = Place(matrix.where[p].first), column = Place(matrix.where[p].second);
            rows[std::size_t(std::max(row, column))].push_back({std::min(row, column), p, row < column});
        }
        value.resize(std::size_t(m_matrix.nonZeros()));
        return true;
    }

    /// \pre Analyse of a matrix with the same blocks returned true \return false: the matrix is singular
    /// \throw Cancelled
    bool Factorise(const BlockMatrix &matrix, const Progress &progress, const char *stage) {
        inverse.resize(matrix.diagonal.size());
        return FactoriseRows(
            value.data(), inverse.data(),
            [&](Index k, const auto &add) {
                for (const Item &item : rows[std::size_t(k)])
                    add(item.column,
                        item.isTransposed ? Block(matrix.beside[item.p].transpose()) : matrix.beside[item.p]);
                add(k, matrix.diagonal[std::size_t(m_Pinv.indices()[k])]);
            },
            progress, stage);
    }

    /// The number of negative eigenvalues.
    Index Negative() const {
        Eigen::Index count = 0;
        for (const Block &each : inverse)
            count += (Eigen::LDLT<Block>(each).vectorD().array() < 0).count();
        return Index(count);
    }

    /// \param right a vector, or several side by side
    template <class Vector>
    Vector Solve(const Vector &right) const {
        const auto n = Index(inverse.size());
        Vector x(right.rows(), right.cols());
        for (Index b = 0; b < n; ++b)
            BlockMatrix::RowOf(x, Place(b)) = BlockMatrix::RowOf(right, b);
        for (Index c = 0; c < n; ++c)
            ForEachBelow(
                c, [&](Index row, const Block &l) { BlockMatrix::RowOf(x, row) -= l * BlockMatrix::RowOf(x, c); });
        for (Index c = n; c-- > 0;) {
            BlockMatrix::RowOf(x, c) = (inverse[std::size_t(c)] * BlockMatrix::RowOf(x, c)).eval();
            ForEachBelow(c, [&](Index row, const Block &l) {
                BlockMatrix::RowOf(x, c) -= l.transpose() * BlockMatrix::RowOf(x, row);
            });
        }
        Vector result(right.rows(), right.cols());
        for (Index b = 0; b < n; ++b)
            BlockMatrix::RowOf(result, b) = BlockMatrix::RowOf(x, Place(b));
        return result;
    }

  private:
    /// A block of a row, left of the diagonal.
    struct Item {
        Index column;
        std::size_t p;     // index in BlockMatrix::beside
        bool isTransposed; // of the block there
    };

    Index Place(Index block) const { return m_P.indices()[block]; }
    template <class Body>
    void ForEachBelow(Index column, const Body &body) const {
        const StorageIndex begin = m_matrix.outerIndexPtr()[column];
        for (StorageIndex p = begin; p < begin + m_nonZerosPerCol[column]; ++p)
            body(m_matrix.innerIndexPtr()[p], value[std::size_t(p)]);
    }

    std::vector<std::vector<Item>> rows; // n, in the order of elimination
    std::vector<Block> value;            // of L
    std::vector<Block> inverse;          // n, of D
};

} // namespace vcg::fcd::detail

#endif
