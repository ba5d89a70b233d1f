// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_OVERLAY_H
#define FCD_BEND_OVERLAY_H

#include "bend_drag.h"
#include "bend_session.h"

/// A part of the gizmo of a handle: the ball in its middle, an arrow that moves it along an axis, or a ring that turns
/// it.
struct GizmoPart {
    BendDrag::Kind kind = BendDrag::Move;
    int axis = -1; ///< -1: the ball
};

/// The part of the gizmo at \p center, world, that is hit at \p window.
std::optional<GizmoPart> gizmoAt(const BendView &view, const Eigen::Vector3d &center, const Eigen::Vector2d &window);

/// Draws, over what is there, point handles and what they reach. \param drag may be null
void drawPoints(const BendSession &session, const BendDrag *drag);
/// Draws the gizmo at \p center, world. \param drag may be null
void drawGizmo(const BendView &view, const Eigen::Vector3d &center, const BendDrag *drag);
/// Draws a polygon in the window.
void drawOutline(const BendView &view, const std::vector<Eigen::Vector2d> &polygon);

#endif
