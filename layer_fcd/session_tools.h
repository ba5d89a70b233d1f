// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_TOOLS_H
#define FCD_SESSION_TOOLS_H

#include "session_format.h"

/// \file
/// What the tools know of a layer, in a session (session_file.h).

QCborMap mapOf(const ToolState &tool);
/// The same, read, but for the shape; null where the session has none.
/// \throw vcg::fcd::Error what is wrong with the file, or with the tool's text, and in which line of that; or the layer
/// has another matrix
std::shared_ptr<ToolState> toolOf(const Reader &from, const MeshModel &layer, const QString &file);

/// The pairs of FCD: Fit; an end at a deleted vertex is left out.
QCborArray arrayOf(const std::vector<FitPair> &pairs, const LiveVertices &live);
/// And the rest of what that tool was told, with the weights that are painted on the layer.
QCborMap mapOf(const FitToolState &fit, const MeshModel &layer, const LiveVertices &live);
/// Both, read, but for the shape; null where the session has neither.
/// \throw vcg::fcd::Error what is wrong with the file; or the layer is fitted, and has another matrix
std::shared_ptr<FitToolState> fitOf(const Reader &from, const LiveVertices &live, const MeshModel &layer,
                                    const QString &file);
/// The painted weights, one per vertex slot; empty: none. \throw vcg::fcd::Error what is wrong with the file
std::vector<float> paintedOf(const Reader &from, const LiveVertices &live);

/// What FCD: Fit was told that does not go with the layers of a document; a list, or empty.
std::string unfitOf(const FitToolState &fit, const MeshDocument &document, const MeshModel &layer);

#endif
