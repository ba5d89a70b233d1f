// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_NUMBER_H
#define VCG_FCD_PATCH_NUMBER_H

namespace vcg::fcd {

/// The number of patches of the rough graph that the first estimate is made with, and the least automatic number. With
/// a quarter of them, a limb has hardly a node, and the estimate means little.
constexpr int fewPatches = 100;

/// An estimate holds up to this many times the patches that it was made with; for more, it is made again. On thin, torn
/// or folded surfaces it is low at first, and falls more slowly than elsewhere.
constexpr int believedPatches = 4;

/// The largest automatic number: an estimate that does not fall would ask for ever more. It makes about 2000 nodes,
/// whose poses take a twentieth of a second; a drag may take no longer.
constexpr int mostPatches = 1500;

/// How much one more patch has to lower the error, as a fraction of the diagonal: a hundred patches, by 0.04 %. In the
/// mean over the training half of the benchmark (docs/comparison.md), this makes as many nodes as 300 patches for each
/// case.
constexpr double leastGain = 4.2e-6;

/// The automatic number of patches: more are added as long as one more lowers the error by \p gain.
///
/// The error falls with the number to the power of 3/4 (errorOrder), so the number rises with the error to the power of
/// 4/7. With one gain for several surfaces, the sum of their errors is the least for the sum of their patches. A number
/// below the usual one (GraphParam::Patches) is replaced by its geometric mean with that: a low estimate may be chance,
/// and poses may ask for more than the turns that it is made with.
/// \param patches number that \p error was estimated with
/// \param error DiscretisationError over the diagonal; NaN: unknown, and the number is the usual one
/// \return from fewPatches to \p most, or \p most if that is less
int PatchesFor(int patches, double error, int most = mostPatches, double gain = leastGain);

} // namespace vcg::fcd

#endif
