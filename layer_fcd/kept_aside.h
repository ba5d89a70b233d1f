// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_ASIDE_H
#define FCD_KEPT_ASIDE_H

#include "meshlab_host.h"

#include <vector>

/// \file
/// Colours and quality of a layer, kept aside while tags stand in their place (kept_scan.h). They are known vertex by
/// vertex: what something else has coloured since is not that of tags; what it has made lies on the surface that is
/// kept, or is not known.

/// Keeps what tags are going to replace: colours if \p color, quality if \p quality. Colours and quality of earlier
/// tags are not kept; what those replaced stays kept.
void keepAside(const MeshDocument &document, MeshModel &layer, bool color, bool quality);

/// Remembers the tags that \p layer has got: their colours if \p color, themselves if they are its quality; after each
/// keepAside(). \param tag one per vertex slot
void takeTags(const MeshModel &layer, const std::vector<int> &tag, bool color, bool quality);

/// How many vertices...
struct BroughtBack {
    int others = 0; ///< keep what they have
    int placed = 0; ///< are new, and have what was at their place
};

/// Drops the marks of \p layer, gives its vertices back what is kept aside, and forgets it. Where there was none, none
/// is left. Vertices that something else has given other colours or another quality than tags keep what they have, and
/// so do those that it has made, unless something is kept of their place. \throw vcg::fcd::Error when nothing is kept
BroughtBack bringBack(const MeshDocument &document, MeshModel &layer);

/// Gives \p copy, of the live vertices of \p layer, the colours and the quality that \p layer keeps aside. Where it had
/// no colours, the copy has none; where it had no quality, the copy has the tags.
void bringBackTo(const MeshDocument &document, MeshModel &copy, const MeshModel &layer);

/// The colours of the vertex slots of \p layer that bringBackTo gives a copy; empty: it has none.
std::vector<vcg::Color4b> ownColors(const MeshDocument &document, const MeshModel &layer);

#endif
