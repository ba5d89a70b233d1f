// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_LABELS_H
#define FCD_LAYER_LABELS_H

#include "meshlab_host.h"

#include <cstddef>
#include <sstream>
#include <string>

/// Words and numbers, one after the other.
template <class... Parts>
std::string inWords(const Parts &...parts) {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
}

/// 'NAME', for messages.
std::string inQuotes(const QString &name);
std::string inQuotes(const MeshModel &layer);

/// The label without the extension of a file, or what looks like one.
QString nameOf(const MeshModel &layer);

/// The path of a file in the system's encoding.
std::string pathOf(const QString &file);

/// The target, for the layer that is fitted to it. \param parameter that names it, for messages
/// \throw vcg::fcd::Error there is none, it is \p layer itself, or it has no vertices
const MeshModel &checkedTarget(const MeshModel &layer, const MeshModel *target, const std::string &parameter);

/// The first layer with that label, and vertices, besides \p layer; null: none.
const MeshModel *layerNamed(const std::string &label, const MeshDocument &document, const MeshModel &layer);

/// "1 ONE", or "3 MANY".
std::string counted(std::size_t count, const std::string &one, const std::string &many);

/// "3 triangles are flipped", the begin of a warning.
std::string trianglesFlipped(std::size_t count);

/// The label of a layer that is made from \p base: "NAME what"; "NAME what 2" if \p base is "NAME deformed", and so on.
QString labelOf(const MeshModel &base, const QString &what);

#endif
