// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_LAPLACIAN_H
#define VCG_FCD_GRAPH_LAPLACIAN_H

#include <vcg_ext/base/sparse_factor.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd::detail {

/// The Laplacian and the bi-Laplacian of a deformation graph of k nodes, n of them with unknown positions. Both are
/// factorised once, at construction; the rows and columns of constrained nodes are eliminated.
class GraphLaplacian {
  public:
    /// \throw Unsolvable if the system cannot be factorised, or takes too long \throw Cancelled
    GraphLaplacian(const DeformationGraph &graph, const GraphUnknowns &unknown, const Progress &progress = {}) {
        const Index k = graph.Size(), n = Index(unknown.position.size());
        if (n == 0)
            return;
        const Csr &adjacency = graph.graph.adjacency;
        std::vector<Eigen::Triplet<double>> free, known;
        for (Index i = 0; i < k; ++i) {
            if (!unknown.HasConstraint(i))
                continue;
            double sum = 0;
            for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
                sum += graph.weight[e];
                const Index j = adjacency.item[e];
                if (unknown.numberOf[j] >= 0)
                    free.emplace_back(i, unknown.numberOf[j], -graph.weight[e]);
                else
                    known.emplace_back(i, j, -graph.weight[e]);
            }
            if (unknown.numberOf[i] >= 0)
                free.emplace_back(i, unknown.numberOf[i], sum);
            else
                known.emplace_back(i, i, sum);
        }
        // Columns of the Laplacian: those of the unknown nodes, and those of the constrained ones.
        Eigen::SparseMatrix<double> columns(k, n);
        columns.setFromTriplets(free.begin(), free.end());
        constrainedColumns.resize(k, k);
        constrainedColumns.setFromTriplets(known.begin(), known.end());
        std::vector<Eigen::Triplet<double>> square;
        for (const Eigen::Triplet<double> &t : free)
            if (unknown.numberOf[t.row()] >= 0)
                square.emplace_back(unknown.numberOf[t.row()], t.col(), t.value());
        Eigen::SparseMatrix<double> laplacian(n, n);
        laplacian.setFromTriplets(square.begin(), square.end());
        SparseFactor harmonic;
        if (!harmonic.Analyse(laplacian, SparseFactor::most))
            throw Unsolvable(
                "The deformation graph of " + std::to_string(k) +
                " nodes takes minutes to solve: its faces join far places of the surface, as random faces do. "
                "Leave such faces out, or take fewer patches.");
        // The bi-Laplacian joins all neighbours of a node with each other. If a node has thousands of them, or edges
        // are random, the Laplacian takes its place.
        double joined = 0;
        for (Index i = 0; i < k; ++i)
            joined += double(adjacency[i].size()) * double(adjacency[i].size());
        SparseFactor::Matrix both;
        bool joins = joined < 4e6 + 400.0 * k;
        if (joins) {
            biharmonicRows = columns.transpose();
            both = biharmonicRows * columns;
            joins = biharmonic.Analyse(both, SparseFactor::Worthwhile(n));
        }
        if (!joins) {
            biharmonicRows.resize(n, k);
            for (Index u = 0; u < n; ++u)
                biharmonicRows.insert(u, unknown.position[u]) = 1;
            both = biharmonicRows * columns;
            biharmonic.Analyse(both, SparseFactor::most);
        }
        if (!harmonic.Factorise(laplacian, progress.Slice(0, 0.5), stage) ||
            !biharmonic.Factorise(both, progress.Slice(0.5, 1), stage))
            throw Unsolvable("The deformation graph's system cannot be factorised.");
        factor = harmonic.matrixL().nestedExpression();
        inverseDiagonal = harmonic.vectorD().cwiseInverse();
        order.assign(harmonic.permutationP().indices().data(), harmonic.permutationP().indices().data() + n);
    }

    /// The column of unknown position number \p u in the argument of Solve.
    Index ColumnOf(std::size_t u) const { return order[u]; }

    /// Solves the Laplacian system in place: \p x (3 x n) is its right side, then the solution. As the factorisation's
    /// solve(), but for all three coordinates at once and without an allocation.
    void Solve(Eigen::Matrix3Xd &x) const {
        for (Eigen::Index c = 0; c < x.cols(); ++c) {
            const Eigen::Vector3d xc = x.col(c);
            for (Eigen::SparseMatrix<double>::InnerIterator l(factor, c); l; ++l)
                x.col(l.row()) -= l.value() * xc;
        }
        for (Eigen::Index c = x.cols(); c-- > 0;) {
            Eigen::Vector3d xc = x.col(c) * inverseDiagonal[c];
            for (Eigen::SparseMatrix<double>::InnerIterator l(factor, c); l; ++l)
                xc -= l.value() * x.col(l.row());
            x.col(c) = xc;
        }
    }

    /// The least eigenvalue of the Laplacian over \p mass (n values, > 0), about: from above, within some percent. 0
    /// where there is nothing unknown.
    double LeastEigenvalue(const Eigen::VectorXd &mass) const {
        if (order.empty())
            return 0;
        const auto n = Eigen::Index(order.size());
        Eigen::RowVectorXd ordered(n);
        for (Eigen::Index u = 0; u < n; ++u)
            ordered[ColumnOf(std::size_t(u))] = mass[u];
        Eigen::Matrix3Xd x = Eigen::Matrix3Xd::Ones(3, n), y;
        double least = 0;
        for (int i = 0; i < 5; ++i) { // inverse iteration; all values are of one sign, as those of the vector are
            y = x.array().rowwise() * ordered.array();
            const double before = x.row(0).dot(y.row(0));
            x = y;
            Solve(x);
            least = before / x.row(0).dot(y.row(0));
            x /= x.norm();
        }
        return least;
    }

    /// Interpolates values of the constrained nodes by the bi-Laplacian. \param values k rows, those of others 0
    /// \return n rows
    Eigen::MatrixXd Interpolate(const Eigen::MatrixXd &values) const {
        if (order.empty())
            return Eigen::MatrixXd(0, values.cols());
        return biharmonic.solve(-(biharmonicRows * (constrainedColumns * values)));
    }

    /// How far \p pressure (n values) moves a surface with the bi-Laplacian as its stiffness: smoothly, from 0 at what
    /// is held. \return n values
    Eigen::VectorXd Spread(const Eigen::VectorXd &pressure) const { return biharmonic.solve(pressure); }

  private:
    static constexpr const char *stage = "Deforming the graph";

    Eigen::SparseMatrix<double> factor; // L of the Laplacian below its unit diagonal
    Eigen::VectorXd inverseDiagonal;    // 1 / D of it
    std::vector<Index> order;           // n, row of each unknown position in the factor
    Eigen::SparseMatrix<double> constrainedColumns, biharmonicRows;
    SparseFactor biharmonic;
};

} // namespace vcg::fcd::detail

#endif
