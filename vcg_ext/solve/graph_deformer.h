// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_DEFORMER_H
#define VCG_FCD_GRAPH_DEFORMER_H

#include <vcg_ext/base/elementary.h>
#include <vcg_ext/solve/anderson.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_laplacian.h>
#include <vcg_ext/solve/graph_newton.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/graph_unknowns.h>
#include <vcg_ext/solve/initial_guess.h>
#include <vcg_ext/solve/rest_hessian.h>
#include <vcg_ext/solve/solver_param.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/shape_constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// SR-ARAP on a graph of k nodes (Levi and Gotsman 2015; paper, Eqs. 2, 5 and 6, with the local step corrected: S_i is
/// the sum of w_ij (e_ij e'_ij^T + alpha A R_j^T)). Factorises its systems once, at construction.
///
/// An edge between a free and a held patch ends at their border. The rotation of a compliant node is unknown, as that
/// of a free node, and drawn to the rotation of the held region behind it. A component of the graph without a
/// constrained node stays at rest.
class GraphDeformer {
  public:
    /// \param graph must outlive this
    /// \param constrained k flags: the position is given, and so is the rotation unless the node is compliant
    /// \param area A, frame units^2
    /// \param compliant k flags, or empty for none: constrained, with a free rotation
    /// \param heldArea k values, or empty for 0: held area behind a compliant node, frame units^2; infinite
    ///        for a region that goes on
    /// \param heldDepth as in ShapeConstants
    /// \param solver if it asks for quasi-Newton steps, they are prepared for its smoothness; poses with another
    ///        smoothness get local and global steps
    /// \throw Unsolvable when the system cannot be factorised, or takes too long \throw Cancelled
    GraphDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                  const std::vector<bool> &compliant = {}, const std::vector<double> &heldArea = {},
                  double heldDepth = ShapeConstants().heldDepth, const Progress &progress = {},
                  const SolverParam &solver = {})
        : graph(graph), area(area), smoothness(solver.smoothness),
          unknown(graph.graph.adjacency, constrained, compliant), energy(graph, unknown, heldArea, heldDepth),
          laplacian(graph, unknown, progress.Slice(0, 0.5)) {
        if (solver.IsQuasiNewton())
            hessian = std::make_unique<const detail::RestHessian>(graph, energy, unknown, smoothness * area,
                                                                  progress.Slice(0.5, 1));
        for (Eigen::Index e = 0; e < graph.edge.cols(); ++e)
            edgeLength += graph.edge.col(e).cast<double>().norm() / double(graph.edge.cols());
        Eigen::VectorXd mass(Eigen::Index(unknown.position.size()));
        for (std::size_t u = 0; u < unknown.position.size(); ++u)
            mass[Eigen::Index(u)] = energy.TurningMass(unknown.position[u]);
        spread = laplacian.LeastEigenvalue(mass);
    }

    /// Whether node \p i is in a component with a constrained node.
    bool HasConstraint(Index i) const { return unknown.HasConstraint(i); }
    /// \param motion k motions, frame units; read for constrained nodes only
    /// \param last the pose to go on from, such as an animation's last one, so that the shape changes as steadily as
    ///        the motions; null: from rest
    /// \param lastMotion k, the motions of \p last
    GraphPose Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param, const Progress &progress = {},
                    const GraphPose *last = nullptr, const std::vector<Eigen::Affine3d> &lastMotion = {}) const {
        const Index k = graph.Size();
        GraphPose pose;
        pose.linear.assign(k, Eigen::Matrix3d::Identity());
        for (Index i = 0; i < k; ++i)
            if (unknown.constrained[i])
                pose.linear[i] = motion[i].linear();
        State state = detail::InitialGuess(graph, unknown, laplacian, motion, last, lastMotion);
        if (unknown.rotation.empty()) {
            pose.nodeEnergy.assign(k, 0);
        } else {
            const PoseTerms poseTerms(energy, motion, state, param.smoothness * area);
            if (param.follow)
                Follow(poseTerms, param, last != nullptr, state, pose, progress);
            else
                Minimise(poseTerms, param, param.maxIterations, state, pose, progress);
            pose.energy = state.energy;
            pose.nodeEnergy = energy.Shares(state, poseTerms);
        }
        pose.position = std::move(state.position);
        for (Index i : unknown.rotation)
            pose.linear[i] = state.rotation[i];
        return pose;
    }

    /// How far \p pressure (k values) moves the free nodes; see GraphLaplacian::Spread. \return k values, 0 for
    /// constrained nodes
    Eigen::VectorXd Spread(const Eigen::VectorXd &pressure) const {
        Eigen::VectorXd displacement = Eigen::VectorXd::Zero(pressure.size());
        Eigen::VectorXd known(Eigen::Index(unknown.position.size()));
        for (std::size_t u = 0; u < unknown.position.size(); ++u)
            known[Eigen::Index(u)] = pressure[unknown.position[u]];
        if (known.size() == 0)
            return displacement;
        const Eigen::VectorXd moved = laplacian.Spread(known);
        for (std::size_t u = 0; u < unknown.position.size(); ++u)
            displacement[unknown.position[u]] = moved[Eigen::Index(u)];
        return displacement;
    }

  private:
    using State = detail::GraphEnergy::State;
    using PoseTerms = detail::GraphEnergy::PoseTerms;

    /// Brings \p state to rest near where it begins. Where the shape is stable, a few quasi-Newton steps do that, or,
    /// far from rest, local and global ones. Otherwise, Newton's method looks for a stationary state nearby, which may
    /// be a saddle. If there is none, the state descends to rest wherever that leads.
    /// \param goesOn whether it begins at another pose, not at rest
    void Follow(const PoseTerms &poseTerms, const SolverParam &param, bool goesOn, State &state, GraphPose &pose,
                const Progress &progress) const {
        const int quick = 40;      // quasi-Newton steps: a stable shape needs 7 to 30
        const int few = 100;       // local and global steps: a stable shape needs 20 to 80
        const double nearby = 2;   // radians: a guess is off by less, a shape that lost a full turn by more
        const double least = 0.01; // share of the energy: a shape that hardly begins to buckle loses less
        const State begin = state;
        const auto isNear = [&](const State &x) { return !goesOn || LargestTurn(begin, x) <= nearby; };
        const auto upTo = [&](int steps) { return std::min(param.maxIterations, pose.iterations + steps); };
        SolverParam slowly = param;
        slowly.quasiNewton = false;
        if (IsQuasiNewton(param)) {
            Minimise(poseTerms, param, upTo(quick), state, pose, progress.Slice(0, 0.1));
            if (pose.iterations == param.maxIterations || (pose.converged && isNear(state)))
                return;
            state = begin;
        }
        Minimise(poseTerms, slowly, upTo(few), state, pose, progress.Slice(0.1, 0.4));
        if (pose.iterations == param.maxIterations || (pose.converged && isNear(state)))
            return;
        State stationary = state;
        detail::GraphNewton newton = NewtonOf(poseTerms, param);
        // From rest, look near where the steps ended. If nothing is there, or after another pose, look near the start.
        pose.followed = !goesOn &&
                        newton.FindStationary(param.maxIterations, stationary, pose, progress.Slice(0.4, 0.6)) &&
                        stationary.energy <= (1 + least) * state.energy;
        if (!pose.followed) {
            stationary = begin;
            pose.followed = newton.FindStationary(param.maxIterations, stationary, pose, progress.Slice(0.6, 0.8)) &&
                            isNear(stationary) && stationary.energy <= (1 + least) * energy.Of(begin, poseTerms);
        }
        if (pose.followed)
            state = std::move(stationary);
        else if (!pose.converged)
            Minimise(poseTerms, slowly, param.maxIterations, state, pose, progress.Slice(0.8, 1));
        pose.converged = pose.converged || pose.followed;
        pose.unstable = pose.unstable && pose.followed;
    }

    detail::GraphNewton NewtonOf(const PoseTerms &poseTerms, const SolverParam &param) const {
        return {energy, unknown, poseTerms, edgeLength, Still(param)};
    }
    bool IsQuasiNewton(const SolverParam &param) const {
        return param.IsQuasiNewton() && param.smoothness == smoothness && hessian && hessian->IsThere();
    }
    double Still(const SolverParam &param) const { return 10 * param.tolerance * Diagonal(); }

    /// Takes steps that lower the energy until \p state is at rest. The steps are quasi-Newton ones if \p param asks
    /// for them and there is a Hessian, else local and global ones. Counts them in pose.iterations, up to \p most. With
    /// SolverParam::follow, it also ends if quasi-Newton steps do not get shorter for a while: the shape gives way
    /// then.
    void Minimise(const PoseTerms &poseTerms, const SolverParam &param, int most, State &state, GraphPose &pose,
                  const Progress &progress) const {
        // If each step is rho times the one before it, 1 / (1 - rho) times the step is left in all.
        const Eigen::Matrix3Xd rest = graph.graph.position.cast<double>();
        const double still = Still(param), rounding = Rounding(rest, state),
                     noise = rounding * energy.Weight() / double(unknown.rotation.size());
        // The smoothest error, a turn spread over all free surface, shrinks by the share alpha A * spread in a local
        // and global step. n accelerated steps show shares down to 1 / n^2, and 20 steps are the fewest to come to
        // rest. If the share is less, as on a path much longer than wide, short steps do not tell that the shape is at
        // rest.
        const double slowest = 1.0 / (20 * 20);
        const int patience = 5; // steps; with more, a pressed sheet gives way before
        const bool isQuasi = IsQuasiNewton(param), isSlow = !isQuasi && param.smoothness * area * spread < slowest;
        double near = still;                                       // error below which slow modes are looked for
        double shortest = std::numeric_limits<double>::infinity(); // of the steps
        int longer = 0;                                            // steps since then
        state.energy = energy.Of(state, poseTerms);
        State stepped = state, mixed = state;
        const std::size_t size = 3 * unknown.position.size() + 4 * unknown.rotation.size();
        detail::Anderson anderson(size);
        Eigen::VectorXd here(size), after(size);
        Work work{std::vector<Eigen::Matrix3d>(graph.Size()), Eigen::Matrix3Xd(3, unknown.position.size())};
        pose.converged = false;
        for (; !pose.converged && pose.iterations < most && !(isQuasi && param.follow && longer == patience);
             ++pose.iterations) {
            if ((pose.iterations & 15) == 0)
                progress(1 - detail::Exponential(-4.0 * pose.iterations / most), "Deforming the graph");
            const bool isNoise = isQuasi && !hessian->Step(state, poseTerms, noise, stepped);
            if (!isQuasi)
                Step(state, poseTerms, stepped, work);
            const double moved = LargestMove(state, stepped);
            if (!param.accelerated) {
                pose.converged = moved <= 0.1 * still;
                std::swap(state, stepped);
                state.energy = energy.Of(state, poseTerms);
                continue;
            }
            longer = moved < 0.9 * shortest ? 0 : longer + 1;
            shortest = std::min(shortest, moved);
            // Take the accelerated step if it lowers the energy, else the plain one. A local and global step always
            // does.
            Pack(state, here);
            Pack(stepped, after);
            anderson.Mix(here, after);
            const bool mayRest = moved <= (1 - anderson.Contraction()) * near;
            pose.converged = isNoise || (mayRest && !isSlow) || IsRounding(state, stepped, moved, rounding);
            Unpack(after, mixed);
            mixed.energy = energy.Of(mixed, poseTerms);
            if (mixed.energy < state.energy) {
                std::swap(state, mixed);
            } else {
                stepped.energy = energy.Of(stepped, poseTerms);
                if (isQuasi && !(stepped.energy < state.energy)) {
                    Step(state, poseTerms, stepped, work);
                    stepped.energy = energy.Of(stepped, poseTerms);
                }
                std::swap(state, stepped);
            }
            if (pose.converged || !mayRest)
                continue;
            pose.converged = NewtonOf(poseTerms, param).Descend(most, state, pose, progress);
            anderson = detail::Anderson(size);
            near = moved / 4;
        }
    }

    struct Work {
        std::vector<Eigen::Matrix3d> s; // k, S_i of Eq. 5
        Eigen::Matrix3Xd solved;        // of Eq. 6: a column per unknown position, in the order of the factorisation
    };

    /// One local and one global step. The energy cannot rise.
    void Step(const State &x, const PoseTerms &poseTerms, State &y, Work &work) const {
        energy.FitRotations(x, poseTerms, y, work.s);
        for (std::size_t u = 0; u < unknown.position.size(); ++u)
            work.solved.col(laplacian.ColumnOf(u)) = energy.RightSide(u, y, poseTerms);
        laplacian.Solve(work.solved);
        for (std::size_t u = 0; u < unknown.position.size(); ++u)
            y.position.col(unknown.position[u]) = work.solved.col(laplacian.ColumnOf(u));
    }

    /// The rounding error of a step. A rotation is fitted to 1e-14, 64 times the precision of doubles (FitQuaternion).
    /// Times the size of the positions, this adds up along a chain of all nodes.
    double Rounding(const Eigen::Matrix3Xd &rest, const State &x) const {
        const double size = std::max(rest.cwiseAbs().maxCoeff(), x.position.cwiseAbs().maxCoeff());
        return 64 * std::numeric_limits<double>::epsilon() * double(unknown.rotation.size()) * size;
    }

    /// Whether a step is no more than rounding; then its length tells nothing. A system of few nodes gets there before
    /// Anderson's window is full. \param moved LargestMove of the step
    bool IsRounding(const State &x, const State &y, double moved, double rounding) const {
        if (moved <= rounding)
            return true;
        // A rotation that its edges leave open is held by 1e-6 of them (GraphEnergy::stay), so rounding turns it by 1e6
        // times as much, without moving anything.
        if (moved > 1e6 * rounding)
            return false;
        double shown = 0;
        for (Index i : unknown.position)
            shown = std::max(shown, (y.position.col(i) - x.position.col(i)).squaredNorm());
        for (Index i : unknown.rotation)
            for (std::uint32_t e = graph.graph.adjacency.begin[i]; e < graph.graph.adjacency.begin[i + 1]; ++e)
                shown =
                    std::max(shown, ((y.rotation[i] - x.rotation[i]) * graph.edge.col(e).cast<double>()).squaredNorm());
        return std::sqrt(shown) <= rounding;
    }

    double Diagonal() const {
        const Eigen::Matrix3Xf &rest = graph.graph.position;
        return (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).cast<double>().norm();
    }

    /// The largest angle between a node's rotations in \p x and \p y, radians.
    double LargestTurn(const State &x, const State &y) const {
        double cosine = 1; // of half the angle
        for (Index i : unknown.rotation)
            cosine = std::min(cosine, std::abs(x.quaternion[i].dot(y.quaternion[i])));
        return 2 * detail::ArcCosine(cosine);
    }

    /// The largest move of a free node, or turn of a compliant one times the mean edge length.
    double LargestMove(const State &x, const State &y) const {
        double moved = 0;
        for (Index i : unknown.position)
            moved = std::max(moved, (y.position.col(i) - x.position.col(i)).squaredNorm());
        for (Index i : unknown.rotation)
            if (unknown.constrained[i]) // turns of free nodes show in how they move
                moved = std::max(moved, (y.rotation[i] - x.rotation[i]).squaredNorm() * edgeLength * edgeLength);
        return std::sqrt(moved);
    }

    /// The unknowns as one vector: positions, and quaternions times twice the mean edge length, so that both weigh
    /// about the same.
    void Pack(const State &x, Eigen::VectorXd &v) const {
        double *at = v.data();
        for (Index i : unknown.position) {
            Eigen::Map<Eigen::Vector3d> p(at);
            p = x.position.col(i);
            at += 3;
        }
        for (Index i : unknown.rotation) {
            Eigen::Map<Eigen::Vector4d> r(at);
            r = x.quaternion[i] * (2 * edgeLength);
            at += 4;
        }
    }
    void Unpack(const Eigen::VectorXd &v, State &x) const {
        const double *at = v.data();
        for (Index i : unknown.position) {
            x.position.col(i) = Eigen::Map<const Eigen::Vector3d>(at);
            at += 3;
        }
        for (Index i : unknown.rotation) {
            x.quaternion[i] = Eigen::Map<const Eigen::Vector4d>(at).stableNormalized();
            x.rotation[i] = detail::ToMatrix(x.quaternion[i]);
            at += 4;
        }
    }

    const DeformationGraph &graph;
    double area, smoothness;
    detail::GraphUnknowns unknown;
    detail::GraphEnergy energy;
    detail::GraphLaplacian laplacian;
    std::unique_ptr<const detail::RestHessian> hessian; // null: not asked for
    double edgeLength = 0;                              // mean
    double spread = 0; // over one frame unit^2: of the turn that the smoothness evens most slowly
};

} // namespace vcg::fcd

#endif
