// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMATION_USES_H
#define FCD_DEFORMATION_USES_H

#include <vcg_ext/field/field_sampling.h> // before Qt

#include "parameters.h"

#include <string>
#include <vector>

/// The result of copyDeformation.
struct DeformedCopies {
    int vertices = 0;                  ///< of all new layers
    std::vector<std::string> warnings; ///< about layers that lie elsewhere than the source, or have another size
};

/// Adds a layer for each of \p targets that is deformed as the source was.
/// \throw vcg::fcd::Error the layers are not those of one deformation, or the file cannot be read
/// \throw vcg::fcd::Cancelled
DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const vcg::fcd::Progress &progress);

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
