// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/line/line_jitter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace vcg::fcd {

namespace {

/// A smoothing spline: the curve g with the least sum |p_i - g(t_i)|^2 + alpha int |g''|^2.
class SmoothingSpline {
  public:
    /// \param places t, n >= 3, ascending
    SmoothingSpline(std::vector<double> places, const Eigen::Matrix3Xd &points)
        : t(std::move(places)), given(points), bend(points.cols() - 2, 3) {
        for (Eigen::Index i = 0; i + 2 < given.cols(); ++i) { // second differences
            const double before = Gap(i), after = Gap(i + 1);
            bend.row(i) = ((given.col(i + 2) - given.col(i + 1)) / after - (given.col(i + 1) - given.col(i)) / before)
                              .transpose();
        }
    }

    /// \return the score of generalised cross-validation, an estimate of the mean square distance of each point from
    /// the spline of all others
    double Solve(double alpha) {
        const Eigen::Index m = bend.rows();
        // The diagonals of B = R + alpha Q^T Q, its factors L D L^T, then the bands of its inverse (M. Hutchinson, F.
        // de Hoog, Smoothing noisy data with spline functions, 1985).
        Eigen::ArrayXd square(m), square1(m), square2(m), d(m), l1(m), l2(m);
        for (Eigen::Index i = 0; i < m; ++i) {
            square[i] = At(i, 0) * At(i, 0) + At(i, 1) * At(i, 1) + At(i, 2) * At(i, 2);
            square1[i] = i + 1 < m ? At(i, 1) * At(i + 1, 0) + At(i, 2) * At(i + 1, 1) : 0;
            square2[i] = i + 2 < m ? At(i, 2) * At(i + 2, 0) : 0;
        }
        for (Eigen::Index i = 0; i < m; ++i) {
            double own = (Gap(i) + Gap(i + 1)) / 3 + alpha * square[i];
            double next = i + 1 < m ? Gap(i + 1) / 6 + alpha * square1[i] : 0;
            if (i > 0) {
                own -= l1[i - 1] * l1[i - 1] * d[i - 1];
                next -= l1[i - 1] * l2[i - 1] * d[i - 1];
            }
            if (i > 1)
                own -= l2[i - 2] * l2[i - 2] * d[i - 2];
            d[i] = own;
            l1[i] = next / own;
            l2[i] = alpha * square2[i] / own;
        }
        Eigen::MatrixX3d gamma = bend;
        for (Eigen::Index i = 0; i < m; ++i) {
            if (i > 0)
                gamma.row(i) -= l1[i - 1] * gamma.row(i - 1);
            if (i > 1)
                gamma.row(i) -= l2[i - 2] * gamma.row(i - 2);
        }
        freedom = 0;
        Eigen::Array3d own = Eigen::Array3d::Zero(), next = own;
        // The inverse: own[0], own[1] on the diagonal at i + 1 and i + 2, next[0] at (i + 1, i + 2)
        for (Eigen::Index i = m; i-- > 0;) {
            gamma.row(i) /= d[i];
            if (i + 1 < m)
                gamma.row(i) -= l1[i] * gamma.row(i + 1);
            if (i + 2 < m)
                gamma.row(i) -= l2[i] * gamma.row(i + 2);
            const double one = -l1[i] * own[0] - l2[i] * next[0], two = -l1[i] * next[0] - l2[i] * own[1],
                         here = 1 / d[i] - l1[i] * one - l2[i] * two;
            freedom += alpha * (square[i] * here + 2 * square1[i] * one + 2 * square2[i] * two);
            own[1] = own[0];
            own[0] = here;
            next[0] = one;
        }
        off.setZero(3, given.cols());
        for (Eigen::Index i = 0; i < m; ++i)
            for (int k = 0; k < 3; ++k)
                off.col(i + k) += alpha * At(i, k) * gamma.row(i).transpose();
        double squares = 0;
        for (Eigen::Index i = 0; i < given.cols(); ++i)
            squares += off.col(i).squaredNorm();
        // A degree of freedom counts 1.4 times. Otherwise, jitter is now and then taken for bends (Y. Kim, C. Gu,
        // Smoothing spline Gaussian regression, 2004).
        const double n = double(given.cols()), left = n - 1.4 * (n - freedom);
        return left > 0 ? n * squares / (left * left) : std::numeric_limits<double>::infinity();
    }

    Eigen::Matrix3Xd off; ///< points minus spline
    double freedom = 0;   ///< degrees of freedom of the residuals: the trace of I - A

  private:
    double Gap(Eigen::Index i) const { return t[std::size_t(i) + 1] - t[std::size_t(i)]; }
    /// The coefficient of point i + k in the second difference at point i + 1.
    double At(Eigen::Index i, int k) const {
        return k == 0 ? 1 / Gap(i) : k == 2 ? 1 / Gap(i + 1) : -1 / Gap(i) - 1 / Gap(i + 1);
    }

    const std::vector<double> t;
    const Eigen::Matrix3Xd &given;
    Eigen::MatrixX3d bend;
};

std::vector<double> LengthsAlong(const Eigen::Matrix3Xd &points) {
    std::vector<double> along(1, 0);
    for (Eigen::Index i = 1; i < points.cols(); ++i)
        along.push_back(along.back() + (points.col(i) - points.col(i - 1)).norm());
    return along;
}

/// The jitter of points across a smooth line, rms in one direction. Each point is predicted by the cubic through the
/// two before and the two after it. Errors of successive points have the same sign where the line bends, and opposite
/// signs where points jitter. So their products measure jitter, and a positive sum counts as none.
double JitterOf(const std::vector<double> &along, const Eigen::Matrix3Xd &points) {
    double sum = 0, expected = 0;
    std::array<double, 5> before{};
    Eigen::Vector3d offBefore = Eigen::Vector3d::Zero();
    for (std::size_t i = 2; i + 2 < along.size(); ++i) {
        std::array<double, 5> share{};
        Eigen::Vector3d off = points.col(Eigen::Index(i));
        for (std::size_t k = 0; k < 5; ++k) {
            share[k] = 1;
            for (std::size_t j = 0; j < 5 && k != 2; ++j)
                if (j != k && j != 2)
                    share[k] *= (along[i] - along[i - 2 + j]) / (along[i - 2 + k] - along[i - 2 + j]);
            if (k != 2) {
                off -= share[k] * points.col(Eigen::Index(i - 2 + k));
                share[k] = -share[k];
            }
        }
        if (i > 2) {
            sum += off.dot(offBefore);
            for (std::size_t k = 0; k < 4; ++k)
                expected += share[k] * before[k + 1];
        }
        before = share;
        offBefore = off;
    }
    return std::sqrt(std::max(0.0, sum / (2 * expected)));
}

} // namespace

SteadyPoints WithoutJitter(const Eigen::Matrix3Xd &points, double thickness) {
    constexpr Eigen::Index fewest = 8; // fewer points hardly tell jitter from bends
    SteadyPoints steady{points, 0};
    if (points.cols() < fewest)
        return steady;
    // Jitter makes the line longer. Without it, arc lengths are more exact: hence several rounds.
    for (int round = 0; round < 3; ++round) {
        const std::vector<double> along = LengthsAlong(steady.point);
        const double gap = along.back() / double(points.cols() - 1);
        for (std::size_t i = 1; i < along.size(); ++i)
            if (!(along[i] > along[i - 1]))
                return steady;
        // Second differences of jitter have 1 + 4 + 1 times its variance.
        if (const double jitter = JitterOf(along, points);
            round == 0 && !(std::sqrt(6.0) * jitter / (gap * gap) * thickness > 0.01))
            return steady;
        // A wave of length w is kept to 1 / (1 + (2 pi s / w)^4). The least s just involves a point's neighbours. The
        // most halves waves of 19 times the thickness.
        const double least = 0.3 * gap, most = 3 * thickness, step = 1.15;
        if (most < gap) // so few points are all meant
            return steady;
        SmoothingSpline spline(along, points);
        const auto alpha = [&](double s) { return s * s * s * s / gap; };
        double best = std::numeric_limits<double>::infinity(), chosen = least;
        double s = least;
        while (s <= most) {
            if (const double score = spline.Solve(alpha(s)); score < best) {
                best = score;
                chosen = s;
            }
            s *= step;
        }
        spline.Solve(alpha(chosen));
        // The residuals, smoothed alike, give bends back what the spline took from them.
        SmoothingSpline again(along, spline.off);
        again.Solve(alpha(chosen));
        steady.point = points - again.off;
        double squares = 0; // of the residuals across the line
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const Eigen::Vector3d direction = (steady.point.col(std::min(i + 1, points.cols() - 1)) -
                                               steady.point.col(std::max<Eigen::Index>(i - 1, 0)))
                                                  .normalized(),
                                  off = spline.off.col(i);
            squares += (off - off.dot(direction) * direction).squaredNorm();
        }
        steady.jitter = std::sqrt(squares / (2 * spline.freedom));
    }
    return steady;
}

} // namespace vcg::fcd
