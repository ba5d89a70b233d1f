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

/// A smooth deformation of space: x -> x + C b(x), where b are the products of coordinates up to a degree. What a whole
/// shape has been through, such as a shear, a bend or a press, is one of low degree; nothing local is.
class SmoothWarp {
  public:
    SmoothWarp() = default; ///< moves nothing
    /// \param middle, radius of the places it is for, so that these have coordinates of some 1
    SmoothWarp(const Eigen::Vector3d &middle, double radius, int degree);

    Eigen::Vector3d At(const Eigen::Vector3d &p) const;
    Eigen::Matrix3d LinearAt(const Eigen::Vector3d &p) const; ///< its derivative
    /// Where it comes from, by Newton's method. \param near a place near that
    Eigen::Vector3d Back(const Eigen::Vector3d &p, const Eigen::Vector3d &near) const;

    /// b at a place. \param slope if given: its derivatives, 3 columns \param curvature if given: its second ones by
    /// xx, yy, zz, xy, yz, zx, 6 columns
    Eigen::VectorXd Basis(const Eigen::Vector3d &p, Eigen::MatrixX3d *slope = nullptr,
                          Eigen::Matrix<double, Eigen::Dynamic, 6> *curvature = nullptr) const;
    Eigen::Index Size() const { return coefficient.cols(); } ///< of b

    Eigen::Matrix3Xd coefficient;

    /// All that it is. \param take gets the fields
    template <class Take>
    void Fields(const Take &take) {
        take(power, middle, radius, coefficient);
    }

  private:
    std::vector<Eigen::Vector3i> power; // exponents of x, y, z
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double radius = 1;
};

/// What a place of a surface is drawn to.
struct WarpMatch {
    Eigen::Vector3d point;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< of length 1; 0 where it is not known
    bool isOriented = false;                          ///< the normal points outwards
    double weight = 1;                                ///< how much it counts, [0, 1]
};

/// Places of a surface, and what they are to be taken to; lengths in units of its diagonal.
struct WarpGoal {
    std::vector<Eigen::Vector3d> place, normal; ///< normals of length 1, or 0
    std::vector<double> weight;                 ///< of each place
    /// The counterpart of a place that was taken there. Called from any thread.
    std::function<WarpMatch(std::size_t place, const Eigen::Vector3d &at)> match;
    std::vector<Eigen::Vector3d> from, to; ///< landmarks
    double landmarkWeight = 1;             ///< of all of them, beside that of all places
    int degree = 3;
    double typicalBending = 1; ///< of what was warped, radians over the diagonal: what the data leave open bends less
    double typicalStrain = std::numeric_limits<double>::infinity(); ///< the same of lengths, as a part of them
    double farthest = std::numeric_limits<double>::infinity();      ///< a match that is farther does not count
    double noise = 1e-5;                                            ///< at least, however near the matches are
    double expected = 0; ///< nearer than this, a match is no outlier, however near the others are
};

/// How a warp lies on what it was fitted to.
struct WarpReport {
    double misfit = 0;         ///< mean distance of the nearest four fifths
    std::vector<double> share; ///< of each place: how much its match counts, [0, 1]
};

/// The warp that takes places onto their counterparts, which are found anew in each step, from stiff (degree 1) to
/// soft: point to plane, with robust weights (Geman and McClure 1987). The more noise is left, the less it bends.
/// \throw Cancelled
SmoothWarp FitWarp(const WarpGoal &goal, const Progress &progress = {}, WarpReport *report = nullptr);

/// The mean over the least four fifths.
double MeanOfMost(std::vector<double> far);

} // namespace vcg::fcd

#endif
