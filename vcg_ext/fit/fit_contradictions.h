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
    std::size_t landmark; ///< its number, from 0
    double strain;        ///< of the surface between it and the next landmark; see tornStrain
};

/// Finds the landmarks that the others contradict. The surface follows all landmarks, as rigidly as possible. Measured
/// is the strain, between a landmark and the next one, that goes if the landmark is left out. The worst is left out,
/// then the next worst is looked for, so that two swapped ones do not support each other. In the end, those that strain
/// the surface hardly more than the rest does are not reported.
/// \param isFree flags of the graph's nodes \param marks the landmarks on the surface
/// \param place their targets, frame units \param least strain that counts: see tornStrain
/// \param tolerance distance from its target within which a landmark is met, frame units \param pose to begin with
/// \return ascending; none if there are fewer than five landmarks, or if more than a third would be contradicted: then
/// it is open which are wrong
/// \throw Unsolvable the fit's system cannot be factorised \throw Cancelled
std::vector<Contradiction> Contradictions(const RegionDeformer &deformer, const std::vector<char> &isFree,
                                          const FitSamples &marks, const std::vector<Eigen::Vector3d> &place,
                                          double least, double tolerance, double smoothness, GraphPose pose,
                                          const Progress &progress);

/// The strain of a surface that is stretched to twice its length, or pressed to nothing, between a landmark and the
/// next one. (The root of 2, since Eq. 2 counts each edge from both ends.)
constexpr double tornStrain = 1.4142135623730951;
/// Of the diagonal: a hand that places landmarks misses by less.
constexpr double noHand = 0.01;

} // namespace vcg::fcd

#endif
