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

/// Newton's method on the energy of a graph at what a pose gives.
class GraphNewton {
  public:
    using State = GraphEnergy::State;

    /// \param edgeLength by which turns are measured \param still below it a node does not move
    GraphNewton(const GraphEnergy &energy, const GraphUnknowns &unknown, const GraphEnergy::PoseTerms &given,
                double edgeLength, double still)
        : energy(energy), given(given), edgeLength(edgeLength), still(still), hessian(unknown) {}

    /// Finds where the energy is stationary, a minimum or a saddle, from \p state. Counts the steps in \p pose,
    /// to \p mostIterations. \return whether it did
    bool FindStationary(int mostIterations, State &state, GraphPose &pose, const Progress &progress) {
        const int most = 40; // where the shape is about to give way; otherwise four to ten do
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
    /// \return whether there is a step from \p state
    bool Look(const State &state, const Progress &progress) {
        progress(0, "Deforming the graph");
        hessian.Assemble(energy, state, given);
        if (!hessian.Factorise(progress))
            return false;
        step = -hessian.Solve(energy.Gradient(state, given));
        return step.allFinite();
    }
    Eigen::VectorXd Limited() const {
        const double farthest = 0.5; // radian, in a step: its quadratic is good for so much
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
