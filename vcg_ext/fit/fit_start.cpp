// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/fit/fit_start.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>

namespace vcg {
namespace fcd {

Eigen::Affine3d StartFromLandmarks(const std::vector<Eigen::Vector3d> &from, const std::vector<Eigen::Vector3d> &to,
                                   bool similar) {
    Eigen::Matrix3Xd a(3, Eigen::Index(from.size())), b(3, a.cols());
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
        a.col(i) = from[std::size_t(i)];
        b.col(i) = to[std::size_t(i)];
    }
    if (a.cols() >= 3) {
        Eigen::Matrix3Xd way = a.colwise() - a.rowwise().mean();
        const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::MatrixXd>(way).singularValues().head<3>();
        if (spread[1] > 1e-6 * spread[0])
            return Eigen::Affine3d(Eigen::umeyama(a, b, similar));
    }
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
