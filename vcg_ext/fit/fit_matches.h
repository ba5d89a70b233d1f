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
    double farthest = 1;   ///< the longest match that counts
    double edge = 0.34;    ///< cosine of the largest angle between the normals
    double spacing = 0.01; ///< of the samples
    bool bothWays = false; ///< points of the target without a sample nearby draw the nearest sample
};

/// Matches samples of a surface with their nearest points on the target, anew in each step of a fit.
///
/// The weight of a match falls with its distance, as graduated robust weights do (Black and Rangarajan 1996, Zhou
/// 2016), and with the angle between the normals. A match does not count in two cases: another part of the surface is
/// nearer to its point (picky matches, Godin 1994 and Zinsser 2003), or it ends at a border of the target and is longer
/// than most. (The end of a cloud is a border if more of the surface lies beyond it than along the surface's own rim.)
/// So surface without a counterpart is not drawn to what lies beside it.
///
/// Both ways: a point of the target is not reached if no sample is within two spacings. It then draws the nearest
/// sample if that faces the same side, so that thin and long parts are reached (matches in both directions, as by
/// Zinsser).
class FitMatches {
  public:
    /// A sample nearer than this (of the diagonal) counts as on the target.
    static constexpr double least = 1e-4;

    /// \param target, samples must outlive this
    FitMatches(const FitTarget &target, const FitSamples &samples, const MatchParam &param);

    /// Matches the samples in a pose. \param part share of the fit that has passed, [0, 1]
    /// \param pull out: of each sample, from point to plane (Chen and Medioni 1992), with the mean of both normals
    /// (Rusinkiewicz 2019)
    void Find(const GraphPose &pose, double part, unsigned threads, std::vector<FitSystem::Pull> &pull);

    /// The correlation of the signed distances at samples some spacings from each other, [-1, 1]. It is high for shape
    /// that the surface is too stiff to follow, and low for noise; below 0, the surface follows some of the noise.
    /// 1 if there are no such samples.
    double Alike();

    /// The standard deviation of the distances across the target, from the median of those that count (Huber 1981),
    /// frame units.
    double Noise() const;

    /// The share of the target's points that are not reached now, [0, 1].
    double Unreached() const;

    std::size_t Size() const { return samples.Size(); }
    double Distance(std::size_t s) const { return distance[s]; }
    const Eigen::Vector3d &Place(std::size_t s) const { return match[s].point; }
    double Spacing() const { return param.spacing; }
    /// Leaves samples out from now on. \param carried flags of these
    void LeaveOut(const std::vector<char> &carried);
    bool Counts(std::size_t s) const { return counts[s] != 0; }
    bool OnBorder(std::size_t s) const { return match[s].onBorder; }
    /// Whether the target's normals point to the other side than the surface's, as those of a mesh with inverted faces,
    /// and are flipped.
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
    double first = -1; // the width of the weights in the first step; -1: no step yet
    double side = 1;   // -1: the target's normals are flipped
    // Where a cloud ends is known to about a spacing. If no more samples than lie at the surface's own rim lie beyond
    // its ends, both end in the same place, and the ends draw the rim.
    std::size_t onRim = 0;
    std::vector<Eigen::Vector3d> at, turned, normal;
    std::vector<double> distance, back, angular;
    std::vector<double> weight; // of each sample; 0: it is not matched
    std::vector<Index> some;    // samples of a weight above 0
    std::vector<FitTarget::Match> match;
    std::vector<NearestPlace::Hint> hint; // from one step to the next
    std::vector<char> counts;
    std::vector<std::pair<Index, Index>> beside; // pairs of samples for Alike
    const std::vector<FitTarget::Match> reach;   // points of the target that should be reached
    std::vector<Index> reaches;                  // with bothWays: of each of them, the nearest sample
};

/// 1 if the normals of the nearer half of some points mostly agree with their matches', else -1.
/// \param cosine between the normals of each point and its match; 0: unknown
double SideOfNearest(const std::vector<double> &distance, const std::vector<double> &cosine);

} // namespace vcg::fcd

#endif
