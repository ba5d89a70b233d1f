// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_SHAPES_H
#define FCD_SESSION_SHAPES_H

#include "session_format.h"

#include <vector>

/// \file
/// Shapes, and what tags replaced, as elements of a session (session_file.h).

Shape shapeOf(const Reader &from, const LiveVertices &live);

QCborMap mapOf(const RestState &state, const LiveVertices &live);
/// Reads it, for the vertices of a layer. \param isAtHome out: flag of each slot: the last pose put the vertex where
/// the layer has it; the caller still has to set RestState::vertex there
RestState restOf(const Reader &from, const LiveVertices &live, std::vector<char> &isAtHome);
/// A vertex that a pose has put at \p p.
PosedVertex posedAt(const Point3m &p);

QCborMap mapOf(const KeptScan &scan, const LiveVertices &live);
/// Reads it, for the vertices of a layer. \param shown the layer's shape when it was saved
KeptScan scanOf(const Reader &from, const LiveVertices &live, const Shape &shown);

#endif
