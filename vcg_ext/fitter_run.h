// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FITTER_RUN_H
#define VCG_FCD_FITTER_RUN_H

#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_curves.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_parts.h>
#include <vcg_ext/fit/fit_system.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// One fit of a surface to a target, while it runs.
class Fitter::Run {
  public:
    /// \param report out: the report of Solve; must outlive this
    /// \param progress of the first twentieth of the work
    Run(const Fitter &fitter, const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
        const Progress &progress);

    /// \throw BadInput, Unsolvable, Cancelled as Fitter::Solve
    Deformer::Pose Solve(const Progress &progress);

  private:
    // Weight of Eq. 2 over A, against the mean square of the distances. Chosen on the training half of
    // tests/fit_recipes.py (armadillo, bunny, head; posed by CGAL) and on the half tube of tests/host_fit.py: stiff
    // enough that limbs follow their roots and nothing slides along the surface, soft enough to reach the target.
    static constexpr double stiffest = 1e-2, softest = 1e-6;
    // At rest if no more than this is left to move (of the diagonal, rms): a tenth of the error of fits to clean scans.
    // Or if a step is no longer than this: a smooth shape may slide along itself for hundreds of steps.
    static constexpr double rest = 1e-4;
    // The share of surface and target that decides about a doubted landmark. A landmark that tears the surface is right
    // if with it, so much more of the two lies on each other. One that only strains the surface is wrong if that holds
    // without it. A limb has at least a patch, and a patch of 150 has two thirds of this.
    static constexpr double aLimb = 0.01;
    // A fit that strains the edges by more (rms) may lie wrong. Shapes made by formula had 0.36 and more if they lay
    // turned, a head that lay turned by 60 degrees 0.23, and a hand with touching fingers that lay right 0.19.
    static constexpr double pressed = 0.2;
    // A fit with less than this share of the surface on the target may have missed it, or the target is a part.
    static constexpr double half = 0.5;

    /// A fit that is set aside while another one is tried.
    struct Kept {
        GraphPose graph;
        FitReport report;
        std::unique_ptr<FitMatches> matches;
    };

    /// A sample at the end of a limb, and its counterpart, frame units.
    struct End {
        std::size_t sample;
        Eigen::Vector3d place;
    };

    std::vector<char> FreeNodes() const;
    double SoftEnd() const { return softest * param.stiffness; }
    std::vector<double> AllOf(double stiffness) const { return std::vector<double>(isFree.size(), stiffness); }
    void MatchAnew(bool bothWays);
    void Find(double part) { matches->Find(graph, part, threads, pull); }
    double Step(double part, const std::vector<double> &stiffness);
    void Soften(const Progress &progress);
    void Draw(const Progress &progress);
    bool FindEnds();
    void TryEnds(const Progress &progress);
    void TryBothWays(GraphPose from, const Progress &progress);
    bool IsBentFar() const;
    void FitAgain(const Progress &progress);
    std::vector<double> MovedFrom(const std::vector<Eigen::Vector3d> &before) const;
    bool MoreStay(const std::vector<Eigen::Vector3d> &before, double noise, std::vector<char> &stays) const;
    std::vector<double> Settle(const Progress &progress);
    void StiffenGaps(const std::vector<double> &end, const Progress &progress);
    void Lay(const Progress &progress);
    double OnIt() const { return report.matched - matches->Unreached(); }
    double Covered() const { return std::max(report.matched, 1 - matches->Unreached()); } // each may be a part
    double Growth() const;
    Eigen::Affine3d MotionOfMatched(double factor) const;
    void TryOtherStarts(const Progress &progress);
    void TryWithout(const std::vector<Contradiction> &doubted, const Progress &progress);
    void Finish(const Progress &progress);
    Kept SetAside() { return {graph, report, std::move(matches)}; }
    void TakeBack(Kept &&kept);

    const Fitter &fitter;
    const FitParam &param;
    const FitTarget &target;
    FitReport &report;
    const RegionDeformer &region;
    const unsigned threads;
    const double scale;     // of the frame
    const double tolerance; // of landmarks, frame units
    const bool isAlone;     // landmarks only: nothing is matched
    Deformer::Pose all;
    RegionPose &pose;
    GraphPose &graph;
    const FitSamples samples;                 // the samples that are matched
    const std::size_t matched;                // their number
    FitSamples drawn;                         // the same, then the landmarks, then the vertices on curves
    const std::vector<Eigen::Vector3d> place; // targets of the landmarks, frame units
    const FitCurves curves;
    const bool isLed; // there is a landmark or a curve
    FitParts parts;
    const std::vector<char> isAnyFree, isFree; // flags of the graph's nodes: free ones; free and not carried
    FitSystem system;
    MatchParam how;
    std::unique_ptr<FitMatches> matches;
    std::vector<char> leads; // flags of landmarks and vertices on curves that are followed
    std::vector<End> ends;   // ends of limbs that lead at first
    std::vector<FitSystem::Pull> pull;
    const GraphPose asItLies; // the pose at rest
    GraphPose start;          // the same, moved as a whole
};

} // namespace vcg::fcd

#endif
