// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_MATRIX_H
#define FCD_LAYER_MATRIX_H

#include "meshlab_host.h"

#include <Eigen/Geometry>

/// The matrix of \p layer, which leads from its coordinates to those of the world. \throw vcg::fcd::Error when it is
/// not finite, or not affine
Eigen::Affine3d matrixOf(const MeshModel &layer);

/// The same, for where the way back is needed. \throw vcg::fcd::Error also when it has no inverse
Eigen::Affine3d invertibleMatrixOf(const MeshModel &layer);

/// The linear part of the matrix of \p layer, by which lengths are measured; the identity where it has no inverse.
Eigen::Matrix3d metricOf(const MeshModel &layer);

/// The motion from where \p layer lies to where \p other does. \throw vcg::fcd::Error as above
Eigen::Matrix4d motionTo(const MeshModel &other, const MeshModel &layer);

#endif
