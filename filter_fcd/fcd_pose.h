// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POSE_H
#define FCD_POSE_H

#include "fcd_layers.h"
#include "fcd_normals.h"
#include "fcd_prepared.h"
#include "fcd_rest.h"

/// What posing a layer in place did.
struct PoseResult {
    int nodes = 0, iterations = 0;
    bool converged = false;
    vcg::fcd::TagCount tags;
    bool prepared = false; ///< anew
    double secondsFind = 0, secondsPrepare = 0, secondsSolve = 0, secondsMap = 0, secondsNormals = 0;
};

/// Poses \p layer: gives its vertices the positions that the deformation of its rest shape has, and turns the normals.
/// The first time, the present shape is the rest shape, which the layer keeps from then on.
/// \throw vcg::fcd::Error when the layer was changed since its last pose, or as FCD: Deform Mesh \throw
/// vcg::fcd::Cancelled; the layer is then as it was
PoseResult poseInPlace(MeshDocument &document, MeshModel &layer, const PoseParam &param, PreparedLayers &prepared,
                       const Remark &remark, const vcg::fcd::Progress &progress);

/// Gives \p layer its rest shape back, to the bit; or, with \p presentShape, makes the shape that it has the rest
/// shape. \throw vcg::fcd::Error when the layer has no rest shape
void resetPose(MeshModel &layer, bool presentShape);

/// Begins to read what a vertex, which will soon be written, has at rest, and the vertex itself.
inline void prefetch(const Point3m &position, const Point3m &normal, const CVertexO &vertex) {
    prefetch(&position);
    prefetch(&normal);
    prefetch(&vertex);
    prefetch(reinterpret_cast<const char *>(&vertex + 1) - 1);
}

#endif
