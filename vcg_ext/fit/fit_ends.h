// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_ENDS_H
#define VCG_FCD_FIT_ENDS_H

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// The end of a limb: the point that is farther from the rest of the surface, along it, than all points around it.
struct LimbEnd {
    std::size_t place;  ///< number of the point
    Eigen::Vector3d at; ///< its position, frame units
    double remote;      ///< mean distance along the surface from points all over it, frame units
};

/// Finds the ends of limbs of a surface that is given by points of equal area: it may be a cloud, unwelded or in parts.
/// Of several parts, one is looked at: that of the middle point.
/// \param place frame units \param normal of each; 0: unknown
std::vector<LimbEnd> EndsOfLimbs(const std::vector<Eigen::Vector3d> &place, const std::vector<Eigen::Vector3d> &normal);

/// Pairs the ends of two surfaces, each at most once: the least sum of squares of their distances and of their
/// differences in \c remote, which no bend changes (as in the isometric matches of Huang and others 2008). Ends that
/// are far from all others have no counterpart. \return their indices in \p a and in \p b
std::vector<std::pair<std::size_t, std::size_t>> MatchEnds(const std::vector<LimbEnd> &a,
                                                           const std::vector<LimbEnd> &b);

} // namespace vcg::fcd

#endif
