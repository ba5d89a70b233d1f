// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_TOOL_H
#define FCD_KEPT_TOOL_H

#include "layer_state.h"

#include <memory>
#include <string>

/// \file
/// What the tools FCD: Bend and FCD: Fit know of a layer besides its marks and poses, while they are elsewhere.

/// The layer is as the tool leaves it. \param text what the tool knows, for itself; empty: nothing \param isPosed it
/// has the pose that this makes of its rest shape; else its shape is what this begins from
void keepTool(const MeshDocument &document, MeshModel &layer, std::string text, bool isPosed);

/// Null where the tool knows nothing, or something else has changed the shape or the matrix of the layer since.
std::shared_ptr<const ToolState> toolOf(const MeshModel &layer);

/// What a layer shows of the fit by which the tool left it; Rest where something else has changed the shape or the
/// matrix since.
FitShape fitShownBy(const MeshModel &layer);

#endif
