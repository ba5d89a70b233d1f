// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMATION_FILE_H
#define FCD_DEFORMATION_FILE_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/field_sampling.h>

#include "fcd_parameters.h"

/// What "FCD: Save Deformation" is asked for.
struct SaveDeformationParam {
    MeshModel *source = nullptr, *restGraph = nullptr, *deformedGraph = nullptr;
    QString file; ///< .ply

    /// \throw vcg::fcd::Error
    void validate() const;
};

/// The parameters of the filter as the host shows them.
RichParameterList toRichParameters(const SaveDeformationParam &param, const MeshDocument &document);

/// The way back. \throw vcg::fcd::Error when a value makes no sense
SaveDeformationParam saveDeformationParam(const RichParameterList &list, const MeshDocument &document);

/// Writes what was done to a layer to a file, in world coordinates.
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be written; it is then
/// as it was \throw vcg::fcd::Cancelled
vcg::fcd::SampledField saveDeformation(const SaveDeformationParam &param, const vcg::fcd::Progress &progress);

#endif
