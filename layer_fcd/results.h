// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_RESULTS_H
#define FCD_RESULTS_H

#include "meshlab_host.h"

#include <vector>

/// \file
/// For a person at the window (host::inWindow): what was made from what, so that one try replaces another.

/// One sees what one asked for: shows the last of \p results, if there are any, and hides the others and the \p source
/// that they were made from. Elsewhere than in the window, nothing is seen.
void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The same, and remembers what they were made from, so that another try replaces them.
void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The layer that \p layer was made from, if it is as it was made then and that is still there, or else \p layer
/// itself.
MeshModel &sourceOf(MeshDocument &document, MeshModel &layer);

/// What was made from \p source before and is, to the bit, as it was made: nothing moved, painted, tagged, deleted or
/// renamed.
std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source);

#endif
