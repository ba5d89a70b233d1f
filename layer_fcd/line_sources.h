// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LINE_SOURCES_H
#define FCD_LINE_SOURCES_H

#include "parameters.h"

#include <Eigen/Core>

/// The points of the line that the edges of \p layer form, 3 x n, world units.
/// \throw vcg::fcd::Error naming the layer: no edges, a branch, a ring, several lines
Eigen::Matrix3Xd readLine(const MeshModel &layer);

/// The points of \p file, in their order, 3 x n: MeshLab's picked points (.pp), or a list of points.
/// \throw vcg::fcd::Error with the file, and what is wrong in it
Eigen::Matrix3Xd readLine(const QString &file);

#endif
