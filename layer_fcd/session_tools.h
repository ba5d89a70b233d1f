// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_TOOLS_H
#define FCD_SESSION_TOOLS_H

#include "session_format.h"

/// \file
/// The settings of the tools for a layer, in a session (session_file.h).

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
