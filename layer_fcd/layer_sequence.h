// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_SEQUENCE_H
#define FCD_LAYER_SEQUENCE_H

#include "parameters.h"
#include "prepared_layers.h"

#include <vector>

/// What FCD: Pose Sequence did.
struct SequenceLayers {
    vcg::fcd::SequenceReport report;
    int poses = 0, keyFrames = 0, nodes = 0;
    vcg::fcd::TagCount tags;
    std::vector<MeshModel *> layers; ///< that are new
    double seconds = 0;
};

/// FCD: Pose Sequence: poses a layer again and again; the frames are in new layers, and files. \param remark may be
/// empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document and all files are then
/// as they were
SequenceLayers makeSequence(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers,
                            const SequenceParam &param, const Remark &remark, const vcg::fcd::Progress &progress);

#endif
