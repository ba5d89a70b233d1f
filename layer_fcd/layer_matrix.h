// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_MATRIX_H
#define FCD_LAYER_MATRIX_H

#include "meshlab_host.h"

#include <Eigen/Geometry>

#include <optional>
#include <vector>

/// The matrix of \p layer, from its coordinates to the world. \throw vcg::fcd::Error it is not finite, or not affine
Eigen::Affine3d matrixOf(const MeshModel &layer);

/// The same. \throw vcg::fcd::Error as matrixOf, or it has no inverse
Eigen::Affine3d invertibleMatrixOf(const MeshModel &layer);

/// The linear part of the matrix of \p layer; the identity if it has no inverse.
Eigen::Matrix3d metricOf(const MeshModel &layer);

/// The motion that takes the matrix of \p layer to that of \p other. \throw vcg::fcd::Error as invertibleMatrixOf
Eigen::Matrix4d motionTo(const MeshModel &other, const MeshModel &layer);

/// The positions of the live vertices of \p layer in the coordinates of one with the matrix \p to, 3 x k.
/// \throw vcg::fcd::Error as matrixOf
Eigen::Matrix3Xd positionsIn(const Eigen::Affine3d &to, const MeshModel &layer);

/// The invertible affine map that takes each point of \p from to that of \p to, up to rounding.
/// \param rounding of a coordinate, over the numbers that it is the sum of
/// \return none if there is none, or if the points do not determine it: on a line, or in a plane that was stretched
std::optional<Eigen::Affine3d> affineMapOf(const std::vector<Eigen::Vector3d> &from,
                                           const std::vector<Eigen::Vector3d> &to, double rounding);

#endif
