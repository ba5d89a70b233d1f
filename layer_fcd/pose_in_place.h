// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POSE_IN_PLACE_H
#define FCD_POSE_IN_PLACE_H

#include "prepared_layers.h"
#include "rest_shape.h"

/// What all vertices of a shape sum up to.
struct ShapeSum {
    std::uint64_t shape = 0; ///< as shapeOf tells it
    vcg::Box3<Scalarm> box;

    void add(std::size_t slot, const Point3m &position);
    void add(const ShapeSum &other);
};

/// Writes the positions and normals that a pose gives to what moves. \param position, normal at rest, per vertex slot
void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose);

/// Writes a pose into the layer; what it does not move is at rest then. \return what all vertices sum up to
ShapeSum writePose(CMeshO &mesh, const RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose);

/// Gives \p layer its rest shape back, to the bit; or, with \p presentShape, makes the shape that it has the rest
/// shape. \throw vcg::fcd::Error when the layer has no rest shape
void resetPose(MeshModel &layer, bool presentShape);

#endif
