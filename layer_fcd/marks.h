// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARKS_H
#define FCD_MARKS_H

#include "layer_state.h"

#include <string>
#include <vector>

/// \file
/// Marks: tags that a user has painted with FCD: Bend. The layer's state keeps them, so its colours and quality do not
/// change. While a layer has marks, these are its tags, not its quality.

bool hasMarks(const MeshModel &layer);

/// The marks as tags, one per vertex slot; new vertices are free. \pre hasMarks()
std::vector<int> marksOf(const MeshModel &layer);

/// Gives \p layer marks: \p tag, one per vertex slot.
void setMarks(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag);

/// Removes the marks: the tags are those of the quality again.
void dropMarks(const MeshModel &layer);

/// Whether the layer is known to have tags: marks, or those that a filter for tags wrote into its quality.
bool hasTags(const MeshModel &layer);

/// The name of the vertex attribute for the tags of the tool's last pose (marks, and what these leave fixed), for
/// scripts. It differs from the names of other attributes of the layer, and is not copied to other layers.
const std::string &appliedTags(const MeshDocument &document, MeshModel &layer);

#endif
