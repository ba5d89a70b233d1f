// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_RESULTS_H
#define FCD_RESULTS_H

#include "meshlab_host.h"

#include <vector>

/// \file
/// For a person at the window (host::inWindow): what was made from what, so that one try replaces another.

/// Shows the last of \p results, if there are any, and hides the others and the \p source that they were made from.
/// Only in the window.
void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The same, and remembers what they were made from, so that another try replaces them.
void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The layer that \p layer was made from, if that is still there and \p layer has not changed since; else \p layer.
MeshModel &sourceOf(MeshDocument &document, MeshModel &layer);

/// The results made from \p source before that have not changed since, to the bit: nothing was moved, painted, tagged,
/// deleted or renamed.
std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source);

#endif
