// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_ASIDE_H
#define FCD_KEPT_ASIDE_H

#include "meshlab_host.h"

#include <string>

/// \file
/// Colours and quality of a layer, kept aside while tags stand in their place: as vertex attributes (fcd_color,
/// fcd_quality) that belong to the layer alone. They are known vertex by vertex: what something else has coloured
/// since, or made, is not that of tags.

/// Keeps what tags are going to replace: colours if \p color, quality if \p quality. What is there by tagging, or by
/// changing tags, is not kept: that which it replaced stays.
void keepAside(MeshModel &layer, bool color, bool quality);

/// Remembers the colours of \p layer as those of tags; after each keepAside() of colours.
void coloredByTags(const MeshModel &layer);

/// Drops the marks of \p layer, gives its vertices back what is kept aside, and forgets it. Where there was none, none
/// is left. Vertices that something else has made since, or given other colours or another quality than tags, keep what
/// they have. \return how many these are \throw vcg::fcd::Error when nothing is kept
int bringBack(MeshModel &layer);

/// Gives \p copy, of the live vertices of \p layer, the colours and the quality that \p layer keeps aside. Where it had
/// no colours, the copy has none; where it had no quality, the copy has the tags.
void bringBackTo(MeshModel &copy, const MeshModel &layer);

/// Whether a vertex attribute is one of those.
bool isAside(const std::string &attribute);

#endif
