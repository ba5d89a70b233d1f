// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMED_COPIES_H
#define FCD_DEFORMED_COPIES_H

#include "parameters.h"

#include <string>
#include <vector>

/// What copyDeformation made.
struct DeformedCopies {
    int vertices = 0;                  ///< of all new layers
    std::vector<std::string> warnings; ///< layers that are not where the source is, or of another size
};

/// Adds for each of \p targets a layer that is deformed as the source was.
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be read
/// \throw vcg::fcd::Cancelled
DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const vcg::fcd::Progress &progress);

#endif
