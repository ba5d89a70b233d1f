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

/// Deforms a graph with a rigidity r below 1: as GraphDeformer does, but the map of a node is affine, A_i instead of
/// R_i. The energy is Eq. 2 with these, and r / (1 - r) sum_i |A_i - R(A_i)|^2 sum_j w_ij |e_ij|^2, where R(A) is the
/// rotation nearest to A: the regularisation of embedded deformation (SSP07) with a share of its rigidity. At 0, only
/// how maps change between neighbours costs: as in a thin-plate spline, every affine map of all is free.
///
/// With the rotations given, the energy is a square that is the same for each coordinate. It is factorised at
/// construction: a system of four numbers a node. At 0, it is solved once. Otherwise it is solved in turns with the
/// best rotations, accelerated (local and global steps), from where the motions of what is held lead.
class AffineDeformer {
  public:
    /// The parameters are those of GraphDeformer. \param solver its smoothness, and its rigidity below 1, are those of
    /// all poses
    /// \throw Unsolvable when the system cannot be factorised, or takes too long \throw Cancelled
    AffineDeformer(const DeformationGraph &graph, const std::vector<bool> &constrained, double area,
                   const std::vector<bool> &compliant, const std::vector<double> &heldArea, double heldDepth,
                   const SolverParam &solver, const Progress &progress = {});

    /// As of GraphDeformer. At rigidity 0, \p last is not read: a pose does not depend on the way to it.
    GraphPose Solve(const std::vector<Eigen::Affine3d> &motion, const SolverParam &param, const Progress &progress = {},
                    const GraphPose *last = nullptr, const std::vector<Eigen::Affine3d> &lastMotion = {}) const;

  private:
    using State = detail::GraphEnergy::State; ///< its rotations are the maps A_i, its quaternions those of R(A_i)
    using PoseTerms = detail::GraphEnergy::PoseTerms;

    template <class Stretch, class Bend>
    void ForTerms(const Stretch &stretch, const Bend &bend) const;
    void Factorise(const PoseTerms &given, const Progress &progress);
    State Base(const std::vector<Eigen::Affine3d> &motion, const Eigen::Affine3d &common) const;
    /// Where the four rows of node \p i begin: its position's, and its map's three.
    Eigen::Index RowOf(Index i) const { return 4 * Eigen::Index(unknown.turnOf[std::size_t(i)]); }
    Eigen::Vector4d Coefficients(Index i, Index end, double sign, const Eigen::Vector3d &way) const;
    Eigen::Vector3d Way(const State &x, const PoseTerms &given, Index i, Index j, std::uint32_t e) const;
    Eigen::MatrixX3d RightSide(const State &base, const PoseTerms &given) const;
    void Solved(const State &base, const Eigen::MatrixX3d &right, State &x) const;
    void FitRotations(State &x) const;
    double Energy(const State &x, const PoseTerms &given, const Eigen::Matrix3d &open,
                  std::vector<double> *shares) const;
    void Minimise(const State &base, const PoseTerms &given, const Eigen::MatrixX3d &right,
                  const Eigen::Matrix3d &common, const SolverParam &param, State &state, GraphPose &pose,
                  const Progress &progress) const;
    double LargestMove(const State &x, const State &y) const;

    const DeformationGraph &graph;
    const double smooth, rigidity; ///< alpha A; r / (1 - r)
    detail::GraphUnknowns unknown;
    detail::GraphEnergy energy;
    std::optional<detail::GraphLaplacian> laplacian; ///< where it is solved in turns
    std::vector<double> mass;                        ///< k, what a turn of a node moves
    detail::BlockFactor<4> factor;
    double edgeLength = 0; ///< mean
};

} // namespace vcg::fcd

#endif
