// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/symmetry/half_pose.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

namespace vcg::fcd {

GraphPose HalfPose(const DeformationGraph &graph, const GraphPose &full) {
    const Index n = graph.Size();
    GraphPose half = full;
    std::vector<Eigen::Matrix3d> turn; // half of the rotation of each node
    const Eigen::Matrix3Xd rest = graph.graph.position.cast<double>();
    for (Index j = 0; j < n; ++j) {
        const Eigen::Matrix3d &linear = full.linear[j];
        const detail::Turn whole(detail::RotationOf(linear));
        turn.push_back(detail::RotationBy(0.5 * whole.angle, whole.axis));
        half.linear[j] = 0.5 * (turn.back() + turn.back().transpose() * linear);
    }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
    const Csr &adjacency = graph.graph.adjacency;
    for (Index j = 0; j < n; ++j) {
        std::size_t item = adjacency.begin[j];
        double sum = 0;
        for (Index i : adjacency[j]) {
            const double weight = double(graph.weight[item++]);
            const Eigen::Matrix3d between = 0.5 * (turn[i] + turn[j]);
            const Eigen::Vector3d edge = 0.5 * (between * (rest.col(j) - rest.col(i)) +
                                                between.transpose() * (full.position.col(j) - full.position.col(i)));
            right.row(j) += weight * edge.transpose();
            sum += weight;
            if (i < j)
                entries.emplace_back(j, i, -weight);
        }
        entries.emplace_back(j, j, sum);
    }
    // One node of each connected part is held. Afterwards the part is shifted to the middle between rest and pose.
    std::vector<Index> part;
    const Index parts = ConnectedComponents(adjacency, part);
    std::vector<char> isHeld(std::size_t(parts), 0);
    for (Index j = 0; j < n; ++j)
        if (!isHeld[std::size_t(part[j])]) {
            isHeld[std::size_t(part[j])] = 1;
            entries.emplace_back(j, j, 1.);
        }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
    if (factor.info() != Eigen::Success)
        throw Unsolvable("Half of the way to the mirror image cannot be found on this graph. Begin with another number "
                         "of patches.");
    half.position = factor.solve(right).transpose();
    Eigen::Matrix3Xd shift = Eigen::Matrix3Xd::Zero(3, parts);
    std::vector<double> area(std::size_t(parts), 0);
    for (Index j = 0; j < n; ++j) {
        const double weight = graph.area.empty() ? 1 : graph.area[j];
        const auto p = std::size_t(part[j]);
        shift.col(Eigen::Index(p)) += weight * (0.5 * (rest.col(j) + full.position.col(j)) - half.position.col(j));
        area[p] += weight;
    }
    for (Index j = 0; j < n; ++j) {
        const Index p = part[j];
        half.position.col(j) += shift.col(p) / area[p];
    }
    return half;
}

} // namespace vcg::fcd
