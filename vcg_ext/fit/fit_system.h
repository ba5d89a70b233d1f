// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_SYSTEM_H
#define VCG_FCD_FIT_SYSTEM_H

#include <vcg_ext/fit/fit_samples.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

namespace vcg::fcd {

/// The Gauss-Newton step of a fit: turns w_k and shifts d_k of the free nodes of a deformation graph that minimise
/// sum_s m_s(x_s - q_s) + stiffness (Eq. 2 of the paper) / A, linearised at a pose, where m_s is a quadratic form.
/// An edge is as stiff as the stiffer one of its ends.
class FitSystem {
  public:
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;

    /// What a sample is drawn to: the form and its gradient at the pose, in the sample's position.
    struct Pull {
        Eigen::Matrix3d form = Eigen::Matrix3d::Zero();
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero(); ///< form times (x - q)
    };

    /// \param isFree flags of the graph's nodes \param samples which the pulls will be of, in this order
    FitSystem(const RegionDeformer &deformer, const std::vector<char> &isFree, const FitSamples &samples,
              double smoothness);

    /// The step from \p pose. \param stiffness of each node of the graph \return 6 x nodes: w_k in radians, d_k in
    /// frame units; 0 for those that are not free \throw Unsolvable
    Eigen::Matrix<double, 6, Eigen::Dynamic> Step(const GraphPose &pose, const std::vector<Pull> &pull,
                                                  const std::vector<double> &stiffness, unsigned threads = 0);
    /// Takes a step on from \p pose.
    static void Take(const Eigen::Matrix<double, 6, Eigen::Dynamic> &step, GraphPose &pose);

    /// How a sample answers what draws it, where the last step was made: its move by a force of 1 in each direction.
    /// \pre Step was called \throw Unsolvable
    Eigen::Matrix3d Compliance(std::size_t sample);

  private:
    void Factorize();
    void AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                    std::vector<Matrix6> &block, Vector6 &gradient) const;
    void AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                  const std::vector<Index> &place, std::vector<Matrix6> &block, Vector6 &gradient) const;
    Eigen::VectorXd Solve(const Eigen::VectorXd &right);

    const RegionDeformer &deformer;
    const FitSamples &samples;
    double smoothness, area;
    std::vector<Index> node;                ///< of each unknown
    std::vector<Index> unknown;             ///< of each node, -1 for none
    std::vector<std::vector<Index>> beside; ///< of each unknown: those from it on that share a sample or an edge
    struct Use {
        std::uint32_t sample, term;
    };
    std::vector<std::vector<Use>> uses; ///< of each unknown: the terms of samples that it is in
    std::vector<Eigen::Vector3d> arm;   ///< of each term, R lever at the pose
    Eigen::SparseMatrix<double> matrix; ///< the lower half
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor;
    bool isFactored = false, isNew = false; ///< the factor is of this matrix, or of an earlier one
};

} // namespace vcg::fcd

#endif
