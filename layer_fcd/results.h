// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_RESULTS_H
#define FCD_RESULTS_H

#include "meshlab_host.h"

#include <vector>

/// \file
/// Results of filters in the window (host::inWindow), and their sources, so that one try replaces another.

/// Shows the last of \p results, if there are any, and hides the others and their \p source. Only in the window.
void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The same, and remembers the source, so that another try replaces the results.
void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The source of \p layer, if it still exists and \p layer has not changed since; else \p layer.
MeshModel &sourceOf(MeshDocument &document, MeshModel &layer);

/// The earlier results of \p source that have not changed since, to the bit: nothing was moved, painted, tagged,
/// deleted or renamed.
std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source);

#endif
