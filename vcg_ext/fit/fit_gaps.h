// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_GAPS_H
#define VCG_FCD_FIT_GAPS_H

#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_samples.h>

#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// What of a surface has no counterpart, where that is wider than a hole, and the matches of what lies around it.
class FitGaps {
  public:
    /// From the matches as they are.
    FitGaps(const RegionDeformer &deformer, const FitMatches &matches, const FitSamples &samples);

    /// Whether there is any, with something around it.
    bool Any() const { return !around.empty(); }
    /// Of each node of the graph: \p stiff in the gaps, where it is not stiffer; \p soft elsewhere, > 0;
    /// geometrically between at their rims.
    std::vector<double> Stiffness(std::vector<double> soft, double stiff) const;
    /// Root mean square distance from the target of the samples around the gaps that had a match, frame units.
    double Misfit(const FitMatches &matches) const;

  private:
    std::vector<double> gap;         ///< of each node of the graph, [0, 1]
    std::vector<std::size_t> around; ///< samples that nodes of gaps lead, and that count
};

} // namespace vcg::fcd

#endif
