// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMED_COPIES_H
#define FCD_DEFORMED_COPIES_H

#include "parameters.h"

#include <vector>

/// Adds for each of \p targets a layer that is deformed as the source was. \return how many vertices they have
/// \throw vcg::fcd::Error when the layers are not those of one deformation, or the file cannot be read
/// \throw vcg::fcd::Cancelled
int copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                    const Remark &remark, const vcg::fcd::Progress &progress);

#endif
