// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_NORMALS_H
#define FCD_NORMALS_H

#include "meshlab_host.h"

#include <vector>

/// Begins to read memory that is needed soon.
inline void prefetch(const void *memory) {
#ifdef __GNUC__
    __builtin_prefetch(memory);
#else
    (void)memory;
#endif
}

/// Computes the normals of the faces that have a vertex with \p moving (flags per vertex slot; empty: all), of length
/// 1.
void computeFaceNormals(CMeshO &mesh, const std::vector<char> &moving);

/// Bounding box and normals after the coordinates changed: the same bits as MeshModel::updateBoxAndNormals gives, by
/// all threads.
void computeBoxAndNormals(CMeshO &mesh);

/// Whether \p layer has normals that cannot be computed from its faces: a cloud's, or others than the faces'.
bool hasOwnNormals(const MeshModel &layer);

#endif
