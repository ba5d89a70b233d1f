// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SOLVER_PARAM_H
#define VCG_FCD_SOLVER_PARAM_H

namespace vcg::fcd {

/// How the graph is deformed (paper, sec. 2.2).
struct SolverParam {
    /// alpha of Eq. 2, >= 0: the higher, the more evenly bending and twist spread. The default equals that of SR-ARAP
    /// in CGAL: 0.02 A / 6 at each of the six edges of a regular triangulation, whose weights are 1/sqrt(3).
    double smoothness = 0.0058;
    /// r, [0, 1]. Below 1, a node's map is affine (AffineDeformer): deviation from a rotation costs r / (1 - r) times
    /// the stretch of its edges. At 0, only differences between neighbours' maps cost, as with a thin-plate spline;
    /// then a pose is linear in the motions, and does not depend on earlier poses.
    double rigidity = 1;
    int maxIterations = 1000; ///< >= 0
    double tolerance = 1e-5;  ///< stop if no node is farther from rest than ten times this fraction of the diagonal
    /// Anderson's acceleration. Without it, steps are the paper's, and end when one moves no node by more than the
    /// tolerance times the diagonal.
    bool accelerated = true;
    /// Whether the accelerated steps are quasi-Newton ones, by the Hessian at rest. If not, they are local and global
    /// ones: five times as many are needed, and a shape takes longer to buckle.
    bool quasiNewton = true;
    /// Whether the pose comes to rest near where it begins, at a minimum or a saddle. If not, it goes down to any
    /// minimum. A pose that comes to rest soon has the same bits in both ways.
    bool follow = false;

    /// Whether poses begin with quasi-Newton steps.
    bool IsQuasiNewton() const { return accelerated && quasiNewton && rigidity == 1; }

    bool operator==(const SolverParam &o) const {
        return smoothness == o.smoothness && rigidity == o.rigidity && maxIterations == o.maxIterations &&
               tolerance == o.tolerance && accelerated == o.accelerated && quasiNewton == o.quasiNewton &&
               follow == o.follow;
    }
};

} // namespace vcg::fcd

#endif
