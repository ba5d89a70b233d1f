// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_MATCHES_H
#define VCG_FCD_FIT_MATCHES_H

#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Which matches of samples and target count, frame units.
struct MatchParam {
    double farthest = 1;   ///< a match that is farther does not count
    double edge = 0.34;    ///< cosine of the largest angle between the normals
    double spacing = 0.01; ///< of the samples
    bool bothWays = false; ///< the target draws, too, where no sample is near it
};

/// What the samples of a surface are drawn to, found anew in each step of a fit: for each its nearest place on the
/// target, and how much that counts.
///
/// The weight of a match falls with its distance as graduated robust weights do (Black and Rangarajan 1996, Zhou 2016)
/// and with the angle between the normals. One whose way back leads elsewhere does not count (as in the picky matches
/// of Godin 1994 and Zinsser 2003): something else of the surface is nearer to the place. Nor does one where the target
/// ends that is farther than they mostly are. So what has no counterpart is not drawn to what lies beside it.
///
/// Both ways: a place of the target that is not reached, as no sample is within two spacings of it, draws the nearest
/// one if that looks to the same side, so that what is thin and long is reached (both directions, as Zinsser and others
/// match).
class FitMatches {
  public:
    /// Nearer than this, of the diagonal, is as good as on the target.
    static constexpr double least = 1e-4;

    FitMatches(const FitTarget &target, const FitSamples &samples, const MatchParam &param);

    /// \param part how much of the fit has passed, [0, 1]
    /// \param pull out: of each sample, from point to plane (Chen and Medioni 1992), with the mean of both normals
    /// (Rusinkiewicz 2019)
    void Find(const GraphPose &pose, double part, unsigned threads, std::vector<FitSystem::Pull> &pull);

    /// How alike the distances from the target are, with their signs, at places some spacings from each other: their
    /// correlation, [-1, 1]. What the surface is too stiff to follow is alike at neighbouring places; noise is not.
    /// Below 0, the surface follows some of the noise. 1 where there are no such places
    double Alike();

    /// The standard deviation of the distances across the target where they count, as their median tells it (Huber
    /// 1981), frame units.
    double Noise() const;

    /// The share of the target's places that are not reached where the samples are now, [0, 1].
    double Unreached() const;

    std::size_t Size() const { return samples.Size(); }
    double Distance(std::size_t s) const { return distance[s]; }
    const Eigen::Vector3d &Place(std::size_t s) const { return match[s].point; }
    double Spacing() const { return param.spacing; }
    /// Samples that are not matched from now on. \param carried flags
    void LeaveOut(const std::vector<char> &carried);
    bool Counts(std::size_t s) const { return counts[s] != 0; }
    bool OnBorder(std::size_t s) const { return match[s].onBorder; }
    /// Whether the target's normals point to the other side than the surface's, as those of a mesh whose faces are
    /// numbered the other way round: they are taken turned over.
    bool IsInsideOut() const { return side < 0; }

  private:
    double Side() const;
    double Across(std::size_t s) const;
    void ListThoseThatCount();
    std::vector<Eigen::Vector3d> WhereTheyAre() const;
    void Search(const GraphPose &pose, unsigned threads);
    FitSystem::Pull PullOf(double weight, std::size_t s, const Eigen::Vector3d &place, const Eigen::Vector3d &n,
                           double along) const;
    double Draw(std::size_t r, std::size_t s, Eigen::Vector3d &normal) const;
    void DrawBack(std::vector<FitSystem::Pull> &pull) const;
    double Angular(const FitTarget::Match &match, std::size_t s, Eigen::Vector3d &normal) const;

    const FitTarget &target;
    const FitSamples &samples;
    const MatchParam param;
    double first = -1; // the width of the weights in the first step
    double side = 1;   // that the target's normals are taken by
    std::vector<Eigen::Vector3d> at, turned, normal;
    std::vector<double> distance, back, angular;
    std::vector<double> weight; // of each sample; 0: it is not matched
    std::vector<Index> some;    // samples that are matched
    std::vector<FitTarget::Match> match;
    std::vector<NearestPlace::Hint> hint; // from one step to the next
    std::vector<char> counts;
    std::vector<std::pair<Index, Index>> beside; // samples some spacings from each other
    const std::vector<FitTarget::Match> reach;   // of the target, what is to be reached
    std::vector<Index> reaches;                  // of each of them, the nearest sample that is matched; both ways
};

/// A part of a list, as if it were sorted; 0 of none.
double Quantile(std::vector<double> values, double part);

/// That to which most of the nearer half of some places looks: 1, or -1 for the other one.
/// \param cosine between the normals of each and of its match; 0 where a side is not known
double SideOfNearest(const std::vector<double> &distance, const std::vector<double> &cosine);

} // namespace vcg::fcd

#endif
