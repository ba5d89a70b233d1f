// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_HESSIAN_H
#define VCG_FCD_GRAPH_HESSIAN_H

#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/block_factor.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace vcg::fcd::detail {

/// The Hessian of the energy, factorised. Each node with an unknown has a block of six, as in GraphEnergy::Gradient.
/// The step of a given position is 0.
class GraphHessian {
  public:
    using State = GraphEnergy::State;

    explicit GraphHessian(const GraphUnknowns &unknown) : unknown(unknown) {}

    void Assemble(const GraphEnergy &energy, const State &x, const GraphEnergy::PoseTerms &poseTerms) {
        hessian.diagonal.assign(unknown.rotation.size(), Block::Zero());
        hessian.where.clear();
        hessian.beside.clear();
        AddEdges(energy, x, poseTerms);
        AddTwists(energy, x, poseTerms);
        for (std::size_t b = unknown.position.size(); b < unknown.rotation.size(); ++b) { // given positions
            hessian.diagonal[b].topRows<3>().setIdentity();
            hessian.diagonal[b].leftCols<3>().setIdentity();
        }
    }
    /// Lets rotations stay where their edges leave them open.
    void HoldTurns(const GraphEnergy &energy) {
        for (std::size_t b = 0; b < unknown.rotation.size(); ++b)
            hessian.diagonal[b].bottomRightCorner<3, 3>().diagonal().array() += energy.Stay(unknown.rotation[b]);
    }
    /// Factorises the matrix. \param limit the most multiplications \return false: it would take more, or the matrix is
    /// singular \throw Cancelled
    bool Factorise(const Progress &progress, double limit) {
        if (!isAnalysed)
            isWorthwhile = factor.Analyse(hessian, limit);
        isAnalysed = true;
        return isWorthwhile && factor.Factorise(hessian, progress, "Deforming the graph");
    }
    /// A limit for Factorise: the most multiplications that are worth it if local and global steps would also do.
    double Worthwhile() const { return SparseFactor::Worthwhile(width * Eigen::Index(unknown.rotation.size())); }

    /// Frees what is not needed to solve. \pre Factorise
    void DropMatrix() { hessian = {}; }

    /// The number of negative eigenvalues: 0 at a minimum, more at a saddle.
    Index Falling() const { return factor.Negative(); }

    Eigen::VectorXd Solve(const Eigen::VectorXd &right) const { return factor.Solve(right); }
    Eigen::VectorXd Times(const Eigen::VectorXd &step) const { return hessian * step; }

    /// Moves \p x by \p step.
    void Move(State &x, const Eigen::VectorXd &step) const {
        for (Index i : unknown.position)
            x.position.col(i) += Moved(step, i);
        for (Index i : unknown.rotation) {
            const Eigen::Vector3d turn = Turned(step, i);
            if (turn.isZero(0))
                continue;
            x.rotation[i] = RotationBy(turn) * x.rotation[i];
            const Eigen::Vector4d q = ToQuaternion(x.rotation[i]);
            x.quaternion[i] = q.dot(x.quaternion[i]) < 0 ? Eigen::Vector4d(-q) : q;
        }
    }
    /// Shortens \p step to turns for which the quadratic model still holds.
    void Limit(Eigen::VectorXd &step) const {
        const double farthest = 0.5; // radians
        step *= std::min(1.0, farthest / LargestTurn(step));
    }
    /// The largest turn of a node in \p step, radians.
    double LargestTurn(const Eigen::VectorXd &step) const {
        return Largest(unknown.rotation, [&](Index i) { return Turned(step, i).norm(); });
    }
    /// The same of compliant nodes alone: their positions are given, their rotations are not.
    double LargestTurnOfGiven(const Eigen::VectorXd &step) const {
        return Largest(unknown.rotation, [&](Index i) { return unknown.constrained[i] ? Turned(step, i).norm() : 0; });
    }
    double LargestMove(const Eigen::VectorXd &step) const {
        return Largest(unknown.position, [&](Index i) { return Moved(step, i).norm(); });
    }

  private:
    static constexpr Eigen::Index width = 6;
    using Block = BlockMatrix<int(width)>::Block;

    Eigen::Vector3d Moved(const Eigen::VectorXd &step, Index i) const {
        return step.segment<3>(width * unknown.turnOf[i]);
    }
    Eigen::Vector3d Turned(const Eigen::VectorXd &step, Index i) const {
        return step.segment<3>(width * unknown.turnOf[i] + 3);
    }

    template <class Of>
    static double Largest(const std::vector<Index> &node, const Of &of) {
        double most = 0;
        for (Index i : node)
            most = std::max(most, of(i));
        return most;
    }

    void AddEdges(const GraphEnergy &energy, const State &x, const GraphEnergy::PoseTerms &poseTerms) {
        const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
        energy.ForEachEdge(
            x, poseTerms,
            [&](Index i, Index j, double w, const Eigen::Vector3d &posed, const Eigen::Vector3d(&turned)[2]) {
                const Index block[2] = {unknown.turnOf[i], unknown.turnOf[j]};
                for (int end = 0; end < 2; ++end) {
                    if (block[end] < 0)
                        continue;
                    const double sign = end == 0 ? 1 : -1;
                    const Eigen::Vector3d &u = turned[end];
                    Block &own = hessian.diagonal[std::size_t(block[end])];
                    own.topLeftCorner<3, 3>() += 4 * w * one;
                    own.bottomRightCorner<3, 3>() +=
                        w * (2 * posed.dot(u) * one - posed * u.transpose() - u * posed.transpose());
                    const Eigen::Matrix3d mixed = sign * 2 * w * CrossMatrix(u);
                    own.topRightCorner<3, 3>() += mixed;
                    own.bottomLeftCorner<3, 3>() += mixed.transpose();
                }
                if (block[0] < 0 || block[1] < 0)
                    return;
                Block both = Block::Zero();
                both.topLeftCorner<3, 3>() = -4 * w * one;
                both.topRightCorner<3, 3>() = 2 * w * CrossMatrix(turned[1]);
                both.bottomLeftCorner<3, 3>() = 2 * w * CrossMatrix(turned[0]);
                if (unknown.constrained[i])
                    both.topRows<3>().setZero();
                if (unknown.constrained[j])
                    both.leftCols<3>().setZero();
                hessian.where.emplace_back(block[0], block[1]);
                hessian.beside.push_back(both);
            });
    }

    /// \pre AddEdges was called: the pairs come in the same order
    void AddTwists(const GraphEnergy &energy, const State &x, const GraphEnergy::PoseTerms &poseTerms) {
        std::size_t p = 0;
        energy.ForEachTwist(x, poseTerms, [&](Index i, Index j, double w, const Eigen::Matrix3d &m) {
            const Index block[2] = {unknown.turnOf[i], j < 0 ? -1 : unknown.turnOf[j]};
            const Eigen::Matrix3d trace = m.trace() * Eigen::Matrix3d::Identity();
            for (const Index each : block)
                if (each >= 0)
                    hessian.diagonal[std::size_t(each)].bottomRightCorner<3, 3>() -=
                        2 * w * (0.5 * (m + m.transpose()) - trace);
            if (block[0] >= 0 && block[1] >= 0)
                hessian.beside[p++].bottomRightCorner<3, 3>() = -2 * w * (trace - m);
        });
    }

    const GraphUnknowns &unknown;
    BlockMatrix<int(width)> hessian;
    bool isAnalysed = false, isWorthwhile = false;
    BlockFactor<int(width)> factor;
};

} // namespace vcg::fcd::detail

#endif
