// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_PARTS_H
#define VCG_FCD_FIT_PARTS_H

#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_samples.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace vcg::fcd {

/// The separate parts of a surface, as its deformation graph has them. What is matched, has a landmark or is held is
/// led by that. A part that nothing leads is carried by those around it: by what it belongs to or lies in, as an
/// eyeball by its head.
class FitParts {
  public:
    /// \param samples those that are matched come first, \p matched of them; the others are landmarks
    FitParts(const RegionDeformer &deformer, const FitSamples &samples, std::size_t matched);

    /// A part of which hardly anything lies on the target, or only where another part lies as well, is not led by its
    /// matches: these are what it happened to be near.
    /// \param liesOn whether a sample has a counterpart \param follows of each landmark, whether it leads
    void Judge(const FitMatches &matches, const std::function<bool(std::size_t)> &liesOn,
               const std::vector<char> &follows);

    /// How many are carried.
    std::size_t Carried() const;
    bool IsCarried(Index node) const { return isCarried[std::size_t(partOf[std::size_t(node)])] != 0; }
    std::vector<char> CarriedNodes() const; ///< flags of the graph's nodes; empty where nothing is carried
    /// Of each sample that is matched, whether its part is carried.
    std::vector<char> CarriedSamples() const;
    /// Without what is carried. \param isFree flags of the graph's nodes
    std::vector<char> Led(std::vector<char> isFree) const;

    /// Takes what is carried to where the parts around it go, as rigidly as a fit begins: each of its nodes by what is
    /// nearest, and what is farther by no more than the part is from it. So what sits on something goes with the place
    /// where it sits, and what lies inside with all around it, and with a
    /// rigidity below 1 it stretches as that does. \throw Unsolvable
    void Carry(const std::vector<char> &isFree, double smoothness, double rigidity, double stiffness, GraphPose &pose,
               unsigned threads) const;

  private:
    void Decide(const std::vector<char> &isLed);

    const RegionDeformer &deformer;
    const std::size_t matched;
    std::vector<Index> partOf;   ///< of each node of the graph
    std::vector<Index> sampleOf; ///< of each sample: its part
    std::vector<char> isHeld, isCarried;
};

} // namespace vcg::fcd

#endif
