// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_START_H
#define VCG_FCD_FIT_START_H

#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace vcg::fcd {

/// How far points are from lying on a line: their extent across over that along it, root mean squares, 0 to 1. 0 for
/// fewer than three.
double AcrossALine(const std::vector<Eigen::Vector3d> &points);

/// The rigid, or similar, motion that takes points nearest to where they belong (Umeyama 1991).
/// \throw BadInput fewer than three, or all on a line
Eigen::Affine3d StartFromLandmarks(const std::vector<Eigen::Vector3d> &from, const std::vector<Eigen::Vector3d> &to,
                                   bool similar);

/// The rigid motion of the 24 that take middle and principal axes of \p points onto those of the target after which the
/// nearest four fifths of them are nearest to it. \param normal of each point; 0 where it is not known
Eigen::Affine3d StartFromAxes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads);

/// The motion that brings points to a target that they lie far from: middle onto middle, and turned as of StartFromAxes
/// only where that fits better by far. \param isSure out: false where another turn fits nearly as well
Eigen::Affine3d StartFromAfar(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads, bool &isSure);

/// Other starts than where points lie, to be judged by the fits that come of them: middle and principal axes on those
/// of the target, the nearest two of the 24 ways; and where that spreads farther or less, scaled as well, and not
/// turned. \param points, \param normal as of StartFromAxes
std::vector<Eigen::Affine3d> OtherStarts(const std::vector<Eigen::Vector3d> &points,
                                         const std::vector<Eigen::Vector3d> &normal, const FitTarget &target,
                                         unsigned threads);

/// How much the edges of a graph are strained in a pose, root mean square, of their lengths: the first part of Eq. 2
/// over what it would be if all edges were drawn together to nothing.
double StrainOf(const RegionDeformer &deformer, const GraphPose &pose);

/// A pose that is moved, and scaled, as a whole.
GraphPose Moved(GraphPose pose, const Eigen::Affine3d &motion);

/// How points lie to a target.
struct FitPlacement {
    double apart = 0;    ///< between their boxes, frame units
    double median = 0;   ///< distance of the points from the target, frame units
    double larger = 1;   ///< the target's radius over that of the points
    double flatness = 0; ///< of the points: across their plane, of how far along
    bool mirrored =
        false; ///< the target is the mirror image: mirrored, the points fit far better than in any way turned
};
FitPlacement PlacementOf(const std::vector<Eigen::Vector3d> &points, const FitTarget &target, unsigned threads);

} // namespace vcg::fcd

#endif
