// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_AFFINE_MAP_H
#define FCD_AFFINE_MAP_H

#include <Eigen/Geometry>

#include <optional>
#include <vector>

/// The invertible affine map that takes each point of \p from to that of \p to, up to rounding.
/// \param rounding of a coordinate, over the numbers that it is the sum of
/// \return none if there is none, or if the points do not determine it: on a line, or in a plane that was stretched
std::optional<Eigen::Affine3d> affineMapOf(const std::vector<Eigen::Vector3d> &from,
                                           const std::vector<Eigen::Vector3d> &to, double rounding);

#endif
