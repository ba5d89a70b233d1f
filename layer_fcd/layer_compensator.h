// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_COMPENSATOR_H
#define FCD_LAYER_COMPENSATOR_H

#include <vcg_ext/compensate.h> // before Qt

#include "parameters.h"

#include <string>

/// What FCD: Compensate did. Lengths are in world units.
struct CompensatedLayers {
    vcg::fcd::CompensateReport report;
    double seconds = 0;
};

/// FCD: Compensate: what to print so that \p layer, the nominal part, comes out; the result is in a new layer.
/// \param remark may be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
CompensatedLayers compensateLayer(MeshDocument &document, MeshModel &layer, const CompensateLayerParam &param,
                                  const Remark &remark, const vcg::fcd::Progress &progress);

/// What became of a layer, in words.
std::string describe(const CompensatedLayers &made);

#endif
