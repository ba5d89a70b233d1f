// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_DEFORMER_H
#define VCG_FCD_GRAPH_DEFORMER_H

#include "deformation_graph.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace fcd {

/// How the graph is deformed (paper, sec. 2.2).
struct SolverParam {
    double smoothness = 0.005; ///< alpha of Eq. 2, >= 0: the higher, the more evenly bending and twist are spread
    int maxIterations = 1000;  ///< >= 0
    double tolerance = 1e-5;   ///< stop when no node moves more than this fraction of the graph's diagonal
};

/// Where each node of a deformation graph went: x -> linear * (x - rest) + position.
struct GraphPose {
    Eigen::Matrix3Xd position;           ///< 3 x k, c'_j
    std::vector<Eigen::Matrix3d> linear; ///< k, R_j; of a constrained node the linear part of its motion
    double energy = 0;                   ///< Eq. 2, frame units^2
    int iterations = 0;
    bool converged = true;
};

namespace detail {

/// The rotation R that maximises tr(R S).
///
/// Its quaternion is the eigenvector of the largest eigenvalue of a symmetric, traceless 4 x 4 matrix (Davenport; Horn
/// 1987). The eigenvalue is the largest root of a quartic, found by Newton's method from above (Theobald 2005), the
/// eigenvector a column of the adjugate. Where the eigenvalue is close to double, the rotation is not unique and an SVD
/// chooses one.
inline Eigen::Matrix3d FitRotation(const Eigen::Matrix3d &unscaled) {
    const double size = unscaled.cwiseAbs().maxCoeff();
    if (!(size > 0) || !std::isfinite(size))
        return Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d s = unscaled / size;
    Eigen::Matrix4d k;
    k << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0), //
        0, s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),                  //
        0, 0, s(1, 1) - s(0, 0) - s(2, 2), s(1, 2) + s(2, 1),                                  //
        0, 0, 0, s(2, 2) - s(0, 0) - s(1, 1);
    k.triangularView<Eigen::StrictlyLower>() = k.transpose();
    // 2 x 2 minors of the upper and of the lower two rows serve the determinant and the adjugate.
    const double norm2 = s.squaredNorm(), c2 = -2 * norm2, c1 = -8 * s.determinant(), c0 = k.determinant();
    double lambda = std::sqrt(3 * norm2);
    for (int i = 0; i < 50; ++i) {
        const double l2 = lambda * lambda, value = (l2 + c2) * l2 + c1 * lambda + c0,
                     slope = (4 * l2 + 2 * c2) * lambda + c1;
        if (!(value > 1e-14 * norm2 * norm2)) // rounding
            break;
        lambda -= value / slope;
    }
    k.diagonal().array() -= lambda;
    Eigen::Matrix4d adjugate;
    for (int column = 0; column < 4; ++column) {
        const int i = (column + 1) & 3, j = (column + 2) & 3, l = (column + 3) & 3;
        const double m01 = k(i, 0) * k(j, 1) - k(i, 1) * k(j, 0), m02 = k(i, 0) * k(j, 2) - k(i, 2) * k(j, 0),
                     m03 = k(i, 0) * k(j, 3) - k(i, 3) * k(j, 0), m12 = k(i, 1) * k(j, 2) - k(i, 2) * k(j, 1),
                     m13 = k(i, 1) * k(j, 3) - k(i, 3) * k(j, 1), m23 = k(i, 2) * k(j, 3) - k(i, 3) * k(j, 2);
        adjugate.col(column) << k(l, 1) * m23 - k(l, 2) * m13 + k(l, 3) * m12,
            -(k(l, 0) * m23 - k(l, 2) * m03 + k(l, 3) * m02), k(l, 0) * m13 - k(l, 1) * m03 + k(l, 3) * m01,
            -(k(l, 0) * m12 - k(l, 1) * m02 + k(l, 2) * m01);
    }
    int best;
    const double length2 = adjugate.colwise().squaredNorm().maxCoeff(&best);
    if (length2 < 1e-9 * norm2 * norm2 * norm2) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d u = svd.matrixU();
        if ((svd.matrixV() * u.transpose()).determinant() < 0)
            u.col(2) *= -1; // singular values are sorted: the smallest is the last
        return svd.matrixV() * u.transpose();
    }
    const Eigen::Vector4d q = adjugate.col(best) / std::sqrt(length2);
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

/// The rotation part of a linear map with a positive determinant.
inline Eigen::Matrix3d RotationOf(const Eigen::Matrix3d &linear) { return FitRotation(linear.transpose()); }

} // namespace detail

/// SR-ARAP on a graph (Levi and Gotsman 2015; paper, Eqs. 2, 5 and 6 with the local step corrected: S_i sums
/// w_ij (e_ij e'_ij^T + alpha A R_j^T)). The systems are factorised at construction, and solved as often as wanted.
///
/// Constrained nodes are eliminated rows and columns. A component of the graph without one is not part of the system;
/// its nodes come back at rest.
class GraphDeformer {
  public:
    /// \param constrained k flags: the node's position is given, and its rotation with it
    /// \param turns k flags, or empty for none: of constrained nodes whose rotation is free \param area A, frame
    /// units^2 \throw Error when the system cannot be factorised
    GraphDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                  const std::vector<bool> &turns = {})
        : graph(graph), constrained(constrained), turns(turns), area(area) {
        const Index k = graph.Size();
        this->turns.resize(k, false);
        const Index components = ConnectedComponents(graph.graph.adjacency, componentOf);
        held.assign(components, false);
        for (Index i = 0; i < k; ++i)
            if (constrained[i])
                held[componentOf[i]] = true;
        unknownOf.assign(k, -1);
        for (Index i = 0; i < k; ++i)
            if (!constrained[i] && held[componentOf[i]]) {
                unknownOf[i] = Index(unknown.size());
                unknown.push_back(i);
            }
        turning = unknown;
        for (Index i = 0; i < k; ++i)
            if (constrained[i] && this->turns[i])
                turning.push_back(i);
        edge.resize(graph.weight.size());
        for (Index i = 0; i < k; ++i)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Eigen::Vector3d d =
                    graph.graph.position.col(i).cast<double>() - graph.graph.position.col(Neighbour(e)).cast<double>();
                edge[e] = graph.weight[e] * d;
                edgeLength += d.norm() / double(edge.size());
            }
        if (unknown.empty())
            return;
        std::vector<Eigen::Triplet<double>> free, known;
        for (Index i = 0; i < k; ++i) {
            if (!held[componentOf[i]])
                continue;
            double sum = 0;
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                sum += graph.weight[e];
                const Index j = Neighbour(e);
                if (unknownOf[j] >= 0)
                    free.emplace_back(i, unknownOf[j], -graph.weight[e]);
                else
                    known.emplace_back(i, j, -graph.weight[e]);
            }
            if (unknownOf[i] >= 0)
                free.emplace_back(i, unknownOf[i], sum);
            else
                known.emplace_back(i, i, sum);
        }
        const Index n = Index(unknown.size());
        // Columns of the Laplacian: those of the unknown nodes, and those of the constrained ones.
        Eigen::SparseMatrix<double> columns(k, n);
        columns.setFromTriplets(free.begin(), free.end());
        constrainedColumns.resize(k, k);
        constrainedColumns.setFromTriplets(known.begin(), known.end());
        std::vector<Eigen::Triplet<double>> square;
        for (const Eigen::Triplet<double> &t : free)
            if (unknownOf[t.row()] >= 0)
                square.emplace_back(unknownOf[t.row()], t.col(), t.value());
        Eigen::SparseMatrix<double> laplacian(n, n);
        laplacian.setFromTriplets(square.begin(), square.end());
        globalStep.compute(laplacian);
        // The bi-Laplacian joins all neighbours of a node with each other: where a node has thousands, the Laplacian is
        // good enough.
        double joined = 0;
        for (Index i = 0; i < k; ++i)
            joined += double(graph.graph.adjacency[i].size()) * double(graph.graph.adjacency[i].size());
        if (joined < 4e6 + 400.0 * k) {
            guessRows = columns.transpose();
        } else {
            guessRows.resize(n, k);
            for (Index u = 0; u < n; ++u)
                guessRows.insert(u, unknown[u]) = 1;
        }
        initialGuess.compute(Eigen::SparseMatrix<double>(guessRows * columns));
        if (globalStep.info() != Eigen::Success || initialGuess.info() != Eigen::Success)
            throw Error("The deformation graph's system cannot be factorised.");
    }

    /// Whether node \p i is in a component with a constrained node.
    bool IsHeld(Index i) const { return held[componentOf[i]]; }
    const std::vector<Index> &ComponentOf() const { return componentOf; }
    Index Components() const { return Index(held.size()); }
    Index LooseComponents() const { return Index(std::count(held.begin(), held.end(), false)); }

    /// \param motion k motions in frame units; those of unconstrained nodes are not read, and of those that turn the
    ///        rotation is only where the iteration begins
    GraphPose Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param,
                    const Progress &progress = {}) const {
        const Index k = graph.Size(), n = Index(unknown.size());
        const Eigen::Matrix3Xd rest = graph.graph.position.cast<double>();
        GraphPose pose;
        pose.position = rest;
        pose.linear.assign(k, Eigen::Matrix3d::Identity());
        std::vector<Eigen::Matrix3d> rotation(k, Eigen::Matrix3d::Identity());
        using Matrix34d = Eigen::Matrix<double, 3, 4>;
        Eigen::MatrixXd change = Eigen::MatrixXd::Zero(k, 12); // motion minus identity of the constrained nodes
        for (Index i = 0; i < k; ++i)
            if (constrained[i]) {
                pose.position.col(i) = motion[i] * Eigen::Vector3d(rest.col(i));
                pose.linear[i] = motion[i].linear();
                rotation[i] = detail::RotationOf(pose.linear[i]);
                const Matrix34d m = motion[i].matrix().topRows<3>() - Matrix34d::Identity();
                change.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 12>>(m.data());
            }
        if (turning.empty())
            return pose;

        // Initial guess: the motions' matrices, interpolated by the bi-Laplacian. One motion of all is met exactly.
        Eigen::MatrixXd guess;
        if (n > 0)
            guess = initialGuess.solve(-(guessRows * (constrainedColumns * change)));
        for (Index u = 0; u < n; ++u) {
            const Eigen::Matrix<double, 1, 12> row = guess.row(u);
            const Matrix34d m = Eigen::Map<const Matrix34d>(row.data()) + Matrix34d::Identity();
            pose.position.col(unknown[u]) = m * rest.col(unknown[u]).homogeneous();
            rotation[unknown[u]] = detail::RotationOf(m.leftCols<3>());
        }

        State state{std::move(pose.position), std::move(rotation), 0};
        const double smooth = param.smoothness * area;
        const double still = param.tolerance * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
        state.energy = Energy(state, pose.linear, smooth);
        Anderson anderson(12 * turning.size());
        State stepped = state, mixed = state;
        Eigen::VectorXd before(12 * turning.size()), after(12 * turning.size());
        Eigen::MatrixX3d right(n, 3);
        pose.converged = false;
        for (pose.iterations = 0; !pose.converged && pose.iterations < param.maxIterations; ++pose.iterations) {
            if ((pose.iterations & 15) == 0)
                progress(1 - std::exp(-4.0 * pose.iterations / param.maxIterations), "Deforming the graph");
            Step(state, pose.linear, smooth, stepped, right);
            double moved = 0;
            for (Index i : unknown)
                moved = std::max(moved, (stepped.position.col(i) - state.position.col(i)).squaredNorm());
            for (Index i : turning)
                if (constrained[i]) // the others' turn shows in how they move
                    moved = std::max(moved,
                                     (stepped.rotation[i] - state.rotation[i]).squaredNorm() * edgeLength * edgeLength);
            pose.converged = std::sqrt(moved) <= still;
            // Accelerated step, taken only where it is better than the plain one.
            Pack(state, before);
            Pack(stepped, after);
            anderson.Mix(before, after);
            Unpack(after, mixed);
            mixed.energy = Energy(mixed, pose.linear, smooth);
            std::swap(state, stepped);
            if (mixed.energy < state.energy)
                std::swap(state, mixed);
        }
        pose.position = std::move(state.position);
        pose.energy = state.energy;
        for (Index i : turning)
            pose.linear[i] = state.rotation[i];
        return pose;
    }

  private:
    std::uint32_t Begin(Index i) const { return graph.graph.adjacency.begin[i]; }
    Index Neighbour(std::uint32_t e) const { return graph.graph.adjacency.item[e]; }

    struct State {
        Eigen::Matrix3Xd position;             // 3 x k
        std::vector<Eigen::Matrix3d> rotation; // k
        double energy;
    };

    /// A node's linear part as its neighbours' edges see it: a constrained node's may scale.
    const Eigen::Matrix3d &Linear(const State &x, const std::vector<Eigen::Matrix3d> &linear, Index i) const {
        return constrained[i] && !turns[i] ? linear[i] : x.rotation[i];
    }

    /// One local and one global step. The energy cannot rise.
    void Step(const State &x, const std::vector<Eigen::Matrix3d> &linear, double smooth, State &y,
              Eigen::MatrixX3d &right) const {
        // Local step (Eq. 5), each rotation from its neighbours' latest.
        y.rotation = x.rotation;
        for (Index i : turning) {
            Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Index j = Neighbour(e);
                s += edge[e] * (x.position.col(i) - x.position.col(j)).transpose();
                s += (graph.weight[e] * smooth) * y.rotation[j].transpose();
            }
            y.rotation[i] = detail::FitRotation(s);
        }
        y.position = x.position;
        // Global step (Eq. 6).
        for (std::size_t u = 0; u < unknown.size(); ++u) {
            const Index i = unknown[u];
            Eigen::Vector3d b = Eigen::Vector3d::Zero(), own = Eigen::Vector3d::Zero();
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Index j = Neighbour(e);
                own += edge[e];
                b += Linear(y, linear, j) * edge[e];
                if (constrained[j])
                    b += (2 * graph.weight[e]) * x.position.col(j);
            }
            b += y.rotation[i] * own;
            right.row(u) = 0.5 * b.transpose();
        }
        if (!unknown.empty())
            right = globalStep.solve(right);
        for (std::size_t u = 0; u < unknown.size(); ++u)
            y.position.col(unknown[u]) = right.row(u).transpose();
        y.energy = Energy(y, linear, smooth);
    }

    /// Eq. 2, the smoothness of each pair of nodes counted once (so that Eq. 5 is its minimum).
    double Energy(const State &x, const std::vector<Eigen::Matrix3d> &linear, double smooth) const {
        double energy = 0;
        for (Index i = 0; i < graph.Size(); ++i) {
            if (!held[componentOf[i]])
                continue;
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Index j = Neighbour(e);
                const double w = graph.weight[e];
                energy +=
                    w * (x.position.col(i) - x.position.col(j) - Linear(x, linear, i) * (edge[e] / w)).squaredNorm();
                if (i < j)
                    energy += w * smooth * (x.rotation[i] - x.rotation[j]).squaredNorm();
            }
        }
        return energy;
    }

    /// The unknowns as one vector: positions, and rotations times the length of an edge, so that both weigh the same.
    void Pack(const State &x, Eigen::VectorXd &v) const {
        double *at = v.data();
        for (Index i : turning) {
            Eigen::Map<Eigen::Vector3d> p(at);
            p = x.position.col(i);
            Eigen::Map<Eigen::Matrix3d> r(at + 3);
            r = x.rotation[i] * edgeLength;
            at += 12;
        }
    }
    void Unpack(const Eigen::VectorXd &v, State &x) const {
        const double *at = v.data();
        for (Index i : turning) {
            if (!constrained[i])
                x.position.col(i) = Eigen::Map<const Eigen::Vector3d>(at);
            x.rotation[i] = detail::RotationOf(Eigen::Map<const Eigen::Matrix3d>(at + 3));
            at += 12;
        }
    }

    /// Anderson acceleration of a fixed-point iteration (Anderson 1965; for local-global solvers Peng et al. 2018).
    class Anderson {
      public:
        explicit Anderson(std::size_t size) : differenceF(size, depth), differenceG(size, depth), f(size), g(size) {}

        /// \param x where the iteration was \param gx in: where its step led; out: where to go on
        void Mix(const Eigen::VectorXd &x, Eigen::VectorXd &gx) {
            if (steps > 0) {
                const int column = (steps - 1) % depth;
                differenceF.col(column) = gx - x - f;
                differenceG.col(column) = gx - g;
            }
            f = gx - x;
            g = gx;
            const int used = std::min(steps, depth);
            ++steps;
            if (used == 0)
                return;
            const auto df = differenceF.leftCols(used);
            Eigen::MatrixXd gram = df.transpose() * df;
            gram.diagonal().array() += 1e-12 * gram.diagonal().maxCoeff() + 1e-300;
            const Eigen::VectorXd theta = gram.ldlt().solve(df.transpose() * f);
            if (theta.allFinite())
                gx -= differenceG.leftCols(used) * theta;
        }

      private:
        static constexpr int depth = 6;
        Eigen::MatrixXd differenceF, differenceG;
        Eigen::VectorXd f, g;
        int steps = 0;
    };

    const DeformationGraph &graph;
    std::vector<bool> constrained, turns, held;
    std::vector<Index> componentOf, unknownOf, unknown; // unknown positions
    std::vector<Index> turning;                         // unknown rotations
    double area;
    std::vector<Eigen::Vector3d> edge; // w_ij e_ij of each adjacency item
    double edgeLength = 0;             // mean
    Eigen::SparseMatrix<double> constrainedColumns, guessRows;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> globalStep, initialGuess;
};

/// Finds the nearest of some nodes.
class NodeTree {
  public:
    /// \param position 3 x n \param node which of them, at least one; the tree numbers them in this order
    NodeTree(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) : NodeTree(PointsOf(position, node)) {}

    static vcg::Point3f Point(const Eigen::Vector3f &p) { return vcg::Point3f(p[0], p[1], p[2]); }
    vcg::KdTree<float> *operator->() { return &tree; }

  private:
    explicit NodeTree(const std::vector<vcg::Point3f> &point)
        : tree(vcg::ConstDataWrapper<vcg::Point3f>(point.data(), int(point.size()))) {}

    static std::vector<vcg::Point3f> PointsOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) {
        std::vector<vcg::Point3f> point;
        for (Index i : node)
            point.push_back(Point(position.col(i)));
        return point;
    }

    vcg::KdTree<float> tree;
};

/// Gives the nodes of every component without a constrained node the rigid motion of the nearest node of a component
/// with one: a button follows the sleeve.
inline void FollowNearest(const DeformationGraph &graph, const GraphDeformer &deformer, GraphPose &pose) {
    std::vector<Index> nodeAt;
    for (Index i = 0; i < graph.Size(); ++i)
        if (deformer.IsHeld(i))
            nodeAt.push_back(i);
    if (nodeAt.empty() || Index(nodeAt.size()) == graph.Size())
        return;
    NodeTree tree(graph.graph.position, nodeAt);
    const std::vector<Index> &componentOf = deformer.ComponentOf();
    const Index components = deformer.Components();
    std::vector<float> nearest(components, std::numeric_limits<float>::infinity());
    std::vector<Index> leader(components, -1);
    for (Index i = 0; i < graph.Size(); ++i) {
        if (deformer.IsHeld(i))
            continue;
        unsigned found = 0;
        float d = 0;
        tree->doQueryClosest(tree.Point(graph.graph.position.col(i)), found, d);
        if (d < nearest[componentOf[i]]) {
            nearest[componentOf[i]] = d;
            leader[componentOf[i]] = nodeAt[found];
        }
    }
    for (Index i = 0; i < graph.Size(); ++i) {
        if (deformer.IsHeld(i))
            continue;
        const Index to = leader[componentOf[i]];
        pose.linear[i] = pose.linear[to];
        pose.position.col(i) =
            pose.position.col(to) +
            pose.linear[to] * (graph.graph.position.col(i) - graph.graph.position.col(to)).cast<double>();
    }
}

} // namespace fcd
} // namespace vcg

#endif
