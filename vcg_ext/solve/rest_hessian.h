// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_REST_HESSIAN_H
#define VCG_FCD_REST_HESSIAN_H

#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_hessian.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// The Hessian of the energy at rest, factorised once. In frames that turn with the nodes, the Hessian of any pose is
/// about the same (Mueller et al. 2002, stiffness warping). So some ten quasi-Newton steps by it reach rest (Liu et al.
/// 2017).
class RestHessian {
  public:
    using State = GraphEnergy::State;

    /// \param smooth alpha A, frame units^2 \throw Cancelled
    RestHessian(const DeformationGraph &graph, const GraphEnergy &energy, const GraphUnknowns &unknown, double smooth,
                const Progress &progress = {})
        : energy(energy), unknown(unknown), hessian(unknown) {
        // About a second, for some 30 thousand nodes of a surface. A hundred local and global steps take as long.
        const double limit = 4e9;
        const std::size_t k = std::size_t(graph.Size());
        const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
        const State rest{graph.graph.position.cast<double>(), std::vector<Eigen::Matrix3d>(k, one),
                         std::vector<Eigen::Vector4d>(k, ToQuaternion(one)), 0};
        const GraphEnergy::PoseTerms poseTerms(energy, std::vector<Eigen::Affine3d>(k, Eigen::Affine3d::Identity()),
                                               rest, smooth);
        hessian.Assemble(energy, rest, poseTerms);
        hessian.HoldTurns(energy);
        isThere = !unknown.rotation.empty() && hessian.Factorise(progress, limit) && hessian.Falling() == 0;
        hessian.DropMatrix();
    }

    /// Whether it could be factorised, in a time that is worth it.
    bool IsThere() const { return isThere; }

    /// Takes a step. \param x the state before \param noise rounding error of the gradient \param y out: the state
    /// after \return false: the step is no more than rounding
    bool Step(const State &x, const GraphEnergy::PoseTerms &poseTerms, double noise, State &y) const {
        const Eigen::VectorXd gradient = energy.Gradient(x, poseTerms);
        Eigen::VectorXd step = gradient;
        Turn(x, true, step);
        step = -hessian.Solve(step);
        Turn(x, false, step);
        const bool isMore = -gradient.dot(step) > noise * step.cwiseAbs().maxCoeff();
        hessian.Limit(step);
        y = x;
        hessian.Move(y, step);
        return isMore;
    }

  private:
    /// Takes \p v, as the gradient is, into the frames of the nodes, or out of them.
    void Turn(const State &x, bool into, Eigen::VectorXd &v) const {
        for (std::size_t b = 0; b < unknown.rotation.size(); ++b) {
            const Eigen::Matrix3d &own = x.rotation[std::size_t(unknown.rotation[b])];
            const Eigen::Matrix3d turn = into ? own.transpose() : own;
            for (const Eigen::Index half : {0, 3}) {
                auto part = v.segment<3>(6 * Eigen::Index(b) + half);
                part = (turn * part).eval();
            }
        }
    }

    const GraphEnergy &energy;
    const GraphUnknowns &unknown;
    GraphHessian hessian;
    bool isThere = false;
};

} // namespace vcg::fcd::detail

#endif
