// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_STRAIGHTENER_H
#define FCD_LAYER_STRAIGHTENER_H

#include "parameters.h"

#include <vector>

/// What FCD: Straighten Mesh did.
struct StraightenedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::StraightenReport report;
    std::vector<MeshModel *> layers; ///< that are new, the straightened one last
    double seconds = 0;
};

/// FCD: Straighten Mesh: straightens \p layer along a line, or bends it; the result is in new layers. \param remark may
/// be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
StraightenedLayers straightenLayer(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   const Remark &remark, const vcg::fcd::Progress &progress);

#endif
