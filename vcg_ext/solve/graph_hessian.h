// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_HESSIAN_H
#define VCG_FCD_GRAPH_HESSIAN_H

#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/base/sparse_factor.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

namespace vcg::fcd::detail {

/// Gradient and Hessian of the energy, factorised. The unknowns of each node are the step of its position and the
/// rotation vector of its further turn (along the axis, as long as the angle). Constrained positions and given
/// rotations are no unknowns.
class GraphHessian {
  public:
    using State = GraphEnergy::State;

    explicit GraphHessian(const GraphUnknowns &unknown, Index nodes)
        : unknown(unknown), position(nodes, -1), rotation(nodes, -1) {
        std::vector<char> turns(nodes, 0);
        for (Index i : unknown.rotation)
            turns[i] = 1;
        for (Index i = 0; i < nodes; ++i) {
            if (unknown.numberOf[i] >= 0)
                position[i] = size, size += 3;
            if (turns[i])
                rotation[i] = size, size += 3;
        }
    }

    /// \return whether it could be factorised, in a time that is worth it \throw Cancelled
    bool Factorise(const GraphEnergy &energy, const State &x, const GraphEnergy::PoseTerms &given,
                   const Progress &progress = {}) {
        gradient = Eigen::VectorXd::Zero(size);
        std::vector<Eigen::Triplet<double>> entries;
        const auto add = [&](Index row, Index column, const Eigen::Matrix3d &block) {
            if (row < 0 || column < 0)
                return;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c)
                    if (row + r >= column + c)
                        entries.emplace_back(row + r, column + c, block(r, c));
        };
        const auto addBoth = [&](Index a, Index b, const Eigen::Matrix3d &block) { // of the lower triangle
            a > b ? add(a, b, block) : add(b, a, block.transpose());
        };
        const auto pull = [&](Index at, const Eigen::Vector3d &g) {
            if (at >= 0)
                gradient.segment<3>(at) += g;
        };
        const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
        energy.ForEachEdge(
            x, given, [&](Index i, Index j, double w, const Eigen::Vector3d &way, const Eigen::Vector3d(&turned)[2]) {
                const Index node[2] = {i, j};
                const Eigen::Vector3d force = 2 * w * (2 * way - turned[0] - turned[1]);
                pull(position[i], force);
                pull(position[j], -force);
                add(position[i], position[i], 4 * w * one);
                add(position[j], position[j], 4 * w * one);
                if (position[i] >= 0 && position[j] >= 0)
                    addBoth(position[i], position[j], -4 * w * one);
                for (int end = 0; end < 2; ++end) {
                    const Index at = rotation[node[end]];
                    if (at < 0)
                        continue;
                    const Eigen::Vector3d &u = turned[end];
                    pull(at, -2 * w * u.cross(way));
                    add(at, at, w * (2 * way.dot(u) * one - way * u.transpose() - u * way.transpose()));
                    if (position[i] >= 0)
                        addBoth(position[i], at, 2 * w * CrossMatrix(u));
                    if (position[j] >= 0)
                        addBoth(position[j], at, -2 * w * CrossMatrix(u));
                }
            });
        energy.ForEachTwist(x, given, [&](Index i, Index j, double w, const Eigen::Matrix3d &m) {
            // - 2 w tr(m), m = R_j R_i^T; j < 0: of the anchor
            const Index b = j < 0 ? -1 : rotation[j], a = rotation[i];
            const Eigen::Vector3d axial(m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0));
            pull(a, 2 * w * axial);
            pull(b, -2 * w * axial);
            const Eigen::Matrix3d own = -2 * w * (0.5 * (m + m.transpose()) - m.trace() * one);
            add(a, a, own);
            add(b, b, own);
            if (a >= 0 && b >= 0)
                addBoth(a, b, -2 * w * (m.trace() * one - m));
        });
        hessian.resize(size, size);
        hessian.setFromTriplets(entries.begin(), entries.end());
        if (!isAnalysed)
            isWorthwhile = factor.Analyse(hessian, SparseFactor::Worthwhile(size));
        isAnalysed = true;
        return isWorthwhile && factor.Factorise(hessian, progress, "Deforming the graph") &&
               factor.vectorD().allFinite();
    }

    /// How many directions there are in which the energy falls off to both sides.
    Index Falling() const { return Index((factor.vectorD().array() < 0).count()); }

    /// Newton's step from where it was factorised.
    Eigen::VectorXd Newton() const { return factor.solve(-gradient); }
    Eigen::VectorXd Solve(const Eigen::VectorXd &right) const { return factor.solve(right); }
    Eigen::VectorXd Times(const Eigen::VectorXd &way) const { return hessian.selfadjointView<Eigen::Lower>() * way; }
    const Eigen::VectorXd &Gradient() const { return gradient; }

    /// Goes \p step on from \p x.
    void Move(State &x, const Eigen::VectorXd &step) const {
        for (Index i : unknown.position)
            x.position.col(i) += step.segment<3>(position[i]);
        for (Index i : unknown.rotation) {
            const Eigen::Vector3d turn = step.segment<3>(rotation[i]);
            if (turn.isZero(0))
                continue;
            x.rotation[i] = RotationBy(turn) * x.rotation[i];
            const Eigen::Vector4d q = ToQuaternion(x.rotation[i]);
            x.quaternion[i] = q.dot(x.quaternion[i]) < 0 ? Eigen::Vector4d(-q) : q;
        }
    }
    double LargestTurn(const Eigen::VectorXd &step) const {
        return Largest(step, unknown.rotation, rotation, [](Index) { return true; });
    }
    /// Of nodes whose position is given.
    double LargestTurnOfGiven(const Eigen::VectorXd &step) const {
        return Largest(step, unknown.rotation, rotation, [&](Index i) { return unknown.constrained[i] != 0; });
    }
    double LargestMove(const Eigen::VectorXd &step) const {
        return Largest(step, unknown.position, position, [](Index) { return true; });
    }

  private:
    template <class Counts>
    static double Largest(const Eigen::VectorXd &step, const std::vector<Index> &node, const std::vector<Index> &at,
                          const Counts &counts) {
        double most = 0;
        for (Index i : node)
            if (counts(i))
                most = std::max(most, step.segment<3>(at[i]).norm());
        return most;
    }

    const GraphUnknowns &unknown;
    std::vector<Index> position, rotation; // k, where those of a node begin; -1 where they are given
    Index size = 0;
    Eigen::VectorXd gradient;
    Eigen::SparseMatrix<double> hessian; // its lower triangle
    bool isAnalysed = false, isWorthwhile = false;
    SparseFactor factor;
};

} // namespace vcg::fcd::detail

#endif
