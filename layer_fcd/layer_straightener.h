// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_STRAIGHTENER_H
#define FCD_LAYER_STRAIGHTENER_H

#include "line_surface.h"
#include "parameters.h"

#include <memory>
#include <string>
#include <vector>

/// What FCD: Straighten Mesh did.
struct StraightenedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::StraightenReport report;
    MeshModel *line = nullptr; ///< a new layer, of points that were given
    double seconds = 0;
};

/// A layer along a line, before it is a layer.
struct StraightenedShape {
    StraightenedLayers made; ///< without layers, and time
    std::vector<float> quality;
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Stopwatch watch;
};

/// What is known of a line before a layer is straightened along it.
struct KnownLine {
    std::shared_ptr<const LineSurface> surface; ///< prepared; null: nothing is known
    Eigen::Matrix3Xd middle;                    ///< 3 x n, as LineOf finds it on that surface, where it was looked for
    vcg::fcd::StraightenReport report;          ///< of the straightening
};

/// Which line goes where, from the layers and files that \p param names.
/// \throw vcg::fcd::Error each message says what to do
vcg::fcd::LineGoal lineGoalOf(const MeshModel &layer, const StraightenMeshParam &param);

/// What becomes of a layer with that goal. The layer itself is not needed, so that this may run beside the window.
/// \param surface of the layer \param known with the same goal and \p param, maybe when the layer was another surface
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled
StraightenedShape straightened(LineSurface surface, vcg::fcd::LineGoal goal, const StraightenMeshParam &param,
                               const vcg::fcd::Progress &progress, const KnownLine &known = {});

/// Puts that into new layers. A line that was given as points becomes one, too, in front of them. \param remark may be
/// empty \throw vcg::fcd::Cancelled; the document is then as it was
StraightenedLayers addStraightened(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   StraightenedShape shape, const Remark &remark, const vcg::fcd::Progress &progress);

/// FCD: Straighten Mesh: both.
StraightenedLayers straightenLayer(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   const Remark &remark, const vcg::fcd::Progress &progress);

/// How a layer was straightened, in words.
std::string describe(const StraightenedLayers &made);
/// A sentence for each thing that is probably not meant.
std::vector<std::string> warningsOf(const StraightenedLayers &made);

#endif
