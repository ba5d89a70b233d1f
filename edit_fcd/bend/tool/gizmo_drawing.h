// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_GIZMO_DRAWING_H
#define FCD_GIZMO_DRAWING_H

#include "edit_fcd/bend/tool/drag.h"
#include "edit_fcd/bend/model/session.h"

#include <vector>

const float dotPixels = 9; ///< size of a point handle's dot

/// A part of a handle's gizmo: the ball in the middle, an arrow along an axis, or a ring that turns about it.
struct GizmoPart {
    BendDrag::Kind kind = BendDrag::Move;
    int axis = -1; ///< -1: the ball

    bool operator==(const GizmoPart &other) const { return kind == other.kind && axis == other.axis; }
};

/// The place of a gizmo, and its axes, as columns of length 1; world.
struct Gizmo {
    Eigen::Vector3d center;
    Eigen::Matrix3d axes;
};

/// The part of the gizmo at \p window.
std::optional<GizmoPart> gizmoAt(const Camera &view, const Gizmo &gizmo, const Eigen::Vector2d &window);

/// Draws point handles over all else. \param lit highlighted handle, 0: none
void drawPoints(const BendSession &session, int lit);
/// Draws some of the vertices that bend with handles. \param turning their tags; 0 is ignored
void drawBending(const BendSession &session, const std::vector<int> &turning);
/// Draws a pivot.
void drawPivot(const Eigen::Vector3d &place);
/// Draws the gizmo. \param drag may be null \param lit highlighted part
void drawGizmo(const Camera &view, const Gizmo &gizmo, const BendDrag *drag, const std::optional<GizmoPart> &lit);
/// Draws the points of a line, the first one larger, and the line. \param points 3 x n, world \param path 3 x m, points
/// along the line that is used, or, if that is not known yet, along the given one; world
void drawLine(const Eigen::Matrix3Xd &points, const Eigen::Matrix3Xd &path);

#endif
