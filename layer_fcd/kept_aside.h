// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_ASIDE_H
#define FCD_KEPT_ASIDE_H

#include "meshlab_host.h"

#include <string>

/// \file
/// Colours and quality of a layer, kept aside while tags stand in their place: as vertex attributes (fcd_color,
/// fcd_quality) that belong to the layer alone.

/// Keeps what tags are going to replace: colours if \p color, quality if \p quality. What is there by tagging, or by
/// changing tags, is not kept: that which it replaced stays.
void keepAside(MeshModel &layer, bool color, bool quality);

/// Remembers the colours and the quality of \p layer as those of tags; after each keepAside().
void coloredByTags(const MeshModel &layer);

/// Gives \p layer back what is kept aside, and forgets it. Where there was none, none is left.
/// \throw vcg::fcd::Error when nothing is kept
void bringBack(MeshModel &layer);

/// Gives \p copy, of the live vertices of \p layer, the colours and the quality that \p layer keeps aside. Where it had
/// no colours, the copy has none; where it had no quality, the copy has the tags.
void bringBackTo(MeshModel &copy, const MeshModel &layer);

/// Whether a vertex attribute is one of those.
bool isAside(const std::string &attribute);

#endif
