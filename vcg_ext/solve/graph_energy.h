// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_ENERGY_H
#define VCG_FCD_GRAPH_ENERGY_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_unknowns.h>
#include <vcg_ext/base/rotation_fit.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vcg::fcd::detail {

/// The energy of SR-ARAP on a deformation graph of k nodes (Eq. 2), and its two minimisations: the best rotations at
/// given positions (Eq. 5), and the right side of the system for the best positions at given rotations (Eq. 6).
class GraphEnergy {
  public:
    /// The variables of the energy: positions and rotations of the nodes, frame units.
    struct State {
        Eigen::Matrix3Xd position;               ///< 3 x k
        std::vector<Eigen::Matrix3d> rotation;   ///< k
        std::vector<Eigen::Vector4d> quaternion; ///< k, of the rotations
        double energy;
    };

    /// The terms of the energy that are constant while one pose is solved.
    struct PoseTerms {
        double smooth;                       ///< alpha A
        std::vector<Eigen::Matrix3d> anchor; ///< k: a compliant node's rotation is drawn to this one, of its region
        std::vector<Eigen::Vector4d> anchorQuaternion; ///< k, the same
        std::vector<double> stiffness;                 ///< k, weight of the anchor: its w in Eq. 2
        std::vector<Eigen::Matrix3d> linear;           ///< k, linear parts of the motions; they may scale
        std::vector<Eigen::Vector3d> from;             ///< of each adjacency item's edge: its end at node i,
        std::vector<Eigen::Vector3d> to;               ///< and at neighbour j; read where that node is constrained
        Eigen::MatrixX3d right; ///< of the global step, a row each unknown position: share of the constrained ends
        double energy = 0;      ///< of the edges between nodes whose rotations are given

        PoseTerms(const GraphEnergy &g, const std::vector<Eigen::Affine3d> &motion, const State &x, double smooth)
            : smooth(smooth), linear(motion.size()), from(g.edge.size()), to(g.edge.size()),
              right(Eigen::MatrixX3d::Zero(Eigen::Index(g.unknown.position.size()), 3)) {
            const double depth = std::sqrt(g.heldDepth * smooth);
            anchor = x.rotation;
            anchorQuaternion = x.quaternion;
            stiffness.assign(g.graph.Size(), 0);
            for (Index i = 0; i < g.graph.Size(); ++i) {
                if (!g.unknown.compliant[i] || !(g.heldArea[i] > 0) || !(depth > 0))
                    continue;
                anchor[i] = RotationOf(motion[i].linear());
                anchorQuaternion[i] = ToQuaternion(anchor[i]);
                double border = 0;
                for (std::uint32_t e = g.Begin(i); e < g.Begin(i + 1); ++e)
                    border += g.graph.weight[e] * g.graph.edge.col(e).norm();
                stiffness[i] = std::min(border / depth, g.heldArea[i] / (depth * depth));
            }
            const auto rest = [&](Index i) { return g.graph.graph.position.col(i).template cast<double>(); };
            for (Index i = 0; i < g.graph.Size(); ++i) {
                linear[i] = motion[i].linear();
                for (std::uint32_t e = g.Begin(i); e < g.Begin(i + 1); ++e) {
                    const Index j = g.Neighbour(e);
                    const Eigen::Vector3d restEdge = g.graph.edge.col(e).cast<double>();
                    from[e] = g.graph.IsHeld(i) ? Eigen::Vector3d(motion[i] * (rest(j) + restEdge))
                                                : Eigen::Vector3d(x.position.col(i));
                    to[e] = g.graph.IsHeld(j) ? Eigen::Vector3d(motion[j] * (rest(i) - restEdge))
                                              : Eigen::Vector3d(x.position.col(j));
                    if (g.unknown.numberOf[i] >= 0 && g.unknown.constrained[j])
                        right.row(g.unknown.numberOf[i]) += g.graph.weight[e] * to[e].transpose();
                }
            }
            for (std::size_t p = g.openPairs; p < g.pairs.size(); ++p)
                energy += g.PairEnergy(g.pairs[p], x, *this).sum();
        }
    };

    /// \param heldArea k values, or empty for 0 \param heldDepth both as in GraphDeformer
    GraphEnergy(const DeformationGraph &graph, const GraphUnknowns &unknown, const std::vector<double> &heldArea,
                double heldDepth)
        : graph(graph), unknown(unknown), heldArea(heldArea), heldDepth(heldDepth) {
        const Index k = graph.Size();
        this->heldArea.resize(k, 0);
        edge.resize(graph.weight.size());
        stay.assign(k, 0);
        for (Index i = 0; i < k; ++i)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Eigen::Vector3d d = graph.edge.col(e).cast<double>();
                stay[i] += stayed * graph.weight[e] * d.squaredNorm();
                edge[e] = graph.weight[e] * d;
            }
        for (double &s : stay)
            if (!(s > 0)) // no edges: nothing else holds the rotation
                s = 1;
        for (Index i = 0; i < k; ++i)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                if (i < Neighbour(e) && unknown.HasConstraint(i))
                    pairs.push_back({i, Neighbour(e), e});
        const auto isOpen = [&](const Pair &p) {
            return !unknown.IsRotationGiven(p.i) || !unknown.IsRotationGiven(p.j);
        };
        openPairs = std::size_t(std::stable_partition(pairs.begin(), pairs.end(), isOpen) - pairs.begin());
        sumOfEdges.assign(unknown.position.size(), Eigen::Vector3d::Zero());
        for (std::size_t u = 0; u < sumOfEdges.size(); ++u)
            for (std::uint32_t e = Begin(unknown.position[u]); e < Begin(unknown.position[u] + 1); ++e)
                sumOfEdges[u] += edge[e];
    }

    /// The sum of the weights of what depends on the unknowns.
    double Weight() const {
        double sum = 0;
        for (std::size_t p = 0; p < openPairs; ++p)
            sum += graph.weight[pairs[p].e];
        return sum;
    }

    /// What a turn of node \p i alone moves: the sum of its edges' weights times their lengths^2.
    double TurningMass(Index i) const {
        double mass = 0;
        for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
            mass += graph.weight[e] * graph.edge.col(e).cast<double>().squaredNorm();
        return mass;
    }

    /// Eq. 2.
    double Of(const State &x, const PoseTerms &poseTerms) const {
        double energy = poseTerms.energy;
        for (std::size_t p = 0; p < openPairs; ++p)
            energy += PairEnergy(pairs[p], x, poseTerms).sum();
        for (Index i : unknown.rotation)
            energy += AnchorEnergy(i, x, poseTerms);
        return energy;
    }

    /// Each node's share of the energy.
    std::vector<double> Shares(const State &x, const PoseTerms &poseTerms) const {
        std::vector<double> shares(graph.Size(), 0);
        for (const Pair &p : pairs) {
            const Eigen::Vector2d share = PairEnergy(p, x, poseTerms);
            shares[p.i] += share[0];
            shares[p.j] += share[1];
        }
        for (Index i : unknown.rotation)
            shares[i] += AnchorEnergy(i, x, poseTerms);
        return shares;
    }

    /// The local step (Eq. 5): fits the rotations of \p y one after the other, at the positions of \p x.
    /// \param s k matrices to work with
    void FitRotations(const State &x, const PoseTerms &poseTerms, State &y, std::vector<Eigen::Matrix3d> &s) const {
        for (Eigen::Matrix3d &each : s)
            each.setZero();
        for (std::size_t n = 0; n < openPairs; ++n) {
            const Pair &p = pairs[n];
            const Eigen::Matrix3d both = edge[p.e] * PosedEdge(p, x, poseTerms).transpose();
            s[p.i] += both;
            s[p.j] += both;
        }
        y.rotation = x.rotation;
        for (Index i : unknown.rotation) {
            Eigen::Matrix3d neighbours = Eigen::Matrix3d::Zero();
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                neighbours += double(graph.weight[e]) * y.rotation[Neighbour(e)];
            neighbours += poseTerms.stiffness[i] * poseTerms.anchor[i];
            const Eigen::Matrix3d sum =
                s[i] + poseTerms.smooth * neighbours.transpose() + stay[i] * x.rotation[i].transpose();
            const Eigen::Vector4d q = FitQuaternion(sum, x.quaternion[i]);
            y.quaternion[i] = q.dot(x.quaternion[i]) < 0 ? Eigen::Vector4d(-q) : q;
            y.rotation[i] = ToMatrix(q);
        }
    }

    /// The right side of the global step (Eq. 6) for unknown position number \p u, with the rotations of \p x.
    Eigen::Vector3d RightSide(std::size_t u, const State &x, const PoseTerms &poseTerms) const {
        const Index i = unknown.position[u];
        Eigen::Vector3d b = x.rotation[i] * sumOfEdges[u];
        for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
            b += Linear(x, poseTerms, Neighbour(e)) * edge[e];
        return poseTerms.right.row(u).transpose() + 0.5 * b;
    }

    /// The gradient, by a block of six for each node with an unknown, in the order of GraphUnknowns::rotation: its
    /// position (0 where that is given), and the rotation vector of its further turn (along the axis, as long as the
    /// angle).
    Eigen::VectorXd Gradient(const State &x, const PoseTerms &poseTerms) const {
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(6 * Eigen::Index(unknown.rotation.size()));
        ForEachEdge(x, poseTerms,
                    [&](Index i, Index j, double w, const Eigen::Vector3d &posed, const Eigen::Vector3d(&turned)[2]) {
                        const Index block[2] = {unknown.turnOf[i], unknown.turnOf[j]};
                        const Eigen::Vector3d force = 2 * w * (2 * posed - turned[0] - turned[1]);
                        for (int end = 0; end < 2; ++end) {
                            if (block[end] < 0)
                                continue;
                            gradient.segment<3>(6 * Eigen::Index(block[end])) += (end == 0 ? 1 : -1) * force;
                            gradient.segment<3>(6 * Eigen::Index(block[end]) + 3) -= 2 * w * turned[end].cross(posed);
                        }
                    });
        ForEachTwist(x, poseTerms, [&](Index i, Index j, double w, const Eigen::Matrix3d &m) {
            // - 2 w tr(m), m = R_j R_i^T; j < 0: of the anchor
            const Index block[2] = {unknown.turnOf[i], j < 0 ? -1 : unknown.turnOf[j]};
            const Eigen::Vector3d axial(m(1, 2) - m(2, 1), m(2, 0) - m(0, 2), m(0, 1) - m(1, 0));
            for (int end = 0; end < 2; ++end)
                if (block[end] >= 0)
                    gradient.segment<3>(6 * Eigen::Index(block[end]) + 3) += (end == 0 ? 2 : -2) * w * axial;
        });
        for (std::size_t b = unknown.position.size(); b < unknown.rotation.size(); ++b) // given positions
            gradient.segment<3>(6 * Eigen::Index(b)).setZero();
        return gradient;
    }

    /// How strongly the rotation of node \p i stays where its edges leave it open.
    double Stay(Index i) const { return stay[i]; }

    /// body(i, j, weight, p'_i - p'_j, {R_i e, R_j e}) for each edge that depends on the unknowns: it contributes the
    /// weight times the squares of what the former differs by from each of the latter.
    template <class Body>
    void ForEachEdge(const State &x, const PoseTerms &poseTerms, const Body &body) const {
        for (std::size_t p = 0; p < openPairs; ++p) {
            const Pair &pair = pairs[p];
            const Eigen::Vector3d rest = graph.edge.col(pair.e).cast<double>();
            const Eigen::Vector3d turned[2] = {Linear(x, poseTerms, pair.i) * rest,
                                               Linear(x, poseTerms, pair.j) * rest};
            body(pair.i, pair.j, double(graph.weight[pair.e]), PosedEdge(pair, x, poseTerms), turned);
        }
    }

    /// Calls body(i, j, w, R_j R_i^T) for each pair of rotations with at least one unknown. Its energy is
    /// w |R_i - R_j|^2. j is -1 for the anchor of i.
    template <class Body>
    void ForEachTwist(const State &x, const PoseTerms &poseTerms, const Body &body) const {
        for (std::size_t p = 0; p < openPairs; ++p)
            body(pairs[p].i, pairs[p].j, graph.weight[pairs[p].e] * poseTerms.smooth,
                 Eigen::Matrix3d(x.rotation[pairs[p].j] * x.rotation[pairs[p].i].transpose()));
        for (Index i : unknown.rotation)
            if (poseTerms.stiffness[i] > 0)
                body(i, Index(-1), poseTerms.stiffness[i] * poseTerms.smooth,
                     Eigen::Matrix3d(poseTerms.anchor[i] * x.rotation[i].transpose()));
    }

  private:
    static constexpr double stayed = 1e-6; // stay over the weights of a node's edges

    /// An edge of the graph, once.
    struct Pair {
        Index i, j;
        std::uint32_t e; // from j to i
    };

    std::uint32_t Begin(Index i) const { return graph.graph.adjacency.begin[i]; }
    Index Neighbour(std::uint32_t e) const { return graph.graph.adjacency.item[e]; }

    /// e' of a pair: from its end at j to its end at i.
    Eigen::Vector3d PosedEdge(const Pair &p, const State &x, const PoseTerms &poseTerms) const {
        return (unknown.constrained[p.i] ? poseTerms.from[p.e] : Eigen::Vector3d(x.position.col(p.i))) -
               (unknown.constrained[p.j] ? poseTerms.to[p.e] : Eigen::Vector3d(x.position.col(p.j)));
    }
    /// The linear part that applies to the edges of node \p i.
    const Eigen::Matrix3d &Linear(const State &x, const PoseTerms &poseTerms, Index i) const {
        return unknown.IsRotationGiven(i) ? poseTerms.linear[i] : x.rotation[i];
    }

    /// The terms of Eq. 2 at both ends of an edge, the smoothness counted once (so that Eq. 5 is the minimum).
    Eigen::Vector2d PairEnergy(const Pair &p, const State &x, const PoseTerms &poseTerms) const {
        const Eigen::Vector3d rest = graph.edge.col(p.e).cast<double>(), posed = PosedEdge(p, x, poseTerms);
        const double cosine = x.quaternion[p.i].dot(x.quaternion[p.j]); // |R_i - R_j|^2 = 8 (1 - cosine^2)
        const double smooth = 4 * graph.weight[p.e] * poseTerms.smooth * std::max(0.0, 1 - cosine * cosine);
        return {graph.weight[p.e] * (posed - Linear(x, poseTerms, p.i) * rest).squaredNorm() + smooth,
                graph.weight[p.e] * (posed - Linear(x, poseTerms, p.j) * rest).squaredNorm() + smooth};
    }

    /// The term of a compliant node's anchor.
    static double AnchorEnergy(Index i, const State &x, const PoseTerms &poseTerms) {
        if (!(poseTerms.stiffness[i] > 0))
            return 0;
        const double cosine = x.quaternion[i].dot(poseTerms.anchorQuaternion[i]);
        return 8 * poseTerms.stiffness[i] * poseTerms.smooth * std::max(0.0, 1 - cosine * cosine);
    }

    const DeformationGraph &graph;
    const GraphUnknowns &unknown;
    std::vector<double> heldArea; // k
    double heldDepth;
    std::vector<double> stay;                // k, how strongly a rotation is held where its edges leave it open
    std::vector<Eigen::Vector3d> edge;       // w_ij e_ij of each adjacency item
    std::vector<Eigen::Vector3d> sumOfEdges; // of each unknown position's node
    std::vector<Pair> pairs;                 // the edges of components with a constrained node
    std::size_t openPairs = 0;               // number of those that depend on the unknowns; they come first
};

} // namespace vcg::fcd::detail

#endif
