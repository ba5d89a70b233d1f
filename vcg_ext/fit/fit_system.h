// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_SYSTEM_H
#define VCG_FCD_FIT_SYSTEM_H

#include <vcg_ext/base/block_factor.h>
#include <vcg_ext/fit/fit_samples.h>

#include <Eigen/Core>
#include <cstddef>
#include <variant>
#include <vector>

namespace vcg::fcd {

/// The Gauss-Newton step of a fit: turns w_k and shifts d_k of the free nodes of a deformation graph that minimise
/// sum_s m_s(x_s - q_s) + stiffness (Eq. 2 of the paper) / A, linearised at a pose. x_s is the position of sample s,
/// q_s its match, and m_s a quadratic form. An edge is as stiff as the stiffer of its ends.
///
/// With a rigidity r below 1, a node's map is affine, A_k instead of R_k, as in AffineDeformer, and Eq. 2 becomes
/// sum_ij w_ij (|A_i e_ij + p'_i - p'_j|^2 + alpha A |A_i - A_j|^2) + r / (1 - r) sum_i |A_i - R(A_i)|^2
/// sum_j w_ij |e_ij|^2.
class FitSystem {
  public:
    template <int N>
    using VectorOf = Eigen::Matrix<double, N, 1>;
    template <int N>
    using MatrixOf = Eigen::Matrix<double, N, N>;
    /// A column for each node of the graph: w_k in radians, d_k in frame units, 6 rows; or the change of A_k, column by
    /// column, and d_k, 12 rows.
    using Change = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

    /// The quadratic form that draws a sample to its match, and its gradient at the pose.
    struct Pull {
        Eigen::Matrix3d form = Eigen::Matrix3d::Zero();
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero(); ///< form times (x - q)
    };

    /// \param isFree flags of the graph's nodes \param samples those of the pulls, in this order; must outlive this
    /// \param rigidity [0, 1]; 1: maps are rotations
    FitSystem(const RegionDeformer &deformer, const std::vector<char> &isFree, const FitSamples &samples,
              double smoothness, double rigidity = 1);

    /// The step from \p pose; 0 for nodes that are not free. \param stiffness of each node of the graph
    /// \throw Unsolvable the system cannot be factorised
    Change Step(const GraphPose &pose, const std::vector<Pull> &pull, const std::vector<double> &stiffness,
                unsigned threads = 0);
    /// Applies a step to \p pose.
    static void Take(const Change &step, GraphPose &pose);

    /// The compliance of a sample at the last step: its move by a force of 1, a column each direction.
    /// \pre Step was called; rigidity 1 \throw Unsolvable as Step
    Eigen::Matrix3d Compliance(std::size_t sample);

  private:
    /// The system for N unknowns a node.
    template <int N>
    struct System {
        detail::BlockMatrix<N> matrix;
        detail::BlockFactor<N> factor;
    };

    template <int N>
    void MakePattern(System<N> &system) const;
    template <int N>
    void Factorise(System<N> &system);
    template <int N>
    void Assemble(const GraphPose &pose, const std::vector<Pull> &pull, const std::vector<double> &stiffness,
                  unsigned threads, System<N> &system, Eigen::VectorXd &gradient) const;
    void AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                    std::vector<MatrixOf<6>> &block, VectorOf<6> &gradient) const;
    void AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                    std::vector<MatrixOf<12>> &block, VectorOf<12> &gradient) const;
    void AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                  const std::vector<Index> &place, std::vector<MatrixOf<6>> &block, VectorOf<6> &gradient) const;
    void AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                  const std::vector<Index> &place, std::vector<MatrixOf<12>> &block, VectorOf<12> &gradient) const;
    template <int N>
    Eigen::VectorXd Solve(System<N> &system, const Eigen::VectorXd &right);

    const RegionDeformer &deformer;
    const FitSamples &samples;
    double smoothness, area;
    const double rigidity;                  ///< r / (1 - r)
    const int size;                         ///< unknowns of a node
    std::vector<Index> node;                ///< of each unknown
    std::vector<Index> unknown;             ///< of each node; -1: not free
    std::vector<std::vector<Index>> beside; ///< of each unknown: itself and later ones that share a sample or an edge
    struct Use {
        std::uint32_t sample, term;
    };
    std::vector<std::vector<Use>> uses; ///< of each unknown: the terms of samples with it
    std::vector<Eigen::Vector3d> arm;   ///< of each term: R lever at the pose; for affine maps, the lever
    std::variant<System<6>, System<12>> system;
    bool isFactored = false, isNew = false; ///< there is a factor; it is of the present matrix
};

} // namespace vcg::fcd

#endif
