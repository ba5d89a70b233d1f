// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMED_COPIES_H
#define FCD_DEFORMED_COPIES_H

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

#endif
