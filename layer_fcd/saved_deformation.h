// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVED_DEFORMATION_H
#define FCD_SAVED_DEFORMATION_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/field/field_sampling.h>

#include "parameters.h"

/// A deformation that was saved.
struct SavedDeformation {
    vcg::fcd::SampledField field;
    vcg::fcd::Index folded = 0; ///< vertices of the source from where there is no way back; 0 where it is not asked for
    std::size_t bytes = 0;      ///< of the file
    double seconds = 0;         ///< that it took
};

/// Writes what was done to a layer to a file, in world coordinates, or the way back from it.
/// \throw vcg::fcd::Error when the layers are not those of one deformation, the accuracy is below 0, or the file cannot
/// be written; it is then as it was \throw vcg::fcd::Cancelled
SavedDeformation saveDeformation(const SaveDeformationParam &param, const vcg::fcd::Progress &progress);

#endif
