// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_CONTENTS_H
#define FCD_LAYER_CONTENTS_H

#include "meshlab_host.h"

#include <vcg_ext/base/parallel.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

/// \file
/// What a layer has.

/// body(i) for each live vertex, by all threads.
template <class Body>
void forVertices(const CMeshO &mesh, const Body &body) {
    vcg::fcd::ParallelFor(0, mesh.vert.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                body(i);
    });
}

/// The positions of the vertices of \p layer, 3 x slots.
Eigen::Matrix3Xd positionsOf(const MeshModel &layer);

/// How many bytes a file may have that holds at most \p each for a vertex of \p layer, and comments.
std::size_t mostBytes(const MeshModel &layer, std::size_t each);

/// Whether each slot of the layer's vertex vector belongs to a selected face.
std::vector<char> onSelectedFaces(const MeshModel &layer);

/// Whether \p layer has a quality that is not 0 everywhere.
bool hasQuality(const MeshModel &layer);
/// Whether that may be tags: whole numbers.
bool mayHaveTags(const MeshModel &layer);

/// Whether \p layer has normals of its own (hasOwnNormals), or principal directions, which turn with the surface.
bool hasDirections(const MeshModel &layer);

#endif
