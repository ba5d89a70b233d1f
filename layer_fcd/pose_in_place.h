// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POSE_IN_PLACE_H
#define FCD_POSE_IN_PLACE_H

#include "parameters.h"
#include "prepared_layers.h"
#include "rest_shape.h"

/// Writes the positions and normals that a pose gives to what moves. \param position, normal at rest, per vertex slot
void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose);

/// Writes a pose into the layer, and its box; what it does not move is at rest then, and so are all normals if nothing
/// moves. \param turnNormals those of what moves; otherwise they are left as they were
/// \return whether anything moved
bool writePose(CMeshO &mesh, RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose,
               bool turnNormals);

/// Gives \p layer its rest shape back, to the bit, or, where it has that already, the one before; or the first of all;
/// or makes the shape that it has the rest shape. \throw vcg::fcd::Error when the layer has no rest shape, or not all
/// of its vertices belong to that
void resetPose(const MeshDocument &document, MeshModel &layer, const ResetPoseParam &param, const Remark &remark);

#endif
