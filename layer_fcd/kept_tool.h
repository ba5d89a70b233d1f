// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_TOOL_H
#define FCD_KEPT_TOOL_H

#include "layer_state.h"

#include <memory>
#include <string>
#include <vector>

/// \file
/// What the tools FCD: Bend and FCD: Fit keep of a layer while they edit another one: their settings and, as tags, the
/// marks that a user has painted. The layer's state keeps these, so its colours and quality do not change. While a
/// layer has marks, these are its tags, not its quality.

/// Keeps the settings of FCD: Bend as it leaves \p layer. \param text its settings (bend_state.h); empty: none
/// \param isPosed whether the layer has the pose of \p text; else it has the shape that the pose begins from
void keepTool(const MeshDocument &document, MeshModel &layer, std::string text, bool isPosed);

/// The settings of FCD: Bend; null if there are none, or if the layer's shape or matrix was changed since.
std::shared_ptr<const ToolState> toolOf(const MeshModel &layer);

/// The shape that FCD: Fit left the layer in; Rest if its shape or matrix was changed since.
FitShape fitShownBy(const MeshModel &layer);

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
