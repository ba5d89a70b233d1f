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

namespace vcg::fcd::detail {

/// Newton's method on the energy of a graph, for one pose.
class GraphNewton {
  public:
    using State = GraphEnergy::State;

    /// \param edgeLength times a turn in radians counts as a move \param still frame units: shorter moves count as none
    GraphNewton(const GraphEnergy &energy, const GraphUnknowns &unknown, const GraphEnergy::PoseTerms &given,
                double edgeLength, double still)
        : energy(energy), given(given), edgeLength(edgeLength), still(still), hessian(unknown) {}

    /// Goes from \p state to a stationary state nearby, a minimum or a saddle; sets pose.unstable. Counts the steps in
    /// \p pose, up to \p mostIterations. \return whether it found one
    bool FindStationary(int mostIterations, State &state, GraphPose &pose, const Progress &progress) {
        const int most = 40; // needed where the shape is about to buckle; elsewhere 4 to 10
        for (int n = 0; n < most && pose.iterations < mostIterations; ++n, ++pose.iterations) {
            if (!Look(state, progress.Slice(double(n) / most, double(n + 1) / most)))
                return false;
            const double moved = std::max(hessian.LargestMove(step), hessian.LargestTurn(step) * edgeLength);
            hessian.Move(state, Limited());
            if (moved <= still) {
                state.energy = energy.Of(state, given);
                pose.unstable = hessian.Falling() > 0;
                return true;
            }
        }
        return false;
    }

  private:
    /// Sets step to Newton's step from \p state. \return whether there is one
    bool Look(const State &state, const Progress &progress) {
        progress(0, "Deforming the graph");
        hessian.Assemble(energy, state, given);
        if (!hessian.Factorise(progress))
            return false;
        step = -hessian.Solve(energy.Gradient(state, given));
        return step.allFinite();
    }
    Eigen::VectorXd Limited() const {
        const double farthest = 0.5; // radians a step: up to there, the quadratic model is good
        return std::min(1.0, farthest / hessian.LargestTurn(step)) * step;
    }

    const GraphEnergy &energy;
    const GraphEnergy::PoseTerms &given;
    const double edgeLength, still;
    GraphHessian hessian;
    Eigen::VectorXd step;
};

} // namespace vcg::fcd::detail

#endif
