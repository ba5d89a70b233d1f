// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_GUIDE_LINE_H
#define FCD_BEND_GUIDE_LINE_H

#include "edit_fcd/bend/model/session.h"

/// \file
/// The line that a layer is straightened along.

/// Its points in the pose, 3 x n, world, in a layer's precision.
Eigen::Matrix3Xd lineOf(const BendSession &session);
/// The same. \throw vcg::fcd::Error fewer than two points
Eigen::Matrix3Xd expectedLine(const BendSession &session);
/// \throw vcg::fcd::Error as readLine
std::vector<BendLinePoint> loadLine(const QString &file);
/// \throw vcg::fcd::Error the file cannot be written
void saveLine(const BendSession &session, const QString &file);
/// The filter call that straightens the layer like that. \param line layer with these points, or null
std::string straightenCall(const StraightenMeshParam &param, const MeshModel *line);

#endif
