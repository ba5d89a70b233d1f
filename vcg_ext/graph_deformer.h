// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_DEFORMER_H
#define VCG_FCD_GRAPH_DEFORMER_H

#include "deformation_graph.h"
#include "shape_constants.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <numeric>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace fcd {

/// How the graph is deformed (paper, sec. 2.2).
struct SolverParam {
    /// alpha of Eq. 2, >= 0: the higher, the more evenly bending and twist are spread. SR-ARAP as in CGAL has
    /// 0.02 A / 6 at each of the six edges of a regular triangulation, where the weights are 1 / sqrt(3).
    double smoothness = 0.0058;
    int maxIterations = 1000; ///< >= 0
    double tolerance = 1e-5;  ///< stop where no node is farther from rest than ten times this fraction of the diagonal
};

/// Where each node of a deformation graph went: x -> linear * (x - rest) + position.
struct GraphPose {
    Eigen::Matrix3Xd position;           ///< 3 x k, c'_j
    std::vector<Eigen::Matrix3d> linear; ///< k, R_j (see FitLinear); of a constrained node that of its motion
    double energy = 0;                   ///< Eq. 2, frame units^2
    std::vector<double> nodeEnergy;      ///< k, each node's share of it
    std::vector<char> rests;             ///< k flags: free nodes of parts that nothing moves; empty: not known
    int iterations = 0;
    bool converged = true;
};

namespace detail {

/// The unit quaternion (w, x, y, z) of a rotation, and the way back.
inline Eigen::Vector4d ToQuaternion(const Eigen::Matrix3d &rotation) {
    const Eigen::Quaterniond q(rotation);
    return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}
inline Eigen::Matrix3d ToMatrix(const Eigen::Vector4d &q) {
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

/// The rotation R that maximises tr(R S), as a unit quaternion (w, x, y, z).
///
/// The quaternion is the eigenvector of the largest eigenvalue of a symmetric, traceless 4 x 4 matrix (Davenport; Horn
/// 1987). The eigenvalue is the largest root of a quartic, found by Newton's method from above (Theobald 2005), the
/// eigenvector a column of the adjugate. Where the eigenvalue is close to double, the rotation is not unique and an SVD
/// chooses one.
/// \param near a unit quaternion; the closer, the fewer steps, but the result is the same to rounding
inline Eigen::Vector4d FitQuaternion(const Eigen::Matrix3d &unscaled,
                                     const Eigen::Vector4d &near = Eigen::Vector4d::UnitX()) {
    const double size = unscaled.cwiseAbs().maxCoeff();
    if (!(size > 0) || !std::isfinite(size))
        return Eigen::Vector4d::UnitX();
    const Eigen::Matrix3d s = unscaled * (1 / size);
    Eigen::Matrix4d k;
    k(0, 0) = s(0, 0) + s(1, 1) + s(2, 2);
    k(1, 1) = s(0, 0) - s(1, 1) - s(2, 2);
    k(2, 2) = s(1, 1) - s(0, 0) - s(2, 2);
    k(3, 3) = s(2, 2) - s(0, 0) - s(1, 1);
    k(0, 1) = k(1, 0) = s(1, 2) - s(2, 1);
    k(0, 2) = k(2, 0) = s(2, 0) - s(0, 2);
    k(0, 3) = k(3, 0) = s(0, 1) - s(1, 0);
    k(1, 2) = k(2, 1) = s(0, 1) + s(1, 0);
    k(1, 3) = k(3, 1) = s(2, 0) + s(0, 2);
    k(2, 3) = k(3, 2) = s(1, 2) + s(2, 1);
    const double norm2 = s.squaredNorm(), c2 = -2 * norm2, c1 = -8 * s.determinant(), c0 = k.determinant();
    const auto slope = [&](double x) { return (4 * x * x + 2 * c2) * x + c1; };
    const auto value = [&](double x) { return (x * x + c2) * x * x + c1 * x + c0; };
    // The Rayleigh quotient lies below the root. Where the quartic is convex and rises, a step from there leads above
    // it.
    double lambda = near.dot(k * near);
    if (lambda > 0 && 3 * lambda * lambda > norm2 && slope(lambda) > 0.1 * norm2 * lambda)
        lambda -= value(lambda) / slope(lambda);
    else
        lambda = std::sqrt(3 * norm2);
    for (int i = 0; i < 50 && value(lambda) > 1e-14 * norm2 * norm2; ++i) // up to rounding
        lambda -= value(lambda) / slope(lambda);

    k.diagonal().array() -= lambda;
    const auto adjugate = [&](int column) {
        const int i = (column + 1) & 3, j = (column + 2) & 3, l = (column + 3) & 3;
        const double m01 = k(i, 0) * k(j, 1) - k(i, 1) * k(j, 0), m02 = k(i, 0) * k(j, 2) - k(i, 2) * k(j, 0),
                     m03 = k(i, 0) * k(j, 3) - k(i, 3) * k(j, 0), m12 = k(i, 1) * k(j, 2) - k(i, 2) * k(j, 1),
                     m13 = k(i, 1) * k(j, 3) - k(i, 3) * k(j, 1), m23 = k(i, 2) * k(j, 3) - k(i, 3) * k(j, 2);
        return Eigen::Vector4d(
            k(l, 1) * m23 - k(l, 2) * m13 + k(l, 3) * m12, k(l, 2) * m03 - k(l, 0) * m23 - k(l, 3) * m02,
            k(l, 0) * m13 - k(l, 1) * m03 + k(l, 3) * m01, k(l, 1) * m02 - k(l, 0) * m12 - k(l, 2) * m01);
    };
    // All columns are multiples of the quaternion; that of its largest component is the longest.
    int column;
    near.cwiseAbs().maxCoeff(&column);
    Eigen::Vector4d q = adjugate(column);
    for (int other = 0; other < 4 && 2 * std::abs(q[column]) < q.norm(); ++other) {
        const Eigen::Vector4d candidate = adjugate(other);
        if (candidate.squaredNorm() > q.squaredNorm()) {
            q = candidate;
            column = other;
        }
    }
    const double length2 = q.squaredNorm();
    if (!(length2 >= 1e-9 * norm2 * norm2 * norm2)) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d u = svd.matrixU();
        if ((svd.matrixV() * u.transpose()).determinant() < 0)
            u.col(2) *= -1; // singular values are sorted: the smallest is the last
        return ToQuaternion(svd.matrixV() * u.transpose());
    }
    return q / std::sqrt(length2);
}

/// The rotation R that maximises tr(R S).
inline Eigen::Matrix3d FitRotation(const Eigen::Matrix3d &s) { return ToMatrix(FitQuaternion(s)); }

/// The rotation part of a linear map with a positive determinant.
inline Eigen::Matrix3d RotationOf(const Eigen::Matrix3d &linear) { return FitRotation(linear.transpose()); }

} // namespace detail

/// SR-ARAP on a graph (Levi and Gotsman 2015; paper, Eqs. 2, 5 and 6 with the local step corrected: S_i sums
/// w_ij (e_ij e'_ij^T + alpha A R_j^T)). The systems are factorised at construction, and solved as often as wanted.
///
/// Constrained nodes are eliminated rows and columns. Edges between a held and a free patch end at their border, where
/// the held patch's motion begins; its rotation is an unknown as that of a free node, held by the region behind it. A
/// component of the graph without a constrained node is not part of the system; its nodes come back at rest.
class GraphDeformer {
  public:
    /// \param constrained k flags: the node's position is given, and its rotation with it
    /// \param area A, frame units^2
    /// \param turns k flags, or empty for none: of constrained nodes whose rotation is free
    /// \param heldArea k values, or empty for 0: of constrained nodes that turn, the area of what is held behind them,
    ///        frame units^2, infinite for a region that goes on
    /// \param heldDepth as in ShapeConstants
    /// \throw Error when the system cannot be factorised
    GraphDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                  const std::vector<bool> &turns = {}, const std::vector<double> &heldArea = {},
                  double heldDepth = ShapeConstants().heldDepth)
        : graph(graph), constrained(constrained.begin(), constrained.end()), turns(turns.begin(), turns.end()),
          area(area), heldArea(heldArea), heldDepth(heldDepth) {
        const Index k = graph.Size();
        this->turns.resize(k, false);
        this->heldArea.resize(k, 0);
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
        stay.assign(k, 0);
        for (Index i = 0; i < k; ++i)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e) {
                const Eigen::Vector3d d = graph.edge.col(e).cast<double>();
                stay[i] += 1e-6 * graph.weight[e] * d.squaredNorm();
                edge[e] = graph.weight[e] * d;
                edgeLength += d.norm() / double(edge.size());
            }
        for (double &s : stay)
            if (!(s > 0)) // without edges, all is left open
                s = 1;
        for (Index i = 0; i < k; ++i)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                if (i < Neighbour(e) && held[componentOf[i]])
                    pairs.push_back({i, Neighbour(e), e});
        openPairs = std::size_t(std::stable_partition(pairs.begin(), pairs.end(),
                                                      [&](const Pair &p) { return !IsTurned(p.i) || !IsTurned(p.j); }) -
                                pairs.begin());
        sumOfEdges.assign(unknown.size(), Eigen::Vector3d::Zero());
        for (Index i : unknown)
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                sumOfEdges[unknownOf[i]] += edge[e];
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
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> globalStep(laplacian);
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
        factor = globalStep.matrixL().nestedExpression();
        inverseDiagonal = globalStep.vectorD().cwiseInverse();
        order.assign(globalStep.permutationP().indices().data(), globalStep.permutationP().indices().data() + n);
    }

    /// Whether node \p i is in a component with a constrained node.
    bool IsHeld(Index i) const { return held[componentOf[i]]; }
    /// Whether the rotation of node \p i is given.
    bool IsTurned(Index i) const { return constrained[i] && !turns[i]; }
    Index Components() const { return Index(held.size()); }
    Index LooseComponents() const { return Index(std::count(held.begin(), held.end(), false)); }

    /// \param motion k motions in frame units; those of unconstrained nodes are not read, and of those that turn the
    ///        rotation is only where the iteration begins
    /// \param last a pose of this graph to go on from, such as the last one of an animation, so that the shape changes
    /// as
    ///        steadily as the motions do; null to begin at rest
    /// \param lastMotion k, the motions of that pose; not read without it
    GraphPose Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param, const Progress &progress = {},
                    const GraphPose *last = nullptr, const std::vector<Eigen::Affine3d> &lastMotion = {}) const {
        const Index k = graph.Size(), n = Index(unknown.size());
        const Eigen::Matrix3Xd rest = graph.graph.position.cast<double>();
        GraphPose pose;
        pose.position = rest;
        pose.linear.assign(k, Eigen::Matrix3d::Identity());
        pose.nodeEnergy.assign(k, 0);
        std::vector<Eigen::Matrix3d> rotation(k, Eigen::Matrix3d::Identity());
        Eigen::Matrix3Xd before = rest; // where the motions below begin
        using Matrix34d = Eigen::Matrix<double, 3, 4>;
        // What the motions of the constrained nodes differ by from that of the first one. Without that, what they have
        // in common would be as inexact as the solution where a node hardly hangs on the others.
        Eigen::MatrixXd change = Eigen::MatrixXd::Zero(k, 12);
        Matrix34d common = Matrix34d::Identity();
        bool isFirst = true;
        if (last) {
            before = last->position;
            for (Index i = 0; i < k; ++i)
                rotation[i] = detail::RotationOf(last->linear[i]);
        }
        for (Index i = 0; i < k; ++i)
            if (constrained[i]) {
                pose.position.col(i) = motion[i] * Eigen::Vector3d(rest.col(i));
                pose.linear[i] = motion[i].linear();
                const Eigen::Affine3d way = last ? motion[i] * lastMotion[i].inverse() : motion[i];
                rotation[i] = last && turns[i] ? Eigen::Matrix3d(detail::RotationOf(way.linear()) * rotation[i])
                                               : detail::RotationOf(pose.linear[i]);
                if (isFirst)
                    common = way.matrix().topRows<3>();
                isFirst = false;
                const Matrix34d m = way.matrix().topRows<3>() - common;
                change.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 12>>(m.data());
            }
        if (turning.empty())
            return pose;

        // Initial guess: the matrices of the motions since the last pose, interpolated by the bi-Laplacian. One motion
        // of all is met exactly.
        Eigen::MatrixXd guess;
        if (n > 0)
            guess = initialGuess.solve(-(guessRows * (constrainedColumns * change)));
        for (Index u = 0; u < n; ++u) {
            const Eigen::Matrix<double, 1, 12> row = guess.row(u);
            const Matrix34d m = Eigen::Map<const Matrix34d>(row.data()) + common;
            pose.position.col(unknown[u]) = m * before.col(unknown[u]).homogeneous();
            const Eigen::Matrix3d turn = detail::RotationOf(m.leftCols<3>());
            rotation[unknown[u]] = last ? Eigen::Matrix3d(turn * rotation[unknown[u]]) : turn;
        }

        State state{std::move(pose.position), std::move(rotation), {}, 0};
        for (const Eigen::Matrix3d &r : state.rotation)
            state.quaternion.push_back(detail::ToQuaternion(r));
        const Given given(*this, motion, state, param.smoothness * area);
        // A step that is rho times the one before it is followed by 1 / (1 - rho) times as much in all.
        const double still = 10 * param.tolerance * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
        state.energy = Energy(state, given);
        State stepped = state, mixed = state;
        const std::size_t size = 3 * unknown.size() + 4 * turning.size();
        Anderson anderson(size);
        Eigen::VectorXd here(size), after(size);
        Work work{std::vector<Eigen::Matrix3d>(k), Eigen::Matrix3Xd(3, n)};
        pose.converged = false;
        for (pose.iterations = 0; !pose.converged && pose.iterations < param.maxIterations; ++pose.iterations) {
            if ((pose.iterations & 15) == 0)
                progress(1 - std::exp(-4.0 * pose.iterations / param.maxIterations), "Deforming the graph");
            Step(state, given, stepped, work);
            double moved = 0;
            for (Index i : unknown)
                moved = std::max(moved, (stepped.position.col(i) - state.position.col(i)).squaredNorm());
            for (Index i : turning)
                if (constrained[i]) // the others' turn shows in how they move
                    moved = std::max(moved,
                                     (stepped.rotation[i] - state.rotation[i]).squaredNorm() * edgeLength * edgeLength);
            // Accelerated step, where it lowers the energy; the plain one always does.
            Pack(state, here);
            Pack(stepped, after);
            anderson.Mix(here, after);
            pose.converged = moved == 0 || std::sqrt(moved) <= (1 - anderson.Contraction()) * still;
            Unpack(after, mixed);
            mixed.energy = Energy(mixed, given);
            if (mixed.energy < state.energy) {
                std::swap(state, mixed);
            } else {
                std::swap(state, stepped);
                state.energy = Energy(state, given);
            }
        }
        for (const Pair &p : pairs) {
            const Eigen::Vector2d share = PairEnergy(p, state, given);
            pose.nodeEnergy[p.i] += share[0];
            pose.nodeEnergy[p.j] += share[1];
        }
        for (Index i : turning)
            pose.nodeEnergy[i] += HoldEnergy(i, state, given);
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
        Eigen::Matrix3Xd position;               // 3 x k
        std::vector<Eigen::Matrix3d> rotation;   // k
        std::vector<Eigen::Vector4d> quaternion; // k, of the rotations
        double energy;
    };

    /// What a pose gives.
    struct Given {
        double smooth;                       // alpha A
        std::vector<Eigen::Matrix3d> anchor; // k, of held nodes that turn: the rotation of what holds them
        std::vector<Eigen::Vector4d> anchorQuaternion;
        std::vector<double> hold;            // k, how strongly it holds: the w of Eq. 2
        std::vector<Eigen::Matrix3d> linear; // k, of nodes whose rotation is given; may scale
        std::vector<Eigen::Vector3d> from; // the ends of each adjacency item's edge, where constrained nodes hold them
        std::vector<Eigen::Vector3d> to;
        Eigen::MatrixX3d right; // of the global step: what the constrained ends contribute
        double energy = 0;      // of the edges between nodes whose rotations are given

        Given(const GraphDeformer &d, const std::vector<Eigen::Affine3d> &motion, const State &x, double smooth)
            : smooth(smooth), linear(motion.size()), from(d.edge.size()), to(d.edge.size()),
              right(Eigen::MatrixX3d::Zero(Eigen::Index(d.unknown.size()), 3)) {
            const double depth = std::sqrt(d.heldDepth * smooth);
            anchor = x.rotation;
            anchorQuaternion = x.quaternion;
            hold.assign(d.graph.Size(), 0);
            for (Index i = 0; i < d.graph.Size(); ++i) {
                if (!d.turns[i] || !(d.heldArea[i] > 0) || !(depth > 0))
                    continue;
                anchor[i] = detail::RotationOf(motion[i].linear());
                anchorQuaternion[i] = detail::ToQuaternion(anchor[i]);
                double border = 0;
                for (std::uint32_t e = d.Begin(i); e < d.Begin(i + 1); ++e)
                    border += d.graph.weight[e] * d.graph.edge.col(e).norm();
                hold[i] = std::min(border / depth, d.heldArea[i] / (depth * depth));
            }
            const auto rest = [&](Index i) { return d.graph.graph.position.col(i).template cast<double>(); };
            for (Index i = 0; i < d.graph.Size(); ++i) {
                linear[i] = motion[i].linear();
                for (std::uint32_t e = d.Begin(i); e < d.Begin(i + 1); ++e) {
                    const Index j = d.Neighbour(e);
                    const Eigen::Vector3d way = d.graph.edge.col(e).cast<double>();
                    from[e] = d.graph.IsHeld(i) ? Eigen::Vector3d(motion[i] * (rest(j) + way))
                                                : Eigen::Vector3d(x.position.col(i));
                    to[e] = d.graph.IsHeld(j) ? Eigen::Vector3d(motion[j] * (rest(i) - way))
                                              : Eigen::Vector3d(x.position.col(j));
                    if (d.unknownOf[i] >= 0 && d.constrained[j])
                        right.row(d.unknownOf[i]) += d.graph.weight[e] * to[e].transpose();
                }
            }
            for (std::size_t p = d.openPairs; p < d.pairs.size(); ++p)
                energy += d.PairEnergy(d.pairs[p], x, *this).sum();
        }
    };

    /// An edge of the graph, once.
    struct Pair {
        Index i, j;
        std::uint32_t e; // from j to i
    };

    /// From the second to the first end of a pair.
    Eigen::Vector3d Way(const Pair &p, const State &x, const Given &given) const {
        return (constrained[p.i] ? given.from[p.e] : Eigen::Vector3d(x.position.col(p.i))) -
               (constrained[p.j] ? given.to[p.e] : Eigen::Vector3d(x.position.col(p.j)));
    }
    /// A node's linear part as its neighbours' edges see it.
    const Eigen::Matrix3d &Linear(const State &x, const Given &given, Index i) const {
        return IsTurned(i) ? given.linear[i] : x.rotation[i];
    }

    struct Work {
        std::vector<Eigen::Matrix3d> s; // k, of Eq. 5
        Eigen::Matrix3Xd solved;        // of Eq. 6: a column per unknown in the order of the factorisation
    };

    /// The global step's solution in place of its right side: what the factorisation's solve() does, for all three
    /// coordinates at once and without an allocation.
    void SolveGlobal(Work &work) const {
        Eigen::Matrix3Xd &x = work.solved;
        for (Eigen::Index c = 0; c < x.cols(); ++c) {
            const Eigen::Vector3d xc = x.col(c);
            for (Eigen::SparseMatrix<double>::InnerIterator l(factor, c); l; ++l)
                x.col(l.row()) -= l.value() * xc;
        }
        for (Eigen::Index c = x.cols(); c-- > 0;) {
            Eigen::Vector3d xc = x.col(c) * inverseDiagonal[c];
            for (Eigen::SparseMatrix<double>::InnerIterator l(factor, c); l; ++l)
                xc -= l.value() * x.col(l.row());
            x.col(c) = xc;
        }
    }

    /// One local and one global step. The energy cannot rise.
    void Step(const State &x, const Given &given, State &y, Work &work) const {
        // Local step (Eq. 5), each rotation from its neighbours' latest.
        for (Eigen::Matrix3d &s : work.s)
            s.setZero();
        for (std::size_t n = 0; n < openPairs; ++n) {
            const Pair &p = pairs[n];
            const Eigen::Matrix3d s = edge[p.e] * Way(p, x, given).transpose();
            work.s[p.i] += s;
            work.s[p.j] += s;
        }
        y.rotation = x.rotation;
        for (Index i : turning) {
            Eigen::Matrix3d neighbours = Eigen::Matrix3d::Zero();
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                neighbours += double(graph.weight[e]) * y.rotation[Neighbour(e)];
            neighbours += given.hold[i] * given.anchor[i];
            const Eigen::Matrix3d s =
                work.s[i] + given.smooth * neighbours.transpose() + stay[i] * x.rotation[i].transpose();
            const Eigen::Vector4d q = detail::FitQuaternion(s, x.quaternion[i]);
            y.quaternion[i] = q.dot(x.quaternion[i]) < 0 ? Eigen::Vector4d(-q) : q;
            y.rotation[i] = detail::ToMatrix(q);
        }
        // Global step (Eq. 6).
        for (std::size_t u = 0; u < unknown.size(); ++u) {
            const Index i = unknown[u];
            Eigen::Vector3d b = y.rotation[i] * sumOfEdges[u];
            for (std::uint32_t e = Begin(i); e < Begin(i + 1); ++e)
                b += Linear(y, given, Neighbour(e)) * edge[e];
            work.solved.col(order[u]) = given.right.row(u).transpose() + 0.5 * b;
        }
        SolveGlobal(work);
        for (std::size_t u = 0; u < unknown.size(); ++u)
            y.position.col(unknown[u]) = work.solved.col(order[u]);
    }

    /// The terms of Eq. 2 at both ends of an edge, the smoothness counted once (so that Eq. 5 is the minimum).
    Eigen::Vector2d PairEnergy(const Pair &p, const State &x, const Given &given) const {
        const Eigen::Vector3d rest = graph.edge.col(p.e).cast<double>(), way = Way(p, x, given);
        const double cosine = x.quaternion[p.i].dot(x.quaternion[p.j]); // |R_i - R_j|^2 = 8 (1 - cosine^2)
        const double smooth = 4 * graph.weight[p.e] * given.smooth * std::max(0.0, 1 - cosine * cosine);
        return {graph.weight[p.e] * (way - Linear(x, given, p.i) * rest).squaredNorm() + smooth,
                graph.weight[p.e] * (way - Linear(x, given, p.j) * rest).squaredNorm() + smooth};
    }

    /// The term of what holds the rotation of a node that turns.
    static double HoldEnergy(Index i, const State &x, const Given &given) {
        if (!(given.hold[i] > 0))
            return 0;
        const double cosine = x.quaternion[i].dot(given.anchorQuaternion[i]);
        return 8 * given.hold[i] * given.smooth * std::max(0.0, 1 - cosine * cosine);
    }

    /// Eq. 2.
    double Energy(const State &x, const Given &given) const {
        double energy = given.energy;
        for (std::size_t p = 0; p < openPairs; ++p)
            energy += PairEnergy(pairs[p], x, given).sum();
        for (Index i : turning)
            energy += HoldEnergy(i, x, given);
        return energy;
    }

    /// The unknowns as one vector: positions, and quaternions times twice the length of an edge, so that both weigh
    /// about the same.
    void Pack(const State &x, Eigen::VectorXd &v) const {
        double *at = v.data();
        for (Index i : unknown) {
            Eigen::Map<Eigen::Vector3d> p(at);
            p = x.position.col(i);
            at += 3;
        }
        for (Index i : turning) {
            Eigen::Map<Eigen::Vector4d> r(at);
            r = x.quaternion[i] * (2 * edgeLength);
            at += 4;
        }
    }
    void Unpack(const Eigen::VectorXd &v, State &x) const {
        const double *at = v.data();
        for (Index i : unknown) {
            x.position.col(i) = Eigen::Map<const Eigen::Vector3d>(at);
            at += 3;
        }
        for (Index i : turning) {
            x.quaternion[i] = Eigen::Map<const Eigen::Vector4d>(at).stableNormalized();
            x.rotation[i] = detail::ToMatrix(x.quaternion[i]);
            at += 4;
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
                const double before = (differenceG.col(column) - differenceF.col(column)).norm();
                contraction[column] = before > 0 ? differenceG.col(column).norm() / before : 0;
            }
            f = gx - x;
            g = gx;
            const int used = std::min(steps, depth);
            ++steps;
            if (used == 0)
                return;
            const int last = (steps - 2) % depth;
            Small right(used);
            for (int c = 0; c < used; ++c) {
                gram(c, last) = gram(last, c) = differenceF.col(c).dot(differenceF.col(last));
                right[c] = differenceF.col(c).dot(f);
            }
            Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, depth, depth> system =
                gram.topLeftCorner(used, used);
            system.diagonal().array() += 1e-12 * system.diagonal().maxCoeff() + 1e-300;
            const Small theta = system.ldlt().solve(right);
            if (theta.allFinite())
                for (int c = 0; c < used; ++c)
                    gx -= theta[c] * differenceG.col(c);
        }

        /// The largest factor by which the last steps shrank what was between two of them; 1 before there are any.
        double Contraction() const {
            const int used = std::min(steps - 1, depth);
            return used < 2 ? 1 : std::min(1.0, *std::max_element(contraction, contraction + used));
        }

      private:
        static constexpr int depth = 6;
        using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, depth, 1>;
        Eigen::MatrixXd differenceF, differenceG;
        Eigen::Matrix<double, depth, depth> gram = Eigen::Matrix<double, depth, depth>::Zero();
        Eigen::VectorXd f, g;
        double contraction[depth] = {};
        int steps = 0;
    };

    const DeformationGraph &graph;
    std::vector<char> constrained, turns, held;         // flags
    std::vector<Index> componentOf, unknownOf, unknown; // unknown positions
    std::vector<Index> turning;                         // unknown rotations
    double area;
    std::vector<double> heldArea; // k
    std::vector<double> stay;     // k, how strongly a rotation stays where its edges leave it open
    double heldDepth;
    std::vector<Eigen::Vector3d> edge;       // w_ij e_ij of each adjacency item
    std::vector<Eigen::Vector3d> sumOfEdges; // of each unknown node
    std::vector<Pair> pairs;                 // the edges of components that are held
    Eigen::SparseMatrix<double> factor;      // L of the global step below its unit diagonal
    Eigen::VectorXd inverseDiagonal;         // 1 / D of it
    std::vector<Index> order;                // of each unknown in it
    std::size_t openPairs = 0;               // those that depend on the unknowns; they come first
    double edgeLength = 0;                   // mean
    Eigen::SparseMatrix<double> constrainedColumns, guessRows;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> initialGuess;
};

/// Replaces the rotations of \p pose by the linear maps that fit the edges of the graph best, in the least-squares
/// sense; what the edges leave open (across the surface) stays as the rotation has it. The surface then stretches as
/// the graph does instead of in steps from node to node. Rotations that are given stay.
/// \param given k flags: nodes whose rotation is given
/// \param openness as in ShapeConstants
inline void FitLinear(const DeformationGraph &graph, const std::vector<bool> &given, GraphPose &pose,
                      double openness = ShapeConstants().openness) {
    for (Index i = 0; i < graph.Size(); ++i) {
        if (given[i])
            continue;
        Eigen::Matrix3d rest = Eigen::Matrix3d::Zero(), posed = Eigen::Matrix3d::Zero();
        for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = graph.graph.adjacency.item[e];
            const Eigen::Vector3d way = (graph.graph.position.col(i) - graph.graph.position.col(j)).cast<double>();
            rest += graph.weight[e] * way * way.transpose();
            posed += graph.weight[e] * (pose.position.col(i) - pose.position.col(j)) * way.transpose();
        }
        const double weight = openness * rest.trace();
        rest.diagonal().array() += weight;
        posed += weight * pose.linear[i];
        const Eigen::Matrix3d fitted = posed * rest.inverse();
        if (fitted.allFinite())
            pose.linear[i] = fitted;
    }
}

/// Finds the nearest of some nodes.
class NodeTree {
  public:
    /// \param position 3 x n \param node which of them, at least one; the tree numbers them in this order
    NodeTree(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) : NodeTree(PointsOf(position, node)) {}
    /// Of all nodes.
    explicit NodeTree(const Eigen::Matrix3Xf &position) : NodeTree(position, All(Index(position.cols()))) {}

    static vcg::Point3f Point(const Eigen::Vector3f &p) { return vcg::Point3f(p[0], p[1], p[2]); }
    vcg::KdTree<float> *operator->() { return &tree; }

  private:
    explicit NodeTree(const std::vector<vcg::Point3f> &point)
        : tree(vcg::ConstDataWrapper<vcg::Point3f>(point.data(), int(point.size()))) {}

    static std::vector<Index> All(Index n) {
        std::vector<Index> all(n);
        std::iota(all.begin(), all.end(), 0);
        return all;
    }

    static std::vector<vcg::Point3f> PointsOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) {
        std::vector<vcg::Point3f> point;
        point.reserve(node.size());
        for (Index i : node)
            point.push_back(Point(position.col(i)));
        return point;
    }

    vcg::KdTree<float> tree;
};

} // namespace fcd
} // namespace vcg

#endif
