// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_ENDS_H
#define VCG_FCD_FIT_ENDS_H

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// The end of a limb: its surface is farther from the rest of the surface, along it, than all that is around.
struct LimbEnd {
    std::size_t place;  ///< its number
    Eigen::Vector3d at; ///< frame units
    double remote;      ///< mean distance along the surface from places all over it, frame units
};

/// The ends of the limbs of a surface that is given by places of equal area: no triangles are asked for, so it may be a
/// cloud, unwelded or in parts. Of several parts, those of the largest.
/// \param place at least one, frame units \param normal of each; 0 where it is not known
std::vector<LimbEnd> EndsOfLimbs(const std::vector<Eigen::Vector3d> &place, const std::vector<Eigen::Vector3d> &normal);

/// Which ends of two surfaces belong together: one each, so that the sum of the squares is least of how far they are
/// from each other, and of how unlike \c remote is, which no bend changes (as in the isometric matches of Huang and
/// others 2008). What is farther than a limb is long has none.
/// \return their numbers in \p a and in \p b
std::vector<std::pair<std::size_t, std::size_t>> MatchEnds(const std::vector<LimbEnd> &a,
                                                           const std::vector<LimbEnd> &b);

} // namespace vcg::fcd

#endif
