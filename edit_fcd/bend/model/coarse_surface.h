// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_COARSE_SURFACE_H
#define FCD_BEND_COARSE_SURFACE_H

#include <vcg_ext/surface/surface_graph.h>

#include <memory>

/// A surface of fewer nodes: those that hang together within a cell of a grid are one, at their middle; what is near
/// but not connected stays apart. As much of it is filled as of a SurfaceGraph that BendReach reads. \param most about
/// so many nodes \return null where there is nothing to gain
std::unique_ptr<vcg::fcd::SurfaceGraph> coarseOf(const vcg::fcd::SurfaceGraph &fine, vcg::fcd::Index most);

#endif
