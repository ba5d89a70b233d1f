// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVED_DEFORMATION_H
#define FCD_SAVED_DEFORMATION_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/field/field_sampling.h>

#include "parameters.h"

/// The result of saveDeformation.
struct SavedDeformation {
    vcg::fcd::SampledField field;
    vcg::fcd::Index folded = 0; ///< vertices of the source without an inverse; 0 if none is saved
    std::size_t bytes = 0;      ///< size of the file
    double seconds = 0;         ///< time to save it
};

/// Writes the deformation of a layer, or its inverse, to a file, in world coordinates.
/// \throw vcg::fcd::Error the layers are not those of one deformation, the accuracy is below 0, or the file cannot be
/// written; vcg::fcd::Cancelled; the file is then as it was
SavedDeformation saveDeformation(const SaveDeformationParam &param, const Remark &remark,
                                 const vcg::fcd::Progress &progress);

#endif
