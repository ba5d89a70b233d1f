// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SMOOTH_WARP_H
#define VCG_FCD_SMOOTH_WARP_H

#include <vcg_ext/base/progress.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace vcg::fcd {

/// A smooth deformation of space: x -> x + C b(x), where b are the monomials of x, y, z up to a degree. Low degrees
/// describe what happens to a whole shape, such as a shear, a bend or a press, but nothing local.
class SmoothWarp {
  public:
    SmoothWarp() = default; ///< the identity
    /// The identity, of a degree. \param middle, radius of the points it is for: scale their coordinates to about 1
    SmoothWarp(const Eigen::Vector3d &middle, double radius, int degree);

    Eigen::Vector3d At(const Eigen::Vector3d &p) const;
    Eigen::Matrix3d LinearAt(const Eigen::Vector3d &p) const; ///< its derivative
    /// The inverse, by Newton's method. \param near a first guess; the result where the warp has no inverse near it
    Eigen::Vector3d Back(const Eigen::Vector3d &p, const Eigen::Vector3d &near) const;
    /// The derivative of the inverse, at At(p); the identity where there is none, as at a fold.
    Eigen::Matrix3d LinearBack(const Eigen::Vector3d &p) const;

    /// b at a point. \param slope if not null, out: first derivatives, Size() x 3 \param curvature if not null, out:
    /// second derivatives by xx, yy, zz, xy, yz, zx
    Eigen::VectorXd Basis(const Eigen::Vector3d &p, Eigen::MatrixX3d *slope = nullptr,
                          Eigen::Matrix<double, Eigen::Dynamic, 6> *curvature = nullptr) const;
    Eigen::Index Size() const { return coefficient.cols(); } ///< number of monomials

    Eigen::Matrix3Xd coefficient;

    /// Calls take with all fields, for saving and reading.
    template <class Take>
    void Fields(const Take &take) {
        take(power, middle, radius, coefficient);
    }

  private:
    std::vector<Eigen::Vector3i> power; // exponents of x, y, z
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double radius = 1;
};

/// The counterpart of a place on a surface.
struct WarpMatch {
    Eigen::Vector3d point;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< of length 1; 0 if unknown
    bool isOriented = false;                          ///< the normal points outwards
    double weight = 1;                                ///< [0, 1]
};

constexpr double leastNoise = 1e-5; ///< of any data, in units of the diagonal: a tenth of the error of a good fit

/// The data of a fit: places on a surface, and their counterparts. Lengths in units of its diagonal.
struct WarpGoal {
    std::vector<Eigen::Vector3d> place, normal; ///< normals of length 1, or 0
    std::vector<double> weight;                 ///< of each place
    /// The counterpart of a place that is now at \p at. Called from several threads.
    std::function<WarpMatch(std::size_t place, const Eigen::Vector3d &at)> match;
    std::vector<Eigen::Vector3d> from, to; ///< landmarks
    double landmarkWeight = 1;             ///< of all landmarks together, over that of all matches
    double landmarkNoise = 0;              ///< least error of landmarks that is assumed
    int degree = 3;
    double typicalBending = 1; ///< expected bending, radians over the diagonal: less is preferred, so far as data allow
    double typicalStrain =
        std::numeric_limits<double>::infinity();               ///< expected change of lengths, a fraction; the same
    double farthest = std::numeric_limits<double>::infinity(); ///< farther matches do not count
    double noise = leastNoise;                                 ///< least noise that is assumed
    double rest = 0;     ///< a step at rest moves places by at most this times the misfit
    double expected = 0; ///< least distance at which a match may be an outlier
};

/// How well a warp fits.
struct WarpReport {
    double misfit = 0, misfitOfAll = 0; ///< by MisfitOf; of all that have a counterpart
    std::vector<double> share;          ///< weight of each place's match, [0, 1]
    /// With a typicalStrain: standard deviation of the warp at each place, but for a rigid motion of all.
    std::vector<double> doubt;
};

/// Finds the warp that takes places onto their counterparts, from stiff (degree 1) to soft. Each step matches anew, and
/// minimises distances point to plane, with robust weights (Geman and McClure 1987). From degree 2 on, landmarks have
/// such weights, too. The more noise is left, the less the warp bends. \throw Cancelled
SmoothWarp FitWarp(const WarpGoal &goal, const Progress &progress = {}, WarpReport *report = nullptr);

/// The distances of the places that have a counterpart (a share above 0). All of them if fewer than half have one, as
/// where a surface is in pieces that end everywhere.
std::vector<double> WithCounterpart(const std::vector<double> &far, const std::vector<double> &share);

constexpr double mostMatches = 0.8; ///< the share of the matches that tells how well they are

/// How well places match: the mean distance of the nearest of those WithCounterpart, over their part of all.
/// \param part how many of these count, (0, 1]
double MisfitOf(const std::vector<double> &far, const std::vector<double> &share, double part = mostMatches);

} // namespace vcg::fcd

#endif
