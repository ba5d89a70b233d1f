// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_FITTER_H
#define FCD_LAYER_FITTER_H

#include "parameters.h"

#include <cstddef>
#include <vector>

/// What FCD: Fit to Layer did.
struct FittedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::FitReport report;
    double diagonal = 0;             ///< of what bends, world units
    std::size_t landmarks = 0;       ///< how many there are
    std::vector<MeshModel *> layers; ///< that are new, the fitted one last
    double seconds = 0;
};

/// FCD: Fit to Layer: lays \p layer onto another one; the result is in new layers. \param remark may be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
FittedLayers fitLayer(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
                      const vcg::fcd::Progress &progress);

#endif
