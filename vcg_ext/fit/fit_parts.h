// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_PARTS_H
#define VCG_FCD_FIT_PARTS_H

#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_samples.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace vcg::fcd {

/// The separate parts of a surface: the components of its deformation graph. A part is led if it is matched, has a
/// landmark or is held. Other parts are carried by the led ones around them, as an eyeball by its head.
class FitParts {
  public:
    /// \param samples the \p matched ones that are matched, then landmarks and vertices on curves
    FitParts(const RegionDeformer &deformer, const FitSamples &samples, std::size_t matched);

    /// Decides again which parts are led. Matches do not lead a part if hardly any of it lies on the target apart from
    /// other parts: then they are chance.
    /// \param liesOn liesOn(sample): it lies on the target \param follows flags of the further samples that lead
    void Judge(const FitMatches &matches, const std::function<bool(std::size_t)> &liesOn,
               const std::vector<char> &follows);

    /// The number of carried parts.
    std::size_t Carried() const;
    bool IsCarried(Index node) const { return isCarried[std::size_t(partOf[node])] != 0; }
    std::vector<char> CarriedNodes() const; ///< flags of the graph's nodes; empty: none
    /// Flags of the matched samples in carried parts.
    std::vector<char> CarriedSamples() const;
    /// \p isFree without carried nodes. \param isFree flags of the graph's nodes
    std::vector<char> Led(std::vector<char> isFree) const;

    /// Moves the carried parts with the led ones around them, as stiffly as a fit begins. Each node follows the nearest
    /// led node, and all that are farther by at most the part's distance from the led ones. So a part that sits on
    /// something follows that place, and a part inside follows all around it. With a rigidity below 1, it stretches as
    /// its surroundings do. \throw Unsolvable the fit's system cannot be factorised
    void Carry(const std::vector<char> &isFree, double smoothness, double rigidity, double stiffness, GraphPose &pose,
               unsigned threads) const;

  private:
    void Decide(const std::vector<char> &isLed);

    const RegionDeformer &deformer;
    const std::size_t matched;
    std::vector<Index> partOf;   ///< of each node of the graph
    std::vector<Index> sampleOf; ///< the part of each sample; -1: none
    std::vector<char> isHeld, isCarried;
};

} // namespace vcg::fcd

#endif
