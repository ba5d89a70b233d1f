// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POSE_IN_PLACE_H
#define FCD_POSE_IN_PLACE_H

#include "parameters.h"
#include "prepared_layers.h"
#include "rest_shape.h"

/// Writes the positions and normals of moving vertices. \param position, normal at rest, per vertex slot
void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose);

/// Writes a pose, and the box, into the layer. Vertices that do not move get their rest positions, and all normals are
/// at rest if nothing moves. \param turnNormals turns normals of moving vertices; otherwise they are left as they were
/// \return whether anything moves
bool writePose(CMeshO &mesh, RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose,
               bool turnNormals);

/// FCD: Reset Pose: restores the rest shape of \p layer, to the bit; the one before if it has that already; or the
/// first of all. Or makes the present shape the rest shape. \throw vcg::fcd::Error the layer has no rest shape, or not
/// all of its vertices belong to it
void resetPose(const MeshDocument &document, MeshModel &layer, const ResetPoseParam &param, const Remark &remark);

#endif
