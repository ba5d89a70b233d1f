// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_CORRECTIONS_H
#define FCD_LAYER_CORRECTIONS_H

#include <vcg_ext/compensate.h> // these before Qt
#include <vcg_ext/symmetrize.h>

#include "parameters.h"

#include <cstddef>
#include <string>
#include <vector>

/// The result of FCD: Symmetrize.
struct SymmetrizedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::SymmetryReport report;
    std::size_t pairs = 0, midline = 0; ///< numbers of landmarks
    double before = 0, after = 0;       ///< distance from its mirror image, root mean square, world units
    double diagonal = 0;                ///< world units
    std::size_t mirrored = 0;           ///< vertices of the layer with the parts that are missing
    double seconds = 0;
};

/// FCD: Symmetrize: adds layers with \p layer made symmetric. \param remark may be empty
/// \throw vcg::fcd::Error, vcg::fcd::Cancelled; the document is then as it was
SymmetrizedLayers symmetrizeLayer(MeshDocument &document, MeshModel &layer, const SymmetrizeParam &param,
                                  const Remark &remark, const vcg::fcd::Progress &progress);

/// The result in words, for the log.
std::string describe(const SymmetrizedLayers &made);
/// Warnings about the result, a sentence each.
std::vector<std::string> warningsOf(const SymmetrizedLayers &made);

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
