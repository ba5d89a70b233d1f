// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAG_SOURCES_H
#define FCD_TAG_SOURCES_H

#include "parameters.h"

#include <string>
#include <vector>

/// The tags of \p layer, one per vertex slot. If nothing is tagged, all is free with point handles or param.mayLack.
/// \throw vcg::fcd::Error they cannot be read
std::vector<int> readTags(const MeshModel &layer, const HandleParam &param);

/// Whether \p layer has marks, or a quality that may be tags: whole numbers that no filter here has measured.
bool mayHaveTags(const MeshModel &layer);

/// Tells that a quality counts as \p tag (one per vertex slot), unless a filter here made it, or all are free.
/// \param remedy what to do if it is something else, without a full stop
void tellTakenForTags(const MeshModel &layer, const std::vector<int> &tag, const std::string &remedy,
                      const Remark &remark);

/// Tells what is doubtful about \p tag, which readTags took from the quality.
void tellOfTags(const MeshModel &layer, const HandleParam &param, const std::vector<int> &tag, const Remark &remark);

#endif
