// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NORMAL_EQUATIONS_H
#define VCG_FCD_NORMAL_EQUATIONS_H

#include <Eigen/Dense>

namespace vcg::fcd {

/// The sums of a least-squares problem in the coefficients C (3 x n) of x, y and z.
class NormalEquations {
  public:
    explicit NormalEquations(Eigen::Index n)
        : n(n), matrix(Eigen::MatrixXd::Zero(3 * n, 3 * n)), right(Eigen::VectorXd::Zero(3 * n)) {}

    /// Adds (C b - way)^T form (C b - way).
    void Add(const Eigen::Matrix3d &form, const Eigen::VectorXd &b, const Eigen::Vector3d &offset) {
        const Eigen::Vector3d pull = form * offset;
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k <= i; ++k)
                for (Eigen::Index c = 0; c < n; ++c)
                    matrix.col(k * n + c).segment(i * n, n) += (form(i, k) * b[c]) * b;
            right.segment(i * n, n) += pull[i] * b;
        }
    }
    void AddBending(double weight, const Eigen::MatrixXd &square) {
        for (int i = 0; i < 3; ++i)
            matrix.block(i * n, i * n, n, n) += weight * square;
    }
    void Add(double weight, const Eigen::MatrixXd &square) { matrix += weight * square; }
    /// Adds the square of form . (x, y, z).
    void AddSquare(double weight, const Eigen::VectorXd &form) { matrix += weight * form * form.transpose(); }
    double Largest() const { return matrix.diagonal().maxCoeff(); }
    /// The sum of the variances of x, y and z of C b, for each column of b, if the noise has the variance 1.
    Eigen::VectorXd Variances(const Eigen::MatrixXd &b) const {
        const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(Whole());
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(b.cols());
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::MatrixXd of = Eigen::MatrixXd::Zero(3 * n, b.cols());
            of.middleRows(axis * n, n) = b;
            factor.matrixL().solveInPlace(of);
            sum += of.colwise().squaredNorm().transpose();
        }
        return sum;
    }
    Eigen::Matrix3Xd Solution() const {
        const Eigen::VectorXd x = Whole().selfadjointView<Eigen::Lower>().ldlt().solve(right);
        return Eigen::Map<const Eigen::MatrixX3d>(x.data(), n, 3).transpose();
    }

  private:
    Eigen::MatrixXd Whole() const {
        Eigen::MatrixXd whole = matrix;
        whole.diagonal().array() += 1e-12 * matrix.trace() / double(3 * n); // coefficients without data stay 0
        return whole;
    }

    Eigen::Index n;
    Eigen::MatrixXd matrix; // its lower half
    Eigen::VectorXd right;
};

} // namespace vcg::fcd

#endif
