// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SAVED_DEFORMATION_H
#define FCD_SAVED_DEFORMATION_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/field/field_sampling.h>

#include "parameters.h"

/// Writes what was done to a layer to a file, in world coordinates, or the way back from it.
/// \param folded out: vertices of the source from where there is no way back; 0 where it is not asked for
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be written; it is then
/// as it was \throw vcg::fcd::Cancelled
vcg::fcd::SampledField saveDeformation(const SaveDeformationParam &param, vcg::fcd::Index &folded,
                                       const vcg::fcd::Progress &progress);

#endif
