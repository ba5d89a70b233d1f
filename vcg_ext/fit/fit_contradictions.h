// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_CONTRADICTIONS_H
#define VCG_FCD_FIT_CONTRADICTIONS_H

#include <vcg_ext/fit/fit_samples.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// A landmark that the others contradict.
struct Contradiction {
    std::size_t landmark; ///< its number
    double strain;        ///< that it brings between itself and its neighbour; see tornStrain
};

/// Landmarks that the others contradict, found by leaving one out: the surface follows them as rigidly as possible, and
/// the strain that goes when it need not follow one of them, between it and its neighbour, is the measure. The worst is
/// left out, then the next is looked for, so that two that are swapped do not bear witness for each other; those that
/// strain the surface no more than the rest does are taken back.
/// \param marks the places of the landmarks on the surface \param place where each belongs, frame units
/// \param least strain that counts: see tornStrain \param tolerance so far off counts as there, frame units
/// \param pose from which the surface follows them
/// \return ascending; none of fewer than five, and a third of them at most: else nothing tells which
std::vector<Contradiction> Contradictions(const RegionDeformer &deformer, const std::vector<char> &isFree,
                                          const FitSamples &marks, const std::vector<Eigen::Vector3d> &place,
                                          double least, double tolerance, double smoothness, GraphPose pose,
                                          const Progress &progress);

/// The strain of a surface that is as long again, or gone, between a landmark and its neighbour: Eq. 2 counts each edge
/// from both ends.
constexpr double tornStrain = 1.4142135623730951;
/// Of the diagonal: no hand misses a place by so much; it took another one.
constexpr double noHand = 0.01;

} // namespace vcg::fcd

#endif
