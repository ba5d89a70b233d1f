// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_START_H
#define VCG_FCD_FIT_START_H

#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace vcg {
namespace fcd {

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

} // namespace fcd
} // namespace vcg

#endif
