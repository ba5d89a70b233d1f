// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_SYMMETRIZER_H
#define FCD_LAYER_SYMMETRIZER_H

#include <vcg_ext/symmetrize.h> // before Qt

#include "parameters.h"

#include <cstddef>
#include <string>
#include <vector>

/// What FCD: Symmetrize did.
struct SymmetrizedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::SymmetryReport report;
    std::size_t pairs = 0, midline = 0; ///< landmarks
    double before = 0, after = 0;       ///< distance from its mirror image, root mean square, world units
    double diagonal = 0;                ///< world units
    std::size_t mirrored = 0;           ///< vertices of the layer with what is missing
    double seconds = 0;
};

/// FCD: Symmetrize: restores the symmetry of \p layer; the result is in new layers. \param remark may be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
SymmetrizedLayers symmetrizeLayer(MeshDocument &document, MeshModel &layer, const SymmetrizeParam &param,
                                  const Remark &remark, const vcg::fcd::Progress &progress);

/// What became of a layer, in words.
std::string describe(const SymmetrizedLayers &made);
/// A sentence for each thing that is probably not meant.
std::vector<std::string> warningsOf(const SymmetrizedLayers &made);

#endif
