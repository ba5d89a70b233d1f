// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LINE_SURFACE_H
#define FCD_LINE_SURFACE_H

#include <vcg_ext/straighten.h> // before Qt

#include "prepared_layers.h"

#include <memory>
#include <vector>

/// The surface of a layer that is straightened, as it was when it was read: nothing here needs the layer any more.
struct LineSurface {
    Eigen::Affine3d world; ///< the layer's matrix
    vcg::fcd::SurfaceArrays arrays;
    std::vector<Point3m> normal;        ///< of each vertex slot
    bool hasDirections;                 ///< as ::hasDirections tells it
    vcg::fcd::Handles handles;          ///< all is free
    std::shared_ptr<Prepared> prepared; ///< null: not yet

    /// Reads it. \throw vcg::fcd::Error a matrix without an inverse \throw vcg::fcd::Cancelled
    explicit LineSurface(const MeshModel &layer, const vcg::fcd::Progress &progress = {});

    /// Whether another one is the same, to the bit.
    bool isSame(const LineSurface &other) const;
    /// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled
    void prepare(const vcg::fcd::StraightenParam &param, const vcg::fcd::Progress &progress);
};

#endif
