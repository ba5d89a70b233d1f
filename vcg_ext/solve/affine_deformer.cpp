// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/graph/common_motion.h>
#include <vcg_ext/solve/affine_deformer.h>
#include <vcg_ext/solve/anderson.h>
#include <vcg_ext/solve/initial_guess.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace vcg::fcd {

namespace {

// Weight of the term that draws each map to the common motion of the handles, over that of its stretch. It decides only
// what the other terms leave open: how a plane moves across itself, or the whole map if handles are few. The softest
// bend costs 10^5 times as much.
constexpr double leastStay = 1e-7;

constexpr const char *stage = "Deforming the graph";

} // namespace

AffineDeformer::AffineDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                               const std::vector<bool> &compliant, const std::vector<double> &heldArea,
                               double heldDepth, const SolverParam &solver, const Progress &progress)
    : graph(graph), smooth(solver.smoothness * area), rigidity(solver.rigidity / (1 - solver.rigidity)),
      unknown(graph.graph.adjacency, constrained, compliant), energy(graph, unknown, heldArea, heldDepth) {
    const Index k = graph.Size();
    for (Eigen::Index e = 0; e < graph.edge.cols(); ++e)
        edgeLength += graph.edge.col(e).cast<double>().norm() / double(graph.edge.cols());
    for (Index i = 0; i < k; ++i) {
        const double turning = energy.TurningMass(i);
        mass.push_back(turning > 0 ? turning : 1); // without edges, all is left open
    }
    if (unknown.rotation.empty())
        return;
    const std::vector<Eigen::Affine3d> still(std::size_t(k), Eigen::Affine3d::Identity());
    const Eigen::Affine3d common = Eigen::Affine3d::Identity();
    Factorise(PoseTerms(energy, still, Base(still, common), smooth), progress.Slice(0, 0.8));
    if (rigidity > 0)
        laplacian.emplace(graph, unknown, progress.Slice(0.8, 1));
}

/// Calls stretch(i, j, e, end, weight) for both ends of each edge, |x_i - x_j - A_end e|^2, and bend(i, j, weight) for
/// each, |A_i - A_j|^2; e is the adjacency item from j to i.
template <class Stretch, class Bend>
void AffineDeformer::ForTerms(const Stretch &stretch, const Bend &bend) const {
    const Csr &adjacency = graph.graph.adjacency;
    for (Index i = 0; i < graph.Size(); ++i)
        for (std::uint32_t e = adjacency.begin[std::size_t(i)]; e < adjacency.begin[std::size_t(i) + 1]; ++e) {
            const Index j = adjacency.item[e];
            if (j <= i || !unknown.HasConstraint(i))
                continue;
            const double w = double(graph.weight[e]);
            stretch(i, j, e, i, w);
            stretch(i, j, e, j, w);
            bend(i, j, smooth * w);
        }
}

/// The coefficients of node \p i's four unknowns (per coordinate) in x_i - x_j - A_end e. \param sign 1 for i, -1 for j
Eigen::Vector4d AffineDeformer::Coefficients(Index i, Index end, double sign, const Eigen::Vector3d &restEdge) const {
    Eigen::Vector4d c = Eigen::Vector4d::Zero();
    c[0] = unknown.constrained[std::size_t(i)] ? 0 : sign;
    if (i == end)
        c.tail<3>() = -restEdge;
    return c;
}

void AffineDeformer::Factorise(const PoseTerms &poseTerms, const Progress &progress) {
    using Block = Eigen::Matrix4d;
    detail::BlockMatrix<4> matrix;
    matrix.diagonal.assign(unknown.rotation.size(), Block::Zero());
    Block both = Block::Zero();
    ForTerms(
        [&](Index i, Index j, std::uint32_t e, Index end, double w) {
            const Eigen::Vector3d restEdge = graph.edge.col(e).cast<double>();
            const Eigen::Vector4d c[2] = {Coefficients(i, end, 1, restEdge), Coefficients(j, end, -1, restEdge)};
            for (int n = 0; n < 2; ++n)
                if (const Index b = unknown.turnOf[std::size_t(n == 0 ? i : j)]; b >= 0)
                    matrix.diagonal[std::size_t(b)] += w * c[n] * c[n].transpose();
            both += w * c[0] * c[1].transpose();
        },
        [&](Index i, Index j, double w) {
            const Index a = unknown.turnOf[std::size_t(i)], b = unknown.turnOf[std::size_t(j)];
            for (Index each : {a, b})
                if (each >= 0)
                    matrix.diagonal[std::size_t(each)].diagonal().tail<3>().array() += w;
            both.diagonal().tail<3>().array() -= w;
            if (a >= 0 && b >= 0) {
                matrix.where.emplace_back(a, b);
                matrix.beside.push_back(both);
            }
            both.setZero();
        });
    for (std::size_t b = 0; b < unknown.rotation.size(); ++b) {
        const auto i = std::size_t(unknown.rotation[b]);
        matrix.diagonal[b].diagonal().tail<3>().array() +=
            poseTerms.stiffness[i] * smooth + (rigidity + leastStay) * mass[i];
        if (unknown.constrained[i])
            matrix.diagonal[b](0, 0) = 1; // its position is given
    }
    if (!factor.Analyse(matrix, detail::SparseFactor::most))
        throw Unsolvable("The deformation graph of " + std::to_string(graph.Size()) +
                         " nodes takes minutes to solve with a rigidity below 1. Take fewer patches, or a rigidity of "
                         "1.");
    if (!factor.Factorise(matrix, progress, stage) || factor.Negative() > 0)
        throw Unsolvable("The deformation graph's system cannot be factorised with a rigidity below 1. Take a "
                         "smoothness nearer to its default.");
}

/// The state with each node moved by \p common, and constrained ones by their motions.
detail::GraphEnergy::State AffineDeformer::Base(const std::vector<Eigen::Affine3d> &motion,
                                                const Eigen::Affine3d &common) const {
    const Index k = graph.Size();
    State x{graph.graph.position.cast<double>(),
            std::vector<Eigen::Matrix3d>(std::size_t(k), Eigen::Matrix3d::Identity()),
            std::vector<Eigen::Vector4d>(std::size_t(k), Eigen::Vector4d::UnitX()), 0};
    for (Index i = 0; i < k; ++i) {
        if (!unknown.HasConstraint(i))
            continue;
        const Eigen::Affine3d &given = unknown.constrained[std::size_t(i)] ? motion[std::size_t(i)] : common;
        x.position.col(i) = given * Eigen::Vector3d(x.position.col(i));
        x.rotation[std::size_t(i)] = (unknown.IsRotationGiven(i) ? given : common).linear();
    }
    return x;
}

/// From node j to i, or where their edge ends; \p e is the adjacency item from j to i.
Eigen::Vector3d AffineDeformer::PosedEdge(const State &x, const PoseTerms &poseTerms, Index i, Index j,
                                          std::uint32_t e) const {
    return (unknown.constrained[std::size_t(i)] ? poseTerms.from[e] : Eigen::Vector3d(x.position.col(i))) -
           (unknown.constrained[std::size_t(j)] ? poseTerms.to[e] : Eigen::Vector3d(x.position.col(j)));
}

/// The right side of the system for the change of the unknowns from \p base, without the term of the rigidity.
Eigen::MatrixX3d AffineDeformer::RightSide(const State &base, const PoseTerms &poseTerms) const {
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(4 * Eigen::Index(unknown.rotation.size()), 3);
    const auto turn = [&](Index i, const Eigen::Matrix3d &by) {
        if (unknown.turnOf[std::size_t(i)] >= 0)
            right.middleRows<3>(RowOf(i) + 1) += by.transpose();
    };
    ForTerms(
        [&](Index i, Index j, std::uint32_t e, Index end, double w) {
            const Eigen::Vector3d restEdge = graph.edge.col(e).cast<double>(),
                                  off = w * (PosedEdge(base, poseTerms, i, j, e) -
                                             base.rotation[std::size_t(end)] * restEdge);
            for (Index each : {i, j})
                if (unknown.turnOf[std::size_t(each)] >= 0)
                    right.middleRows<4>(RowOf(each)) -=
                        Coefficients(each, end, each == i ? 1 : -1, restEdge) * off.transpose();
        },
        [&](Index i, Index j, double w) {
            const Eigen::Matrix3d off = w * (base.rotation[std::size_t(i)] - base.rotation[std::size_t(j)]);
            turn(i, -off);
            turn(j, off);
        });
    for (Index i : unknown.rotation)
        turn(i, poseTerms.stiffness[std::size_t(i)] * smooth *
                    (poseTerms.linear[std::size_t(i)] - base.rotation[std::size_t(i)]));
    return right;
}

/// The global step: sets \p x to \p base and the change that solves the system.
void AffineDeformer::Solved(const State &base, const Eigen::MatrixX3d &right, State &x) const {
    const Eigen::MatrixX3d change = factor.Solve(right);
    for (Index i : unknown.rotation)
        x.rotation[std::size_t(i)] = base.rotation[std::size_t(i)] + change.middleRows<3>(RowOf(i) + 1).transpose();
    for (Index i : unknown.position)
        x.position.col(i) = base.position.col(i) + change.row(RowOf(i)).transpose();
}

/// The local step.
void AffineDeformer::FitRotations(State &x) const {
    for (Index i : unknown.rotation)
        x.quaternion[std::size_t(i)] =
            detail::FitQuaternion(x.rotation[std::size_t(i)].transpose(), x.quaternion[std::size_t(i)]);
}

/// \param x with the quaternions of its maps \param open the linear part that all maps are drawn to
/// \param shares if not null, each node's share is added to it
double AffineDeformer::Energy(const State &x, const PoseTerms &poseTerms, const Eigen::Matrix3d &open,
                              std::vector<double> *shares) const {
    double sum = 0;
    const auto add = [&](Index i, double share) {
        sum += share;
        if (shares)
            (*shares)[std::size_t(i)] += share;
    };
    ForTerms(
        [&](Index i, Index j, std::uint32_t e, Index end, double w) {
            const Eigen::Vector3d restEdge = graph.edge.col(e).cast<double>();
            add(end, w * (PosedEdge(x, poseTerms, i, j, e) - x.rotation[std::size_t(end)] * restEdge).squaredNorm());
        },
        [&](Index i, Index j, double w) {
            const double difference = w * (x.rotation[std::size_t(i)] - x.rotation[std::size_t(j)]).squaredNorm();
            add(i, difference / 2);
            add(j, difference / 2);
        });
    for (Index i : unknown.rotation) {
        const Eigen::Matrix3d &linear = x.rotation[std::size_t(i)];
        add(i,
            poseTerms.stiffness[std::size_t(i)] * smooth * (linear - poseTerms.linear[std::size_t(i)]).squaredNorm());
        if (rigidity > 0)
            add(i, rigidity * mass[std::size_t(i)] *
                       (linear - detail::ToMatrix(x.quaternion[std::size_t(i)])).squaredNorm());
        sum += leastStay * mass[std::size_t(i)] * (linear - open).squaredNorm();
    }
    return sum;
}

GraphPose AffineDeformer::Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param,
                                const Progress &progress, const GraphPose *last,
                                const std::vector<Eigen::Affine3d> &lastMotion) const {
    const Index k = graph.Size();
    GraphPose pose;
    const Eigen::Affine3d common = detail::CommonMotion(graph, unknown.constrained, motion).Affine();
    const State base = Base(motion, common);
    State state = base;
    const PoseTerms poseTerms(energy, motion, base, smooth);
    if (!unknown.rotation.empty()) {
        const Eigen::MatrixX3d right = RightSide(base, poseTerms);
        if (laplacian) {
            const State guess = detail::InitialGuess(graph, unknown, *laplacian, motion, last, lastMotion);
            state.quaternion = guess.quaternion;
            Minimise(base, poseTerms, right, common.linear(), param, state, pose, progress);
            const double nearby = 1; // half of 2 radians, as in GraphDeformer::Follow
            for (Index i : unknown.rotation)
                if (last && std::abs(state.quaternion[std::size_t(i)].dot(guess.quaternion[std::size_t(i)])) <
                                detail::Cosine(nearby))
                    pose.followed = false;
        } else {
            Solved(base, right, state);
            pose.iterations = 1;
        }
    }
    pose.nodeEnergy.assign(std::size_t(k), 0);
    Energy(state, poseTerms, common.linear(), &pose.nodeEnergy);
    for (double share : pose.nodeEnergy)
        pose.energy += share;
    pose.affine = true;
    pose.position = std::move(state.position);
    pose.linear = std::move(state.rotation);
    return pose;
}

/// Makes local and global steps until \p state is at rest. \param state begins with its quaternions
void AffineDeformer::Minimise(const State &base, const PoseTerms &poseTerms, const Eigen::MatrixX3d &right,
                              const Eigen::Matrix3d &common, const SolverParam &param, State &state, GraphPose &pose,
                              const Progress &progress) const {
    const Eigen::Matrix3Xf &rest = graph.graph.position;
    const double still =
        10 * param.tolerance * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).cast<double>().norm();
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * double(unknown.rotation.size()) *
                            std::max(1.0, base.position.cwiseAbs().maxCoeff());
    const auto step = [&](const State &x, State &y) {
        Eigen::MatrixX3d drawn = right;
        for (Index i : unknown.rotation)
            drawn.middleRows<3>(RowOf(i) + 1) +=
                rigidity * mass[std::size_t(i)] *
                (detail::ToMatrix(x.quaternion[std::size_t(i)]) - base.rotation[std::size_t(i)]).transpose();
        y.quaternion = x.quaternion;
        Solved(base, drawn, y);
        FitRotations(y);
    };
    const auto pack = [&](const State &x,
                          Eigen::VectorXd &v) { // maps times the mean edge length, to weigh as positions
        double *at = v.data();
        for (Index i : unknown.rotation)
            at = std::transform(x.rotation[std::size_t(i)].data(), x.rotation[std::size_t(i)].data() + 9, at,
                                [&](double a) { return a * edgeLength; });
        for (Index i : unknown.position)
            at = std::copy_n(x.position.col(i).data(), 3, at);
    };
    const auto unpack = [&](const Eigen::VectorXd &v, State &x) {
        const double *at = v.data();
        for (Index i : unknown.rotation) {
            x.rotation[std::size_t(i)] = Eigen::Map<const Eigen::Matrix3d>(at) / edgeLength;
            at += 9;
        }
        for (Index i : unknown.position) {
            x.position.col(i) = Eigen::Map<const Eigen::Vector3d>(at);
            at += 3;
        }
        FitRotations(x);
    };
    step(State(state), state);
    state.energy = Energy(state, poseTerms, common, nullptr);
    State stepped = state, mixed = state;
    const auto numbers = Eigen::Index(9 * unknown.rotation.size() + 3 * unknown.position.size());
    detail::Anderson anderson{std::size_t(numbers)};
    Eigen::VectorXd here(numbers), after(numbers);
    pose.converged = false;
    for (pose.iterations = 1; !pose.converged && pose.iterations < param.maxIterations; ++pose.iterations) {
        if ((pose.iterations & 15) == 0)
            progress(1 - detail::Exponential(-4.0 * pose.iterations / param.maxIterations), stage);
        step(state, stepped);
        const double moved = LargestMove(state, stepped);
        pack(state, here);
        pack(stepped, after);
        anderson.Mix(here, after);
        pose.converged = moved <= (1 - anderson.Contraction()) * still || moved <= rounding;
        stepped.energy = Energy(stepped, poseTerms, common, nullptr);
        if (param.accelerated && edgeLength > 0) {
            unpack(after, mixed);
            mixed.energy = Energy(mixed, poseTerms, common, nullptr);
            std::swap(state, mixed.energy < stepped.energy ? mixed : stepped);
        } else {
            std::swap(state, stepped);
        }
    }
}

/// The largest change of a position, or of a map times the mean edge length.
double AffineDeformer::LargestMove(const State &x, const State &y) const {
    double moved = 0;
    for (Index i : unknown.position)
        moved = std::max(moved, (y.position.col(i) - x.position.col(i)).squaredNorm());
    for (Index i : unknown.rotation)
        moved = std::max(moved, (y.rotation[std::size_t(i)] - x.rotation[std::size_t(i)]).squaredNorm() * edgeLength *
                                    edgeLength);
    return std::sqrt(moved);
}

} // namespace vcg::fcd
