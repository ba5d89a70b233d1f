// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_LOOK_H
#define FCD_LAYER_LOOK_H

#include <vcg_ext/sequence/surface_look.h> // before Qt

#include "parameters.h"

/// The look of \p layer, for a file: its own colours, not those of tags; texture coordinates of corners or, if there
/// are none, of vertices; and its textures: the bytes of a PNG or JPEG file, or a PNG of the image that the layer
/// holds, if that differs. A texture that cannot be read is reported to \p remark, and has no content.
vcg::fcd::SurfaceLook lookOf(const MeshDocument &document, const MeshModel &layer, const Remark &remark);

#endif
