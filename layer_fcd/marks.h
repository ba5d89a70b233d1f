// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARKS_H
#define FCD_MARKS_H

#include "layer_state.h"

#include <string>
#include <vector>

/// \file
/// What a person marks on a layer with the tool: tags that its state keeps, so that colours and quality of the layer
/// are as they are. While there are marks, they are what the layer's tags are, in place of its quality.

bool hasMarks(const MeshModel &layer);

/// The marks as tags, one per vertex slot; vertices that something else has made are free. \pre hasMarks()
std::vector<int> marksOf(const MeshModel &layer);

/// Gives \p layer marks: \p tag, one per vertex slot.
void setMarks(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag);

/// Its tags are those of its quality again.
void dropMarks(const MeshModel &layer);

/// Whether the layer is known to have tags: marks, or those that a filter for tags wrote into its quality.
bool hasTags(const MeshModel &layer);

/// The vertex attribute for the tags of what the tool did last, which are more than marks; a script finds them there,
/// also where the layer is saved with it. Whoever has an attribute of that name keeps it.
const std::string &appliedTags(const MeshDocument &document, MeshModel &layer);

/// Whether a vertex attribute, which has a name, is that one. It belongs to the layer alone.
bool isApplied(const MeshModel &layer, const std::string &attribute);

#endif
