// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_NUMBER_H
#define VCG_FCD_PATCH_NUMBER_H

namespace vcg::fcd {

/// So many patches are made roughly, to tell how many are wanted; that is no fewer. With a quarter of them, a limb has
/// hardly a node, and the estimate means little.
constexpr int fewPatches = 100;

/// An estimate is believed for so many times the patches that it was made with; for more, it is made anew with those.
/// On thin, torn or folded surfaces it is low at first and falls more slowly than elsewhere.
constexpr int believedPatches = 4;

/// The largest automatic number. It makes about 2000 nodes, whose poses take a twentieth of a second: a drag may take
/// no longer. An estimate that does not fall would ask for ever more.
constexpr int mostPatches = 1500;

/// What one more patch has to lower the error by, as a fraction of the diagonal: a hundred, by 0.04 %. It makes as many
/// nodes, in the mean over the training half of the benchmark (docs/comparison.md), as 300 patches for each case.
constexpr double leastGain = 4.2e-6;

/// How many patches a surface is worth: more, as long as one more lowers its error by \p gain. The error falls with the
/// number to the power of 3 / 4 (errorOrder), and so the number rises with the error to that of 4 / 7. That way, the
/// sum of the errors of several surfaces is the least that the sum of their patches can make it: with a greater gain
/// for all, those that are off by most keep most. Below the number that does for most surfaces (GraphParam::Patches) it
/// is the geometric mean with that: an estimate that is low is so by chance, too, and poses may ask for more than the
/// turns that it is made of, such as those that press.
/// \param patches that \p error was estimated with (DiscretisationError); NaN: not known, and the number is what does
///        for most surfaces
/// \return from fewPatches to \p most, or \p most where that is less
int PatchesFor(int patches, double error, int most = mostPatches, double gain = leastGain);

} // namespace vcg::fcd

#endif
