// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_AFFINE_MAP_H
#define FCD_AFFINE_MAP_H

#include <Eigen/Geometry>

#include <optional>
#include <vector>

/// The affine map that took each of some points to where it is now, where there is one with an inverse.
/// \param from, to the points, one each \param rounding of a coordinate, of the numbers that it is the sum of
/// \return none as well where the points lie on a line, or in a plane that was stretched: these tell nothing of what is
/// beside them
std::optional<Eigen::Affine3d> affineMapOf(const std::vector<Eigen::Vector3d> &from,
                                           const std::vector<Eigen::Vector3d> &to, double rounding);

#endif
