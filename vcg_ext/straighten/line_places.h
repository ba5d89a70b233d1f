// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_PLACES_H
#define VCG_FCD_LINE_PLACES_H

#include <vcg_ext/region_deformer.h>
#include <vcg_ext/line/framed_line.h>

#include <Eigen/Geometry>
#include <vector>

/// \file
/// Finds the arc length s along a line for points of a surface.

namespace vcg::fcd::detail {

/// The largest stretch of an edge by a bend; its inverse is the smallest.
constexpr double mostStretch = 2;

/// The nodes of the deformation graph, 3 x k, world units.
Eigen::Matrix3Xd NodesOf(const RegionDeformer &deformer, const ToWorld &toWorld);

/// The s of each node of a graph. It is searched near those of its neighbours, so that nodes close to another part of
/// the line do not jump there. \param position 3 x k, units of the line \return k values; below 0 or above the length
/// beyond an end
std::vector<double> PlacesAlong(const FramedLine &line, const Csr &adjacency, const Eigen::Matrix3Xd &position);

/// The s of \p p, a point at or beside \p node of the surface. \param place s of each node of the deformation graph
double PlaceNear(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                 const std::vector<double> &place, Index node, const Eigen::Vector3d &p);

/// A sample of the surface.
struct LineSample {
    Index node;         ///< of the surface
    double s, weight;   ///< along the line; area around it, or 1 if no node has an area
    Eigen::Vector3d at; ///< world units
};

/// Samples of the surface. \param place s of each node of the deformation graph \param count about so many
/// \throw Cancelled
std::vector<LineSample> SamplesAlong(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                                     const std::vector<double> &place, Index count, const Progress &progress);

} // namespace vcg::fcd::detail

#endif
