// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAGGING_H
#define FCD_TAGGING_H

#include "parameters.h"

#include <vector>

/// The colour that shows a tag.
vcg::Color4b colorOfTag(int tag);

/// Gives \p layer the tags, one per slot of its vertices. \throw vcg::fcd::Error before anything is changed
vcg::fcd::TagCount writeTags(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag,
                             const TagTarget &target);

/// Tags the selected vertices, and the vertices of selected faces; the others keep their tags, or are free where the
/// layer has none yet. Or all vertices, as a file says. Writes the tags and motions to files, if asked for.
/// \throw vcg::fcd::Error; layer and files are then as they were
vcg::fcd::TagCount tagLayer(const MeshDocument &document, MeshModel &layer, const TagParam &param,
                            const Remark &remark);

/// Writes the tags, and the motions in world coordinates if asked for. \throw vcg::fcd::Error; the files are then as
/// they were
vcg::fcd::TagCount saveTags(const MeshDocument &document, const MeshModel &layer, const SaveTagsParam &param,
                            const Remark &remark);

#endif
