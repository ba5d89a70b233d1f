// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_COARSE_SURFACE_H
#define FCD_BEND_COARSE_SURFACE_H

#include <vcg_ext/surface/surface_graph.h>

#include <memory>

/// A ball in which a surface keeps its nodes, frame units.
struct KeptNear {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = -1; ///< negative: none
    bool holds(const Eigen::Vector3f &p) const { return (p - middle).norm() <= radius; }
};

/// A coarser surface: nodes that are connected within a cell of a grid become one, at their middle. Close parts that
/// are not connected stay apart. Only members that BendReach reads are set.
/// \param most about so many nodes, beside those of \p near
/// \return null if it would not be smaller
std::unique_ptr<vcg::fcd::SurfaceGraph> coarseOf(const vcg::fcd::SurfaceGraph &fine, vcg::fcd::Index most,
                                                 const KeptNear &near = {});

#endif
