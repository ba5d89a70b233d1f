// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_STRAIGHTENER_H
#define FCD_LAYER_STRAIGHTENER_H

#include <vcg_ext/straighten.h> // before Qt

#include "parameters.h"
#include "prepared_layers.h"

#include <memory>
#include <string>
#include <vector>

/// A copy of the surface of a layer that is straightened; the layer itself is no longer needed.
struct LineSurface {
    Eigen::Affine3d world; ///< the layer's matrix
    vcg::fcd::SurfaceArrays arrays;
    std::vector<Point3m> normal;        ///< of each vertex slot
    bool hasDirections;                 ///< as in ::hasDirections
    vcg::fcd::Handles handles;          ///< all vertices are free
    std::shared_ptr<Prepared> prepared; ///< null: not yet

    /// Reads \p layer. \throw vcg::fcd::Error its matrix has no inverse \throw vcg::fcd::Cancelled
    explicit LineSurface(const MeshModel &layer, const vcg::fcd::Progress &progress = {});

    /// Whether both are the same, to the bit.
    bool isSame(const LineSurface &other) const;
    /// \throw vcg::fcd::Error, vcg::fcd::Cancelled
    void prepare(const vcg::fcd::StraightenParam &param, const vcg::fcd::Progress &progress);
};

/// The result of FCD: Straighten Mesh.
struct StraightenedLayers {
    vcg::fcd::DeformationResult result;
    vcg::fcd::StraightenReport report;
    MeshModel *line = nullptr; ///< a new layer of the points that were given
    double seconds = 0;
};

/// The result before it is a layer.
struct StraightenedShape {
    StraightenedLayers made; ///< without layers, and time
    std::vector<float> quality;
    std::shared_ptr<const Prepared> prepared;
    vcg::fcd::Stopwatch watch;
};

/// What an earlier straightening along the same line leaves to reuse.
struct KnownLine {
    std::shared_ptr<const LineSurface> surface; ///< prepared; null: nothing to reuse
    Eigen::Matrix3Xd middle;                    ///< 3 x n, LineOf on that surface, with the middle; empty: not computed
    vcg::fcd::StraightenReport report;          ///< of that straightening
};

/// The line and its goal, from the layers and files of \p param. \throw vcg::fcd::Error
vcg::fcd::LineGoal lineGoalOf(const MeshModel &layer, const StraightenMeshParam &param);

/// Straightens the surface of a layer, which is not read, so this may run in another thread than the window's. \param
/// known of the same goal and \p param, maybe of another surface \throw vcg::fcd::Error, vcg::fcd::Cancelled
StraightenedShape straightened(LineSurface surface, vcg::fcd::LineGoal goal, const StraightenMeshParam &param,
                               const vcg::fcd::Progress &progress, const KnownLine &known = {});

/// Adds the layers of a straightened shape; before them, one with the line if it was given as points.
/// \param remark may be empty \throw vcg::fcd::Cancelled; the document is then as it was
StraightenedLayers addStraightened(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   StraightenedShape shape, const Remark &remark, const vcg::fcd::Progress &progress);

/// FCD: Straighten Mesh: straightened and addStraightened. \throw as these, and lineGoalOf
StraightenedLayers straightenLayer(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   const Remark &remark, const vcg::fcd::Progress &progress);

/// The result in words, for the log.
std::string describe(const StraightenedLayers &made);
/// Warnings about the result, a sentence each.
std::vector<std::string> warningsOf(const StraightenedLayers &made);

#endif
