// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAG_SOURCES_H
#define FCD_TAG_SOURCES_H

#include "parameters.h"

#include <vector>

/// The tags of \p layer, one per slot of its vertex vector. With point handles, or where tags may lack, all is free
/// where nothing is tagged. \throw vcg::fcd::Error when they cannot be had
std::vector<int> readTags(const MeshModel &layer, const HandleParam &param);

/// Whether \p layer has marks, or a quality that may be tags: whole numbers, and nothing that a filter here has
/// measured.
bool mayHaveTags(const MeshModel &layer);

/// Tags (per slot of the layer's vertex vector) and point handles of \p layer, without motions.
/// \param rest positions per vertex slot, null where the layer is at rest
/// \throw vcg::fcd::Error when they cannot be had: each message says what to do
vcg::fcd::Handles readHandles(const MeshModel &layer, const Point3m *rest, const HandleParam &param);

#endif
