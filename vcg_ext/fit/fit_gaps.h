// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_GAPS_H
#define VCG_FCD_FIT_GAPS_H

#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_samples.h>

#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// Of each node of a graph: the share of the samples it leads that count as matches, by their weights, [0, 1].
std::vector<double> MatchedShares(std::size_t nodes, const FitMatches &matches, const FitSamples &samples);

/// The gaps of a fit: surface without a counterpart that is wider than a hole. Found from the present matches.
class FitGaps {
  public:
    FitGaps(const RegionDeformer &deformer, const FitMatches &matches, const FitSamples &samples);

    /// Whether there are gaps with matched samples around them.
    bool Any() const { return !around.empty(); }
    /// The stiffness of each node of the graph: at least \p stiff in gaps, \p soft (> 0) elsewhere, and geometrically
    /// between at the rims.
    std::vector<double> Stiffness(std::vector<double> soft, double stiff) const;
    /// Rms distance from the target of the samples around the gaps that were matched at construction, frame units.
    double Misfit(const FitMatches &matches) const;
    /// How far these samples have moved, rms, frame units. \param before, now position of each sample
    double Moved(const std::vector<Eigen::Vector3d> &before, const std::vector<Eigen::Vector3d> &now) const;

  private:
    std::vector<double> gap;         ///< of each node of the graph, [0, 1]; 1: in a gap
    std::vector<std::size_t> around; ///< matched samples that nodes of gaps lead
};

} // namespace vcg::fcd

#endif
