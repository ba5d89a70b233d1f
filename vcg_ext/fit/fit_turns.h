// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_TURNS_H
#define VCG_FCD_FIT_TURNS_H

#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace vcg::fcd {

/// A motion of a surface, and how badly it then lies on its target.
struct Alignment {
    Eigen::Affine3d motion;
    /// Mean distance of the nearest two thirds, frame units: of the surface from the target, or of the target from the
    /// surface, which is smaller, as each may lack a part of the other.
    double misfit;
};

/// Lays a surface onto a target from all sides, rigidly: closest points of both with robust weights, point to plane
/// (P. Besl, N. McKay 1992; Y. Chen, G. Medioni 1992), from starts that are at most 45 degrees from any rotation. The
/// middles of parts lie elsewhere, so each starts at three places along the target, too.
class FitTurns {
  public:
    /// \param points of equal area, frame units \param normal of each, of length 1 or 0; empty: unknown
    FitTurns(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
             const FitTarget &target);

    /// How badly it lies after a rigid motion.
    double Misfit(const Eigen::Affine3d &motion) const { return Misfit(motion, 1); }

    /// The best motions with a scale, best first, each turned by 30 degrees or more against those before.
    /// \param start motions without a scale to begin from, too
    std::vector<Alignment> Best(double scale, std::vector<Eigen::Affine3d> start, unsigned threads) const;

  private:
    /// One of the two surfaces.
    struct Side {
        std::vector<Eigen::Vector3d> place, normal; // normal 0: unknown
        std::vector<char> isOriented;               // 0: the normal may point inwards
        std::size_t stride;                         // every so many are looked at
        std::unique_ptr<PointTree<double>> tree;    // none: there is no place
        Eigen::Vector3d middle;
        std::size_t Count() const { return (place.size() + stride - 1) / stride; }
    };
    static Side Prepared(std::vector<Eigen::Vector3d> place);
    static double MeanFar(const Side &from, const Side &to, const Eigen::Affine3d &motion, double scale);
    double Misfit(const Eigen::Affine3d &motion, double scale) const;
    Alignment Nearer(Alignment alignment, double scale, int rounds) const;

    Side source, target;
    Eigen::Vector3d mainAxis; // the target's, as long as the standard deviation of its points
};

} // namespace vcg::fcd

#endif
