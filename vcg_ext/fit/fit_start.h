// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_START_H
#define VCG_FCD_FIT_START_H

#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace vcg::fcd {

/// The rms extent of points across their main direction over that along it, [0, 1]: 0 on a line, and for fewer than
/// three points.
double AcrossALine(const std::vector<Eigen::Vector3d> &points);

/// The rigid motion, or similarity, that takes \p from nearest to \p to (Umeyama 1991).
/// \throw BadInput fewer than three points, or all on a line
Eigen::Affine3d StartFromLandmarks(const std::vector<Eigen::Vector3d> &from, const std::vector<Eigen::Vector3d> &to,
                                   bool similar);

/// 24 rigid motions take middle and principal axes of \p points onto those of the target. The one with the least
/// distance of the nearest four fifths of the points. \param points, normal frame units; normal 0: unknown
Eigen::Affine3d StartFromAxes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads);

/// The motion that brings points to a far target: middle onto middle, with the rotation of StartFromAxes only if that
/// fits far better. \param isSure out: false if another rotation fits nearly as well
Eigen::Affine3d StartFromAfar(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads, bool &isSure);

/// A start to try instead of the present position.
struct OtherStart {
    Eigen::Affine3d motion;
    bool isNearer; ///< so, the surface at rest lies far nearer to the target than after the fit's motion
};

/// Starts to try instead of the present position: the best motions of FitTurns; and, if the target has another radius,
/// also scaled, and scaled without a rotation. \param points, normal as in StartFromAxes \param reached the motion of
/// most of the surface in the fit from the present position \param isPressed that fit is strained; if not, there are
/// starts only if one of them is nearer
std::vector<OtherStart> OtherStarts(const std::vector<Eigen::Vector3d> &points,
                                    const std::vector<Eigen::Vector3d> &normal, const FitTarget &target,
                                    const Eigen::Affine3d &reached, bool isPressed, unsigned threads);

/// The rms strain of a graph's edges in a pose: the square root of the first part of Eq. 2, over its value if all edges
/// shrank to nothing. \param share of each node that counts, [0, 1]: edges count by those of both ends; empty: all
/// count
double StrainOf(const RegionDeformer &deformer, const GraphPose &pose, const std::vector<double> &share = {});

/// The factor by which a graph's edges have grown in a pose beyond its maps: the one that leaves the least strain; 1 if
/// there are no edges. \param share as in StrainOf
double GrowthOf(const RegionDeformer &deformer, const GraphPose &pose, const std::vector<double> &share = {});

/// The motion with this scale that takes most points nearest to where they went: others, such as a bent limb, count
/// little (Geman and McClure 1987). \param from, to frame units
Eigen::Affine3d MotionOfMost(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to, double scale);

/// A pose whose maps are scaled, while the nodes stay.
GraphPose Grown(GraphPose pose, double growth);

/// A pose that is moved, and maybe scaled, as a whole.
GraphPose Moved(GraphPose pose, const Eigen::Affine3d &motion);

/// The position of points relative to a target.
struct FitPlacement {
    double apart = 0;      ///< distance of their boxes, frame units
    double median = 0;     ///< median distance of the points from the target, frame units
    double larger = 1;     ///< the target's radius over that of the points
    double flatness = 0;   ///< of the points: rms extent across their plane over that along their main direction
    bool mirrored = false; ///< the target is the mirror image: the mirrored points fit far better than rotated ones
};

/// The least distance of the mirror image of points from the target, however it is turned, over that of the points.
double MirrorMisfit(const std::vector<Eigen::Vector3d> &points, const FitTarget &target, unsigned threads);

FitPlacement PlacementOf(const std::vector<Eigen::Vector3d> &points, const FitTarget &target, unsigned threads);

} // namespace vcg::fcd

#endif
