// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_TOOL_H
#define FCD_KEPT_TOOL_H

#include "layer_state.h"

#include <memory>
#include <string>

/// \file
/// The settings of the tools FCD: Bend and FCD: Fit for a layer, besides marks and poses, while they edit another
/// layer.

/// Keeps the settings of FCD: Bend as it leaves \p layer. \param text its settings (bend_text.h); empty: none
/// \param isPosed whether the layer has the pose of \p text; else it has the shape that the pose begins from
void keepTool(const MeshDocument &document, MeshModel &layer, std::string text, bool isPosed);

/// The settings of FCD: Bend; null if there are none, or if the layer's shape or matrix was changed since.
std::shared_ptr<const ToolState> toolOf(const MeshModel &layer);

/// The shape that FCD: Fit left the layer in; Rest if its shape or matrix was changed since.
FitShape fitShownBy(const MeshModel &layer);

#endif
