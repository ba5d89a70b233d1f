// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MEASURED_QUALITY_H
#define FCD_MEASURED_QUALITY_H

#include "layer_state.h"

/// \file
/// A quality that a filter here has measured (a distance, what is matched, patches) is no tags, even if its numbers are
/// whole. Vertices that are left, and copies, are known by their quality and place.

/// Remembers that a filter here has measured the quality of \p layer. \param areTags instead, that its quality is the
/// tags of the layer that it is a result of
void keepMeasured(const MeshDocument &document, MeshModel &layer, bool areTags = false);

/// Whether a filter here has measured the quality of \p layer. Vertices may be new since, or gone; none has another.
bool isMeasured(const MeshModel &layer);

/// Lets a copy know that its quality was measured: all its vertices are at places of other layers' vertices with that
/// quality, or have 0. Or they have the qualities of another layer in their order, wherever they are.
void inheritMeasured(const MeshDocument &document, MeshModel &layer);

/// Call it before the layer of \p state is deleted: its copies know that their quality was measured.
void handDownMeasured(const MeshDocument &document, const LayerState &state);

#endif
