// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_PLACES_H
#define VCG_FCD_LINE_PLACES_H

#include <vcg_ext/region_deformer.h>
#include <vcg_ext/line/framed_line.h>

#include <Eigen/Geometry>
#include <vector>

/// \file
/// Where along a line the places of a surface are.

namespace vcg::fcd::detail {

/// Longer than this or shorter than its inverse, edges do not get by a bend.
constexpr double mostStretch = 2;

/// The nodes of the deformation graph, 3 x k, in the world.
Eigen::Matrix3Xd NodesOf(const RegionDeformer &deformer, const ToWorld &toWorld);

/// The places of the nodes of a graph along a line: each next to those of its neighbours, so that what is near another
/// part of the line is told from that. \param position 3 x k, in the units of the line
std::vector<double> PlacesAlong(const FramedLine &line, const Csr &adjacency, const Eigen::Matrix3Xd &position);

/// The place along a line of \p p, which is at or beside \p node of the surface.
/// \param place of each node of the deformation graph
double PlaceNear(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                 const std::vector<double> &place, Index node, const Eigen::Vector3d &p);

/// A place of the surface.
struct LineSample {
    Index node;         ///< of the surface
    double s, weight;   ///< along the line; area around it, or 1 where no node has any
    Eigen::Vector3d at; ///< in the world
};

/// \param place of each node of the deformation graph \param count about so many, however many vertices there are
/// \throw Cancelled
std::vector<LineSample> SamplesAlong(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                                     const std::vector<double> &place, Index count, const Progress &progress);

} // namespace vcg::fcd::detail

#endif
