// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAG_SOURCES_H
#define FCD_TAG_SOURCES_H

#include "parameters.h"

#include <vector>

/// The tags of \p layer, one per vertex slot. If nothing is tagged, all is free with point handles or param.mayLack.
/// \throw vcg::fcd::Error they cannot be read
std::vector<int> readTags(const MeshModel &layer, const HandleParam &param);

/// Whether \p layer has marks, or a quality that may be tags: whole numbers that no filter here has measured.
bool mayHaveTags(const MeshModel &layer);

/// Tags (one per vertex slot) and point handles of \p layer, without motions.
/// \param rest positions per vertex slot; null: the layer is at rest \throw vcg::fcd::Error they cannot be read
vcg::fcd::Handles readHandles(const MeshModel &layer, const Point3m *rest, const HandleParam &param,
                              const Remark &remark);

#endif
