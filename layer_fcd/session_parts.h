// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_PARTS_H
#define FCD_SESSION_PARTS_H

#include "session_format.h"

#include <vector>

/// \file
/// The parts of a session (session_file.h): shapes, what tags replaced, and the settings of the tools.

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

QCborMap mapOf(const ToolState &tool);
/// Reads the settings of FCD: Bend, without the shape; null if the session has none.
/// \throw vcg::fcd::Error what is wrong with the file, or with the tool's text, with its line; or the layer has another
/// matrix
std::shared_ptr<ToolState> toolOf(const Reader &from, const MeshModel &layer, const QString &file);

/// The pairs of FCD: Fit; an end at a deleted vertex is left out.
QCborArray arrayOf(const std::vector<FitPair> &pairs, const LiveVertices &live);
/// The options of FCD: Fit, and the weights that are painted on the layer.
QCborMap mapOf(const FitToolState &fit, const MeshModel &layer, const LiveVertices &live);
/// Reads the pairs and options of FCD: Fit, without the shape; null if the session has neither.
/// \throw vcg::fcd::Error what is wrong with the file; or the layer is fitted, and has another matrix
std::shared_ptr<FitToolState> fitOf(const Reader &from, const LiveVertices &live, const MeshModel &layer,
                                    const QString &file);
/// The painted weights, one per vertex slot; empty: none. \throw vcg::fcd::Error what is wrong with the file
std::vector<float> paintedOf(const Reader &from, const LiveVertices &live);

/// A list, in words, of the settings of FCD: Fit that do not suit the layers of the document; or empty.
std::string unfitOf(const FitToolState &fit, const MeshDocument &document, const MeshModel &layer);

#endif
