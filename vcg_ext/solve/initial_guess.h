// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_INITIAL_GUESS_H
#define VCG_FCD_INITIAL_GUESS_H

#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_laplacian.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// The state that the iteration begins with: the motions of the constrained nodes since the last pose (or rest),
/// interpolated by the bi-Laplacian. A motion that all of them have in common is reproduced exactly.
inline GraphEnergy::State InitialGuess(const DeformationGraph &graph, const GraphUnknowns &unknown,
                                       const GraphLaplacian &laplacian, const std::vector<Eigen::Affine3d> &motion,
                                       const GraphPose *last, const std::vector<Eigen::Affine3d> &lastMotion) {
    using Matrix34d = Eigen::Matrix<double, 3, 4>;
    const Index k = graph.Size();
    const Eigen::Matrix3Xd rest = graph.graph.position.cast<double>();
    const Eigen::Matrix3Xd &before = last ? last->position : rest;
    GraphEnergy::State state{rest, std::vector<Eigen::Matrix3d>(k, Eigen::Matrix3d::Identity()), {}, 0};
    std::vector<Eigen::Matrix3d> &rotation = state.rotation;
    if (last)
        for (Index i = 0; i < k; ++i)
            rotation[i] = RotationOf(last->linear[i]);
    // Interpolate the differences from the first node's motion. The solution's rounding is large where a node is hardly
    // connected; so it does not touch what all motions have in common.
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(k, 12);
    Matrix34d common = Matrix34d::Identity();
    bool isFirst = true;
    for (Index i = 0; i < k; ++i)
        if (unknown.constrained[i]) {
            state.position.col(i) = motion[i] * Eigen::Vector3d(rest.col(i));
            const Eigen::Affine3d sinceLast = last ? motion[i] * lastMotion[i].inverse() : motion[i];
            rotation[i] = last && unknown.compliant[i] ? Eigen::Matrix3d(RotationOf(sinceLast.linear()) * rotation[i])
                                                       : RotationOf(motion[i].linear());
            if (isFirst)
                common = sinceLast.matrix().topRows<3>();
            isFirst = false;
            const Matrix34d m = sinceLast.matrix().topRows<3>() - common;
            change.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 12>>(m.data());
        }
    const Eigen::MatrixXd guess = laplacian.Interpolate(change);
    for (std::size_t u = 0; u < unknown.position.size(); ++u) {
        const Index i = unknown.position[u];
        const Eigen::Matrix<double, 1, 12> row = guess.row(Eigen::Index(u));
        const Matrix34d m = Eigen::Map<const Matrix34d>(row.data()) + common;
        state.position.col(i) = m * before.col(i).homogeneous();
        const Eigen::Matrix3d turn = RotationOf(m.leftCols<3>());
        rotation[i] = last ? Eigen::Matrix3d(turn * rotation[i]) : turn;
    }
    for (const Eigen::Matrix3d &r : rotation)
        state.quaternion.push_back(ToQuaternion(r));
    return state;
}

} // namespace vcg::fcd::detail

#endif
