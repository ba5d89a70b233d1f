// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVED_DEFORMATION_H
#define FCD_SAVED_DEFORMATION_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/field/field_sampling.h>

#include "parameters.h"

/// Writes what was done to a layer to a file, in world coordinates.
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be written; it is then
/// as it was \throw vcg::fcd::Cancelled
vcg::fcd::SampledField saveDeformation(const SaveDeformationParam &param, const vcg::fcd::Progress &progress);

#endif
