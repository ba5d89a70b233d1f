// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARKS_H
#define FCD_MARKS_H

#include "meshlab_host.h"

#include <string>
#include <vector>

/// \file
/// What a person marks on a layer with the tool: tags in a vertex attribute of their own, so that colours and quality
/// of the layer are as they are. While there are marks, they are what the layer's tags are, in place of its quality.

bool hasMarks(const MeshModel &layer);

/// The marks as tags, one per vertex slot; vertices that something else has made are free. \pre hasMarks()
std::vector<int> marksOf(const MeshModel &layer);

/// Gives \p layer marks: \p tag, one per vertex slot.
void setMarks(MeshModel &layer, const std::vector<int> &tag);

/// Its tags are those of its quality again.
void dropMarks(MeshModel &layer);

/// The attribute for the tags of what the tool did last, which are more than marks.
const char *const appliedTags = "fcd_applied";

/// Whether a vertex attribute is one of those. They belong to the layer alone.
bool isMarks(const std::string &attribute);

#endif
