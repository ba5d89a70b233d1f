// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TAGGING_H
#define FCD_TAGGING_H

#include "parameters.h"

#include <vector>

/// The colour that shows a tag.
vcg::Color4b colorOfTag(int tag);

/// Writes tags to \p layer. \param tag one per vertex slot \throw vcg::fcd::Error before anything is changed
vcg::fcd::TagCount writeTags(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag,
                             const TagTarget &target);

/// FCD: Tag: tags the selected vertices, and the vertices of selected faces; others keep their tags, or are free if the
/// layer has none yet. Or tags all vertices from a file. Also writes tags and motions to files, if asked for.
/// \throw vcg::fcd::Error; layer and files are then as they were
vcg::fcd::TagCount tagLayer(const MeshDocument &document, MeshModel &layer, const TagParam &param,
                            const Remark &remark);

/// Writes tags and, if asked for, motions, in world coordinates, to files. \throw vcg::fcd::Error; files are unchanged
vcg::fcd::TagCount saveTags(const MeshDocument &document, const MeshModel &layer, const SaveTagsParam &param,
                            const Remark &remark);

#endif
