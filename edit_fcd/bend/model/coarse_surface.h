// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_COARSE_SURFACE_H
#define FCD_BEND_COARSE_SURFACE_H

#include <vcg_ext/surface/surface_graph.h>

#include <memory>

/// A part of a surface that keeps its nodes, while the rest is made coarser. Frame units.
struct KeptNear {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = -1; ///< none
    bool holds(const Eigen::Vector3f &p) const { return (p - middle).norm() <= radius; }
};

/// A surface of fewer nodes: those that hang together within a cell of a grid are one, at their middle; what is near
/// but not connected stays apart. As much of it is filled as of a SurfaceGraph that BendReach reads.
/// \param most about so many nodes, beside those that are kept
/// \param joinsNext each node is joined with the neighbours of its neighbours, too: ways along the middles of clusters
/// are not straight, and were a fifth too long
/// \return null where there is nothing to gain
std::unique_ptr<vcg::fcd::SurfaceGraph> coarseOf(const vcg::fcd::SurfaceGraph &fine, vcg::fcd::Index most,
                                                 bool joinsNext, const KeptNear &near = {});

#endif
