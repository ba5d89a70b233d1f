// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_landmarks.h>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

namespace vcg::fcd {

namespace {

/// The largest size of a matrix that is decomposed as a dense one: this takes up to a second.
constexpr std::size_t mostDense = 1 << 20;

/// The least solution of a large least-squares system, by conjugate gradients on the normal equations from 0 (CGLS).
/// Columns of \p off are solved each by itself.
Eigen::MatrixXd LeastMoves(const Eigen::SparseMatrix<double> &weight, const Eigen::MatrixXd &off,
                           const Progress &progress) {
    Eigen::MatrixXd move = Eigen::MatrixXd::Zero(weight.cols(), off.cols()), left = off,
                    direction = weight.transpose() * left;
    Eigen::RowVectorXd square = direction.colwise().squaredNorm();
    const Eigen::RowVectorXd enough = 1e-24 * square; // a relative 1e-12 of the gradient: rounding
    const auto over = [](double a, double b) { return b > 0 ? a / b : 0; };
    const int most = 300; // weights of blends take 50 to 100
    for (int step = 0; step < most && (square.array() > enough.array()).any(); ++step) {
        progress(0, "Fitting");
        const Eigen::MatrixXd there = weight * direction;
        const Eigen::RowVectorXd length = square.binaryExpr(there.colwise().squaredNorm(), over);
        move += direction * length.asDiagonal();
        left -= there * length.asDiagonal();
        const Eigen::MatrixXd gradient = weight.transpose() * left;
        const Eigen::RowVectorXd next = gradient.colwise().squaredNorm();
        direction = gradient + direction * Eigen::RowVectorXd(next.binaryExpr(square, over)).asDiagonal();
        square = next;
    }
    return move;
}

} // namespace

Eigen::Vector3d Within(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x) {
    const Eigen::Vector3d off = x - place;
    const double far = off.norm();
    const double inside = 0.999 * tolerance; // within also after rounding
    return far <= inside ? x : Eigen::Vector3d(place + (far > 0 ? inside / far : 0) * off);
}

FitSystem::Pull LandmarkPull(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x, double weight) {
    // The weight within the tolerance: as the matches of a two-thousandth of the surface have or, if there are many
    // landmarks, a hundredth of the weight outside. That is more than the stiffness at the end, and less than the
    // matches around. A tolerance larger than a hand misses by says that landmarks are wrong and not only uncertain:
    // then the weight falls with its square.
    constexpr double byHand = 0.01; // of the diagonal
    const double within = std::min({5e-4, 0.01 * weight, 5e-4 * detail::Squared(byHand / std::max(tolerance, 1e-9))});
    const Eigen::Vector3d off = x - Within(tolerance, place, x);
    FitSystem::Pull pull;
    pull.form = weight * Eigen::Matrix3d::Identity();
    pull.gradient = weight * off;
    if (tolerance > 0) {
        // Hessian of the distance from the ball, which is curved: along the ball, its distance from the ball over that
        // from the target. Without it, landmarks outside would move far along the ball in each step.
        const Eigen::Vector3d to = x - place, direction = off.stableNormalized();
        const double far = to.norm(), along = far > 0 ? off.norm() / far : 0;
        pull.form *= within / weight + along;
        pull.form += weight * (1 - along) * direction * direction.transpose();
        pull.gradient += within * to;
    }
    return pull;
}

double MoveOnto(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                const std::vector<char> &isFree, GraphPose &pose, const Progress &progress) {
    if (place.empty())
        return 0;
    std::vector<Index> column(isFree.size(), -1), node; // of the free nodes that the samples follow
    for (std::uint32_t t = samples.begin[first]; t < samples.begin[first + place.size()]; ++t)
        if (const Index j = samples.term[t].node; isFree[j] && column[j] < 0) {
            column[j] = Index(node.size());
            node.push_back(j);
        }
    if (node.empty())
        return 0;
    std::vector<Eigen::Triplet<double>> items;
    for (std::size_t l = 0; l < place.size(); ++l)
        for (std::uint32_t t = samples.begin[first + l]; t < samples.begin[first + l + 1]; ++t)
            if (const Index c = column[std::size_t(samples.term[t].node)]; c >= 0)
                items.emplace_back(Eigen::Index(l), c, samples.term[t].weight);
    Eigen::SparseMatrix<double> weight(Eigen::Index(place.size()), Eigen::Index(node.size()));
    weight.setFromTriplets(items.begin(), items.end());
    const bool isDense = place.size() * node.size() <= mostDense;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    if (isDense)
        solver.compute(Eigen::MatrixXd(weight));
    double largest = 0;
    for (int again = 0; again < 2; ++again) { // the second time, to remove rounding
        Eigen::MatrixXd off(Eigen::Index(place.size()), 3);
        for (std::size_t l = 0; l < place.size(); ++l)
            off.row(Eigen::Index(l)) = (place[l] - samples.At(first + l, pose)).transpose();
        const Eigen::MatrixXd move = isDense ? Eigen::MatrixXd(solver.solve(off)) : LeastMoves(weight, off, progress);
        for (std::size_t c = 0; c < node.size(); ++c)
            pose.position.col(node[c]) += move.row(Eigen::Index(c)).transpose();
        largest = std::max(largest, move.rowwise().norm().maxCoeff());
    }
    return largest;
}

double MoveTowards(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                   const std::vector<char> &isFree, GraphPose &pose) {
    // Iterated regularisation (Tikhonov 1963, King 1979). The squares of a sample's weights sum to a tenth or so. So
    // each round brings a sample ten times nearer or more if its nodes can move it by itself, and hardly if they
    // cannot.
    constexpr double damping = 1e-2;
    constexpr int rounds = 12;
    const Eigen::Index n = Eigen::Index(place.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t l = 0; l < place.size(); ++l)
        for (std::uint32_t t = samples.begin[first + l]; t < samples.begin[first + l + 1]; ++t)
            if (isFree[std::size_t(samples.term[t].node)])
                entries.emplace_back(Eigen::Index(l), samples.term[t].node, samples.term[t].weight);
    Eigen::SparseMatrix<double> weight(n, Eigen::Index(isFree.size())), square(n, n);
    weight.setFromTriplets(entries.begin(), entries.end());
    square.setIdentity();
    square = Eigen::SparseMatrix<double>(weight * weight.transpose()) + damping * square;
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver(square);
    const Eigen::Matrix3Xd before = pose.position;
    for (int round = 0; round < rounds; ++round) {
        Eigen::MatrixXd off(n, 3);
        for (std::size_t l = 0; l < place.size(); ++l)
            off.row(Eigen::Index(l)) = (place[l] - samples.At(first + l, pose)).transpose();
        pose.position += (weight.transpose() * solver.solve(off)).transpose();
    }
    return (pose.position - before).colwise().norm().maxCoeff();
}

} // namespace vcg::fcd
