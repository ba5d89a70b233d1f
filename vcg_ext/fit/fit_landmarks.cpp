// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/fit_landmarks.h>

#include <Eigen/QR>
#include <algorithm>

namespace vcg {
namespace fcd {

double MoveOnto(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                const std::vector<char> &isFree, GraphPose &pose) {
    if (place.empty())
        return 0;
    std::vector<Index> column(isFree.size(), -1), node; // of the nodes that some of the samples follow
    for (std::uint32_t t = samples.begin[first]; t < samples.begin[first + place.size()]; ++t)
        if (const Index j = samples.term[t].node; isFree[std::size_t(j)] && column[std::size_t(j)] < 0) {
            column[std::size_t(j)] = Index(node.size());
            node.push_back(j);
        }
    if (node.empty())
        return 0;
    Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(Eigen::Index(place.size()), Eigen::Index(node.size()));
    for (std::size_t l = 0; l < place.size(); ++l)
        for (std::uint32_t t = samples.begin[first + l]; t < samples.begin[first + l + 1]; ++t)
            if (const Index c = column[std::size_t(samples.term[t].node)]; c >= 0)
                weight(Eigen::Index(l), c) += samples.term[t].weight;
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(weight);
    double largest = 0;
    for (int again = 0; again < 2; ++again) { // the second time it takes away what rounding left
        Eigen::MatrixXd off(Eigen::Index(place.size()), 3);
        for (std::size_t l = 0; l < place.size(); ++l)
            off.row(Eigen::Index(l)) = (place[l] - samples.At(first + l, pose)).transpose();
        const Eigen::MatrixXd move = solver.solve(off);
        for (std::size_t c = 0; c < node.size(); ++c)
            pose.position.col(node[c]) += move.row(Eigen::Index(c)).transpose();
        largest = std::max(largest, move.rowwise().norm().maxCoeff());
    }
    return largest;
}

} // namespace fcd
} // namespace vcg
