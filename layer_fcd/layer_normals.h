// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_NORMALS_H
#define FCD_NORMALS_H

#include "meshlab_host.h"

#include <vector>

/// Computes the normals of the faces that have a vertex with \p moving (flags per vertex slot; empty: all), of length
/// 1.
void computeFaceNormals(CMeshO &mesh, const std::vector<char> &moving);

/// The vertices, as flags per slot, of the faces that have one with a flag in \p moving, and these: those whose normals
/// change where they move.
std::vector<char> verticesBeside(const CMeshO &mesh, const std::vector<char> &moving);

/// Normals after the coordinates changed: the same bits as MeshModel::updateBoxAndNormals gives.
void computeNormals(CMeshO &mesh);
/// The same, and the bounding box.
void computeBoxAndNormals(CMeshO &mesh);

/// Whether more than a \p share of the vertices of faces have normals farther than \p degrees from those of the faces
/// there, weighed by area and by angle, as programs do. Some thousand settle it, if they are six standard deviations
/// from \p share; else all are asked.
bool hasOtherNormals(const MeshModel &layer, double degrees, double share);

/// Whether \p layer has normals that cannot be computed from its faces: a cloud's, or others than the faces'.
bool hasOwnNormals(const MeshModel &layer);

#endif
