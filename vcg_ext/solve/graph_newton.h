// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_NEWTON_H
#define VCG_FCD_GRAPH_NEWTON_H

#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_hessian.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/graph_unknowns.h>

#include <algorithm>
#include <limits>

namespace vcg::fcd::detail {

/// Newton's method on the energy of a graph, for one pose.
class GraphNewton {
  public:
    using State = GraphEnergy::State;

    /// \param edgeLength times a turn in radians counts as a move \param still frame units: shorter moves count as none
    GraphNewton(const GraphEnergy &energy, const GraphUnknowns &unknown, const GraphEnergy::PoseTerms &poseTerms,
                double edgeLength, double still)
        : energy(energy), poseTerms(poseTerms), edgeLength(edgeLength), still(still), hessian(unknown) {
        for (Index i : unknown.rotation)
            mass += energy.TurningMass(i);
    }

    /// Goes from \p state to a stationary state nearby, a minimum or a saddle; sets pose.unstable. Counts the steps in
    /// \p pose, up to \p mostIterations. \return whether it found one
    bool FindStationary(int mostIterations, State &state, GraphPose &pose, const Progress &progress) {
        const int most = 40; // needed where the shape is about to buckle; elsewhere 4 to 10
        for (int n = 0; n < most && pose.iterations < mostIterations; ++n, ++pose.iterations) {
            if (!Look(state, progress.Slice(double(n) / most, double(n + 1) / most)))
                return false;
            const double moved = std::max(hessian.LargestMove(step), hessian.LargestTurn(step) * edgeLength);
            hessian.Limit(step);
            hessian.Move(state, step);
            if (moved <= still) {
                state.energy = energy.Of(state, poseTerms);
                pose.unstable = hessian.Falling() > 0;
                return true;
            }
        }
        return false;
    }

    /// Goes downwards to rest, as long as that leads to a minimum; a state that is at rest is left as it is. Counts the
    /// steps in \p pose, to \p mostIterations. \return whether \p state is at rest
    bool Descend(int mostIterations, State &state, GraphPose &pose, const Progress &progress) {
        for (; pose.iterations < mostIterations; ++pose.iterations) {
            const double done = 1 - Exponential(-4.0 * pose.iterations / mostIterations);
            if (!Look(state, progress.Slice(done, done)))
                return false;
            Eigen::VectorXd limited = step;
            hessian.Limit(limited);
            if (std::max(hessian.LargestMove(limited), hessian.LargestTurnOfGiven(limited) * edgeLength) <= still)
                return true;
            // If the edges leave a turn open, a long step may be rounding alone. Then the energy hardly falls.
            const double most = limited.cwiseAbs().maxCoeff();
            if (-gradient.dot(limited) <= 64 * std::numeric_limits<double>::epsilon() * mass * most)
                return true;
            if (hessian.Falling() > 0)
                return false;
            State moved;
            const int halvings = 6; // if that is not enough, the other steps go on
            for (int half = 0;; ++half, limited *= 0.5) {
                moved = state;
                hessian.Move(moved, limited);
                moved.energy = energy.Of(moved, poseTerms);
                if (moved.energy < state.energy)
                    break;
                if (half == halvings)
                    return false;
            }
            state = std::move(moved);
        }
        return false;
    }

  private:
    /// Sets step to Newton's step from \p state. \return whether there is one
    bool Look(const State &state, const Progress &progress) {
        progress(0, "Deforming the graph");
        hessian.Assemble(energy, state, poseTerms);
        if (!hessian.Factorise(progress, hessian.Worthwhile()))
            return false;
        gradient = energy.Gradient(state, poseTerms);
        step = -hessian.Solve(gradient);
        return step.allFinite();
    }

    const GraphEnergy &energy;
    const GraphEnergy::PoseTerms &poseTerms;
    const double edgeLength, still;
    GraphHessian hessian;
    Eigen::VectorXd gradient, step;
    double mass = 0; // the sum of TurningMass
};

} // namespace vcg::fcd::detail

#endif
