// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_COMPENSATOR_H
#define FCD_LAYER_COMPENSATOR_H

#include <vcg_ext/compensate.h> // before Qt

#include "parameters.h"

#include <string>

/// The result of FCD: Compensate. Lengths are in world units.
struct CompensatedLayers {
    vcg::fcd::CompensateReport report;
    double seconds = 0;
};

/// FCD: Compensate: adds a layer with the shape to print so that \p layer, the nominal part, comes out.
/// \param remark may be empty \throw vcg::fcd::Error, vcg::fcd::Cancelled; the document is then as it was
CompensatedLayers compensateLayer(MeshDocument &document, MeshModel &layer, const CompensateLayerParam &param,
                                  const Remark &remark, const vcg::fcd::Progress &progress);

/// The result in words, for the log.
std::string describe(const CompensatedLayers &made);

#endif
