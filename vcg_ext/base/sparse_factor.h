// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SPARSE_FACTOR_H
#define VCG_FCD_SPARSE_FACTOR_H

#include <vcg_ext/base/progress.h>

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// L D L^T of a sparse symmetric matrix; only the lower triangle is read. It has the bits of Eigen's, can be cancelled
/// between rows, and is not begun where it would take too long. A graph on a surface takes some 10^4 steps a row; a
/// complete graph takes as many as the square of the number of rows.
class SparseFactor : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
    using Base = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  public:
    using Matrix = Eigen::SparseMatrix<double>;

    /// Multiplications that are worth it where one could do without: a second, and ten times what surfaces take.
    static double Worthwhile(Eigen::Index rows) { return 1e9 + 2e5 * double(rows); }
    /// Those beyond which none is begun: minutes.
    static constexpr double most = 1e11;

    /// \param limit multiplications \return whether no more are needed; only then it may be factorised
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
    /// Multiplications that Analyse found, up to its limit.
    double Work() const { return work; }

    /// \pre Analyse of the same pattern \return whether it could be factorised \throw Cancelled
    bool Factorise(const Matrix &matrix, const Progress &progress, const char *stage) {
        Matrix a(matrix.rows(), matrix.cols());
        a.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
        const auto n = StorageIndex(a.rows());
        const StorageIndex *begin = m_matrix.outerIndexPtr();
        StorageIndex *row = m_matrix.innerIndexPtr();
        double *value = m_matrix.valuePtr();
        std::vector<double> y(std::size_t(n), 0); // the row that is computed
        std::vector<StorageIndex> pattern(std::size_t(n), 0), tag(std::size_t(n), -1);
        m_diag.resize(n);
        m_factorizationIsOk = true;
        m_info = Eigen::Success;
        std::size_t done = 0;
        for (StorageIndex k = 0; k < n; ++k) {
            // Where the row is not 0: what its entries lead to in the elimination tree, in an order for computing.
            StorageIndex top = n;
            tag[k] = k;
            m_nonZerosPerCol[k] = 0;
            for (Matrix::InnerIterator it(a, k); it; ++it) {
                StorageIndex i = it.index();
                if (i > k)
                    continue;
                y[i] += it.value();
                StorageIndex length = 0;
                for (; tag[i] != k; i = m_parent[i]) {
                    pattern[length++] = i;
                    tag[i] = k;
                }
                while (length > 0)
                    pattern[--top] = pattern[--length];
            }
            double d = y[k];
            y[k] = 0;
            for (; top < n; ++top) {
                const StorageIndex i = pattern[top], end = begin[i] + m_nonZerosPerCol[i];
                const double yi = y[i], l = yi / m_diag[i];
                y[i] = 0;
                for (StorageIndex p = begin[i]; p < end; ++p)
                    y[row[p]] -= value[p] * yi;
                d -= l * yi;
                row[end] = k;
                value[end] = l;
                ++m_nonZerosPerCol[i];
                done += std::size_t(end - begin[i]);
                if (done > often) {
                    done = 0;
                    progress(double(k) / double(n), stage);
                }
            }
            m_diag[k] = d;
            if (d == 0) {
                m_info = Eigen::NumericalIssue;
                return false;
            }
        }
        return true;
    }

  private:
    static constexpr std::size_t often = 1 << 24; // steps, about 20 ms

    /// As Eigen finds the pattern of L, without room for it.
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
