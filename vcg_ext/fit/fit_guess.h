// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_GUESS_H
#define VCG_FCD_FIT_GUESS_H

#include <vcg_ext/fit/fit_samples.h>

#include <functional>
#include <vector>

namespace vcg::fcd {

/// The share of a fit that is guessed: it has no counterpart, and was carried along.
struct FitGuess {
    double share = 0;          ///< of the free surface, [0, 1]
    double rms = 0;            ///< estimated error, root mean square, frame units; NaN: unknown
    std::vector<double> error; ///< the same of each node of the graph; 0 if it is not guessed
};

/// Estimates the error of what is guessed from how much the matched surface bends. A matched node that another one at
/// some distance carries rigidly would be off by some length. The estimate is twice the rms of this, at the distance
/// from the nearest matched node (a structure function, as in random fields). Beyond the distances on the matched
/// surface, it grows with the square, as a bend that goes on.
/// \param samples the matched ones, then the landmarks \param isKnown isKnown(sample): it lies on the target, or is met
/// \param isFree flags of the graph's nodes; others are known
/// \param density matched samples a frame unit^2: surface with far fewer, since it does not count, is guessed, too
FitGuess Guess(const RegionDeformer &deformer, const FitSamples &samples,
               const std::function<bool(std::size_t)> &isKnown, const std::vector<char> &isFree, double density,
               const GraphPose &pose);

} // namespace vcg::fcd

#endif
