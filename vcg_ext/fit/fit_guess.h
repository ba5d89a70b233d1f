// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_GUESS_H
#define VCG_FCD_FIT_GUESS_H

#include <vcg_ext/fit/fit_samples.h>

#include <functional>
#include <vector>

namespace vcg::fcd {

/// What of a fit is guessed: it has no counterpart, and was carried along.
struct FitGuess {
    double share = 0;          ///< of the free surface, [0, 1]
    double rms = 0;            ///< how far it may be off, root mean square, frame units; NaN where nothing tells
    std::vector<double> error; ///< of each node of the graph; 0 where it is not guessed
};

/// How far what is guessed may be off: the deformation that was found tells how much such surfaces bend. Each node that
/// is matched, carried rigidly by another one so far away, would be off by so much; twice the root mean square of that,
/// at the distance from the nearest node that is matched, is the estimate (a structure function, as of random fields).
/// Beyond the distances that the matched surface has, it grows with the square, as of a bend that goes on.
/// \param samples those that are matched, then the landmarks \param isKnown of each sample, whether it lies where it
/// belongs \param isFree flags of the graph's nodes; others are known \param density of the samples that are matched,
/// one a frame unit^2: where there are none, as nothing counts, is guessed, too
FitGuess Guess(const RegionDeformer &deformer, const FitSamples &samples,
               const std::function<bool(std::size_t)> &isKnown, const std::vector<char> &isFree, double density,
               const GraphPose &pose);

} // namespace vcg::fcd

#endif
