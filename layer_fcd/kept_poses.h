// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_POSES_H
#define FCD_KEPT_POSES_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/sequence/pose_sequence.h>

#include "meshlab_host.h"

#include <optional>

/// \file
/// The poses of a layer, as long as it is there: no file of MeshLab has room for them, so a table beside it keeps them.

/// Lets \p layer keep \p poses, in the place of those that it has; without any, it keeps none.
void keepPoses(const MeshDocument &document, MeshModel &layer, const vcg::fcd::PoseSequence &poses);

/// The poses that \p layer keeps, none where it has none.
std::optional<vcg::fcd::PoseSequence> posesOf(const MeshModel &layer);

#endif
