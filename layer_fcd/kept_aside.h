// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_ASIDE_H
#define FCD_KEPT_ASIDE_H

#include "meshlab_host.h"

#include <vector>

/// \file
/// Colours and quality of a layer, kept aside while tags replace them (kept_scan.h). They are kept vertex by vertex, so
/// vertices that were coloured, or made, by something else since are recognised.

/// Keeps aside what tags are going to replace: colours if \p color, quality if \p quality. What earlier tags replaced
/// stays kept; the colours and quality of these tags are not.
void keepAside(const MeshDocument &document, MeshModel &layer, bool color, bool quality);

/// Call it after each keepAside(): remembers the new tags of \p layer. \param tag one per vertex slot
/// \param color, quality whether they are shown as colours, and are the layer's quality
void takeTags(const MeshModel &layer, const std::vector<int> &tag, bool color, bool quality);

/// Numbers of vertices that bringBack did not simply restore.
struct BroughtBack {
    int others = 0; ///< vertices that keep what they have
    int placed = 0; ///< new vertices, which got what was at their position
};

/// Drops the marks of \p layer, and restores the colours and quality that are kept aside, or that there were none.
/// Vertices that something else has coloured since keep what they have, and so do new vertices, unless they lie on the
/// surface that was tagged. \throw vcg::fcd::Error nothing is kept
BroughtBack bringBack(const MeshDocument &document, MeshModel &layer);

/// Gives \p copy, of the live vertices of \p layer, the colours and quality that are kept aside for \p layer. If there
/// were no colours, it has none; if there was no quality, it has the tags.
void bringBackTo(const MeshDocument &document, MeshModel &copy, const MeshModel &layer);

/// The colours that bringBackTo gives a copy, by slots of \p layer; empty: none.
std::vector<vcg::Color4b> ownColors(const MeshDocument &document, const MeshModel &layer);

#endif
