// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SPARSE_FACTOR_H
#define VCG_FCD_SPARSE_FACTOR_H

#include <vcg_ext/base/progress.h>

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// The arithmetic of a factorisation on the entries of its matrix: numbers or blocks.
template <class Entry>
struct EntryArithmetic;
template <>
struct EntryArithmetic<double> {
    static void Clear(double &y) { y = 0; }
    static void TakeProduct(double &y, double l, double yi) { y -= l * yi; } ///< for blocks yi l^T
    static double Over(double yi, double d) { return yi / d; }
    static bool Invert(double d) { return d != 0; } ///< prepares d for Over \return false: d is singular
};

/// L D L^T of a sparse symmetric matrix, of which only the lower triangle is read. The bits are those of Eigen's, but
/// it can be cancelled, and Analyse tells beforehand if it would take too long. A graph on a surface takes some 10^4
/// multiplications a row; a complete graph of n rows takes n^2 a row.
class SparseFactor : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
    using Base = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  public:
    using Matrix = Eigen::SparseMatrix<double>;

    /// The limit for a factorisation that one can do without: a second, and ten times what surfaces take.
    static double Worthwhile(Eigen::Index rows) { return 1e9 + 2e5 * double(rows); }
    /// The limit for any other: minutes.
    static constexpr double most = 1e11;

    /// \param limit multiplications \return whether no more are needed; if false, do not factorise
    bool Analyse(const Matrix &matrix, double limit) {
        Matrix permuted;
        const Matrix *ordered = nullptr;
        ordering(matrix, ordered, permuted);
        work = WorkFor(*ordered, limit);
        if (work > limit)
            return false;
        analyzePattern_preordered(*ordered, true);
        return true;
    }
    /// The number of multiplications that Analyse found, up to its limit.
    double Work() const { return work; }

    /// \pre Analyse of the same pattern returned true \return false: the matrix is singular \throw Cancelled
    bool Factorise(const Matrix &matrix, const Progress &progress, const char *stage) {
        Matrix a(matrix.rows(), matrix.cols());
        a.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
        m_diag.resize(a.rows());
        m_factorizationIsOk = true;
        const bool isRegular = FactoriseRows(
            m_matrix.valuePtr(), m_diag.data(),
            [&](StorageIndex k, const auto &add) {
                for (Matrix::InnerIterator it(a, k); it; ++it)
                    if (it.index() <= k)
                        add(it.index(), it.value());
            },
            progress, stage);
        m_info = isRegular ? Eigen::Success : Eigen::NumericalIssue;
        return isRegular;
    }

  protected:
    /// Factorises row by row. An entry is a number or a square block.
    /// \param value out: L below its unit diagonal, as many entries as the pattern has \param diagonal out: n, D
    /// \param row row(k, add) calls add(i, A_ki) for the entries of row k with i <= k
    template <class Entry, class Row>
    bool FactoriseRows(Entry *value, Entry *diagonal, const Row &row, const Progress &progress, const char *stage) {
        using Arithmetic = EntryArithmetic<Entry>;
        const auto n = StorageIndex(m_matrix.cols());
        const StorageIndex *begin = m_matrix.outerIndexPtr();
        StorageIndex *inner = m_matrix.innerIndexPtr();
        std::vector<Entry> y(static_cast<std::size_t>(n)); // the row that is computed
        for (Entry &each : y)
            Arithmetic::Clear(each);
        std::vector<StorageIndex> pattern(std::size_t(n), 0), tag(std::size_t(n), -1);
        const std::size_t often = 1 << 27; // bytes of L between reports: about 20 ms
        std::size_t done = 0;
        for (StorageIndex k = 0; k < n; ++k) {
            // The pattern of row k: all that its entries reach in the elimination tree, in the order of elimination.
            StorageIndex top = n;
            tag[k] = k;
            m_nonZerosPerCol[k] = 0;
            row(k, [&](StorageIndex i, const Entry &a) {
                y[i] += a;
                StorageIndex length = 0;
                for (; tag[i] != k; i = m_parent[i]) {
                    pattern[length++] = i;
                    tag[i] = k;
                }
                while (length > 0)
                    pattern[--top] = pattern[--length];
            });
            diagonal[k] = y[k];
            Arithmetic::Clear(y[k]);
            for (; top < n; ++top) {
                const StorageIndex i = pattern[top], end = begin[i] + m_nonZerosPerCol[i];
                const Entry yi = y[i], l = Arithmetic::Over(yi, diagonal[i]);
                Arithmetic::Clear(y[i]);
                for (StorageIndex p = begin[i]; p < end; ++p)
                    Arithmetic::TakeProduct(y[inner[p]], value[p], yi);
                Arithmetic::TakeProduct(diagonal[k], l, yi);
                inner[end] = k;
                value[end] = l;
                ++m_nonZerosPerCol[i];
                done += std::size_t(end - begin[i]) * sizeof(Entry);
                if (done > often) {
                    done = 0;
                    progress(double(k) / double(n), stage);
                }
            }
            if (!Arithmetic::Invert(diagonal[k]))
                return false;
        }
        return true;
    }

  private:
    /// The number of multiplications, counted as Eigen finds the pattern of L, but without storing it.
    static double WorkFor(const Matrix &a, double limit) {
        const auto n = StorageIndex(a.rows());
        std::vector<StorageIndex> parent(std::size_t(n), -1), tag(std::size_t(n), -1), count(std::size_t(n), 0);
        double work = 0;
        for (StorageIndex k = 0; k < n && work <= limit; ++k) {
            tag[k] = k;
            for (Matrix::InnerIterator it(a, k); it; ++it)
                for (StorageIndex i = it.index(); i < k && tag[i] != k; i = parent[i]) {
                    if (parent[i] < 0)
                        parent[i] = k;
                    work += count[i]++;
                    tag[i] = k;
                }
        }
        return work;
    }

    double work = 0;
};

} // namespace vcg::fcd::detail

#endif
