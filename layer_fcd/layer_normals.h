// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_NORMALS_H
#define FCD_NORMALS_H

#include "meshlab_host.h"

#include <vector>

/// Computes the unit normals of the faces with a vertex in \p moving (flags per vertex slot; empty: all).
void computeFaceNormals(CMeshO &mesh, const std::vector<char> &moving);

/// Flags per slot: the vertices in \p moving and those of their faces, whose normals change if they move.
std::vector<char> verticesBeside(const CMeshO &mesh, const std::vector<char> &moving);

/// Normals after the coordinates changed: the same bits as MeshModel::updateBoxAndNormals gives.
void computeNormals(CMeshO &mesh);
/// The same, and the bounding box.
void computeBoxAndNormals(CMeshO &mesh);

/// Whether more than \p share of the vertices at faces have normals farther than \p degrees from their faces' mean,
/// both by area and by angle. Some thousand vertices decide if six standard deviations from \p share; else all.
bool hasOtherNormals(const MeshModel &layer, double degrees, double share);

/// Whether \p layer has normals that cannot be computed from its faces: those of a cloud, or others than the faces'.
bool hasOwnNormals(const MeshModel &layer);

#endif
