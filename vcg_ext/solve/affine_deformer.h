// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_AFFINE_DEFORMER_H
#define VCG_FCD_AFFINE_DEFORMER_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/block_factor.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_energy.h>
#include <vcg_ext/solve/graph_laplacian.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/solve/graph_unknowns.h>
#include <vcg_ext/solve/solver_param.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

namespace vcg::fcd {

/// Deforms a graph with a rigidity r below 1. Like GraphDeformer, but the map of a node is affine: A_i instead of R_i.
/// The energy is Eq. 2 with A_i, plus r / (1 - r) sum_i |A_i - R(A_i)|^2 sum_j w_ij |e_ij|^2, where R(A) is the
/// rotation nearest to A: the regularisation of embedded deformation (Sumner, Schmid and Pauly 2007). At r = 0, only
/// differences between neighbours' maps cost: as with a thin-plate spline, one affine map of all nodes is free.
///
/// For given rotations, the energy is quadratic, with one matrix for all three coordinates: four unknowns a node. It is
/// factorised at construction. At r = 0, it is solved once a pose. Otherwise global steps (this system) and local steps
/// (the best rotations) alternate, accelerated, from the initial guess of GraphDeformer.
class AffineDeformer {
  public:
    /// Parameters as in GraphDeformer. \param solver rigidity < 1; all poses have its rigidity and smoothness
    /// \throw Unsolvable if the system cannot be factorised, or takes too long \throw Cancelled
    AffineDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                   const std::vector<bool> &compliant, const std::vector<double> &heldArea, double heldDepth,
                   const SolverParam &solver, const Progress &progress = {});

    /// As GraphDeformer::Solve. At rigidity 0, \p last is not read: a pose does not depend on earlier ones.
    GraphPose Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param, const Progress &progress = {},
                    const GraphPose *last = nullptr, const std::vector<Eigen::Affine3d> &lastMotion = {}) const;

  private:
    using State = detail::GraphEnergy::State; ///< rotation: the maps A_i; quaternion: R(A_i)
    using PoseTerms = detail::GraphEnergy::PoseTerms;

    template <class Stretch, class Bend>
    void ForTerms(const Stretch &stretch, const Bend &bend) const;
    void Factorise(const PoseTerms &poseTerms, const Progress &progress);
    State Base(const std::vector<Eigen::Affine3d> &motion, const Eigen::Affine3d &common) const;
    /// The first of node \p i's four rows: one of its position, three of its map.
    Eigen::Index RowOf(Index i) const { return 4 * Eigen::Index(unknown.turnOf[std::size_t(i)]); }
    Eigen::Vector4d Coefficients(Index i, Index end, double sign, const Eigen::Vector3d &restEdge) const;
    Eigen::Vector3d PosedEdge(const State &x, const PoseTerms &poseTerms, Index i, Index j, std::uint32_t e) const;
    Eigen::MatrixX3d RightSide(const State &base, const PoseTerms &poseTerms) const;
    void Solved(const State &base, const Eigen::MatrixX3d &right, State &x) const;
    void FitRotations(State &x) const;
    double Energy(const State &x, const PoseTerms &poseTerms, const Eigen::Matrix3d &open,
                  std::vector<double> *shares) const;
    void Minimise(const State &base, const PoseTerms &poseTerms, const Eigen::MatrixX3d &right,
                  const Eigen::Matrix3d &common, const SolverParam &param, State &state, GraphPose &pose,
                  const Progress &progress) const;
    double LargestMove(const State &x, const State &y) const;

    const DeformationGraph &graph;
    const double smooth, rigidity; ///< alpha A; r / (1 - r)
    detail::GraphUnknowns unknown;
    detail::GraphEnergy energy;
    std::optional<detail::GraphLaplacian> laplacian; ///< for the initial guess; none at rigidity 0
    std::vector<double> mass;                        ///< k, GraphEnergy::TurningMass
    detail::BlockFactor<4> factor;
    double edgeLength = 0; ///< mean
};

} // namespace vcg::fcd

#endif
