// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_GIZMO_DRAWING_H
#define FCD_GIZMO_DRAWING_H

#include "edit_fcd/bend/tool/drag.h"
#include "edit_fcd/bend/model/session.h"

const float dotPixels = 9; ///< of a point handle, as it is drawn

/// A part of the gizmo of a handle: the ball in its middle, an arrow that moves it along an axis, or a ring that turns
/// it.
struct GizmoPart {
    BendDrag::Kind kind = BendDrag::Move;
    int axis = -1; ///< -1: the ball

    bool operator==(const GizmoPart &other) const { return kind == other.kind && axis == other.axis; }
};

/// Where a gizmo is, and its axes, as columns of length 1; world.
struct Gizmo {
    Eigen::Vector3d center;
    Eigen::Matrix3d axes;
};

/// The part of the gizmo that is hit at \p window.
std::optional<GizmoPart> gizmoAt(const Camera &view, const Gizmo &gizmo, const Eigen::Vector2d &window);

/// Draws, over what is there, point handles and what they reach, and a light on one of the handles. \param drag may be
/// null \param lit 0: none
void drawPoints(const BendSession &session, const BendDrag *drag, int lit);
/// Draws where something would turn.
void drawPivot(const Eigen::Vector3d &place);
/// Draws the gizmo. \param drag may be null \param lit the part under the mouse
void drawGizmo(const Camera &view, const Gizmo &gizmo, const BendDrag *drag, const std::optional<GizmoPart> &lit);
/// Draws points that a line is given by, the first one larger, and the line that is used, or, while that is not known,
/// what leads through the points. \param points 3 x n \param way 3 x m, places of the line; both in the world
void drawLine(const Eigen::Matrix3Xd &points, const Eigen::Matrix3Xd &way);

#endif
