// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LINE_SURFACE_H
#define FCD_LINE_SURFACE_H

#include <vcg_ext/straighten.h> // before Qt

#include "prepared_layers.h"

#include <memory>
#include <vector>

/// A copy of the surface of a layer that is straightened; the layer itself is no longer needed.
struct LineSurface {
    Eigen::Affine3d world; ///< the layer's matrix
    vcg::fcd::SurfaceArrays arrays;
    std::vector<Point3m> normal;        ///< of each vertex slot
    bool hasDirections;                 ///< as of ::hasDirections
    vcg::fcd::Handles handles;          ///< all vertices are free
    std::shared_ptr<Prepared> prepared; ///< null: not yet

    /// Reads \p layer. \throw vcg::fcd::Error its matrix has no inverse \throw vcg::fcd::Cancelled
    explicit LineSurface(const MeshModel &layer, const vcg::fcd::Progress &progress = {});

    /// Whether both are the same, to the bit.
    bool isSame(const LineSurface &other) const;
    /// \throw vcg::fcd::Error, vcg::fcd::Cancelled
    void prepare(const vcg::fcd::StraightenParam &param, const vcg::fcd::Progress &progress);
};

#endif
