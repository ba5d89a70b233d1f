// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/fit/fit_start.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD> // umeyama needs it
#include <algorithm>
#include <cmath>
#include <limits>

namespace vcg {
namespace fcd {

double AcrossALine(const std::vector<Eigen::Vector3d> &points) {
    if (points.size() < 3)
        return 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d &p : points)
        middle += p / double(points.size());
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d &p : points)
        second += (p - middle) * (p - middle).transpose();
    const Eigen::Vector3d squared = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvalues();
    return squared[2] > 0 ? std::sqrt(std::max(squared[1], 0.0) / squared[2]) : 0;
}

Eigen::Affine3d StartFromLandmarks(const std::vector<Eigen::Vector3d> &from, const std::vector<Eigen::Vector3d> &to,
                                   bool similar) {
    Eigen::Matrix3Xd a(3, Eigen::Index(from.size())), b(3, a.cols());
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
        a.col(i) = from[std::size_t(i)];
        b.col(i) = to[std::size_t(i)];
    }
    if (AcrossALine(from) > 1e-6) // more than what rounding leaves
        return Eigen::Affine3d(Eigen::umeyama(a, b, similar));
    throw BadInput("A start from landmarks needs three of them that are not on a line, better four or more. Give more "
                   "landmarks, or start from where the layers lie.");
}

Eigen::Affine3d StartFromAxes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads) {
    Moments own;
    for (const Eigen::Vector3d &p : points)
        own.Add(p, 1);
    const Moments &its = target.Spread();
    const Eigen::Matrix3d axes = own.Axes(), targetAxes = its.Axes();
    Eigen::Affine3d best = Eigen::Affine3d::Identity();
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> far[2]; // with the target's normals as they are, and turned over
    for (std::vector<double> &each : far)
        each.resize(points.size());
    int order[3] = {0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Eigen::Matrix3d to;
            for (int d = 0; d < 3; ++d)
                to.col(d) = (signs >> d & 1 ? -1 : 1) * targetAxes.col(order[d]);
            const Eigen::Matrix3d turn = to * axes.transpose();
            if (turn.determinant() < 0)
                continue;
            Eigen::Affine3d motion(turn);
            motion.translation() = its.Middle() - turn * own.Middle();
            ParallelFor(threads, points.size(), 64, [&](std::size_t begin, std::size_t end) {
                for (std::size_t s = begin; s < end; ++s) {
                    const Eigen::Vector3d p = motion * points[s];
                    const FitTarget::Match match = target.Nearest(p);
                    const double cosine = match.normal.dot(turn * normal[s]);
                    // A side that looks the other way is no counterpart: as if it were so much farther.
                    for (int side = 0; side < 2; ++side)
                        far[side][s] = (p - match.point).norm() *
                                       (match.isOriented && (side == 0 ? cosine < 0 : cosine > 0) ? 3 : 1);
                }
            });
            for (std::vector<double> &each : far) {
                std::sort(each.begin(), each.end());
                double sum = 0;
                for (std::size_t s = 0; s < 4 * each.size() / 5; ++s)
                    sum += each[s];
                if (sum < least) {
                    least = sum;
                    best = motion;
                }
            }
        }
    } while (std::next_permutation(order, order + 3));
    return best;
}

} // namespace fcd
} // namespace vcg
