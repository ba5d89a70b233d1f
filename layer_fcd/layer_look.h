// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_LOOK_H
#define FCD_LAYER_LOOK_H

#include <vcg_ext/sequence/surface_look.h> // before Qt

#include "parameters.h"

/// What \p layer looks like, for a file: its own colours, not those of tags; texture coordinates of its corners, or
/// else of its vertices; and its textures, each the bytes of its PNG or JPEG file, or a PNG of what the layer holds
/// where that is something else. One that cannot be read is told to \p remark and has no content.
vcg::fcd::SurfaceLook lookOf(const MeshDocument &document, const MeshModel &layer, const Remark &remark);

#endif
