// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ANDERSON_H
#define VCG_FCD_ANDERSON_H

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>

namespace vcg::fcd::detail {

/// Anderson acceleration of a fixed-point iteration (Anderson 1965; for local-global solvers Peng et al. 2018).
class Anderson {
  public:
    explicit Anderson(std::size_t size) : differenceF(size, depth), differenceG(size, depth), f(size), g(size) {}

    /// \param x the iterate \param gx in: the result of its step; out: the next iterate
    void Mix(const Eigen::VectorXd &x, Eigen::VectorXd &gx) {
        if (steps > 0) {
            const int column = (steps - 1) % depth;
            differenceF.col(column) = gx - x - f;
            differenceG.col(column) = gx - g;
            const double before = (differenceG.col(column) - differenceF.col(column)).norm();
            contraction[column] = before > 0 ? differenceG.col(column).norm() / before : 0;
        }
        f = gx - x;
        g = gx;
        const int used = std::min(steps, depth);
        ++steps;
        if (used == 0)
            return;
        const int last = (steps - 2) % depth;
        Small right(used);
        for (int c = 0; c < used; ++c) {
            gram(c, last) = gram(last, c) = differenceF.col(c).dot(differenceF.col(last));
            right[c] = differenceF.col(c).dot(f);
        }
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, depth, depth> system = gram.topLeftCorner(used, used);
        system.diagonal().array() += 1e-12 * system.diagonal().maxCoeff() + 1e-300;
        const Small theta = system.ldlt().solve(right);
        if (theta.allFinite())
            for (int c = 0; c < used; ++c)
                gx -= theta[c] * differenceG.col(c);
    }

    /// The largest ratio of the lengths of two successive steps among the last \p depth ones. It is 1 before there are
    /// that many, since first steps only show errors that vanish fast.
    double Contraction() const {
        const int used = std::min(steps - 1, depth);
        return used < depth ? 1 : std::min(1.0, *std::max_element(contraction, contraction + depth));
    }

  private:
    static constexpr int depth = 6;
    using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, depth, 1>;
    Eigen::MatrixXd differenceF, differenceG;
    Eigen::Matrix<double, depth, depth> gram = Eigen::Matrix<double, depth, depth>::Zero();
    Eigen::VectorXd f, g;
    double contraction[depth] = {};
    int steps = 0;
};

} // namespace vcg::fcd::detail

#endif
