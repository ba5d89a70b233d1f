// SPDX-License-Identifier: GPL-3.0-or-later
// Other starts of a fit, where layers lie turned or are of another size.
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_gaps.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fitter_run.h>

#include <cmath>
#include <utility>

namespace vcg::fcd {

namespace {

// Other starts are tried if the strain of edges (rms) is above `pressed`. One wins if it leaves less than farLess of
// that strain, or less strain if the surface at rest lies nearer.
constexpr double farLess = 0.5;
// Below this strain the surface lies the right way round. Shapes made by formula, and scans with holes, that lay right
// had at most 0.09; a tube that lay turned by 90 degrees had 0.13.
constexpr double unstrained = 0.1;
// Other starts are also tried if the edges grow or shrink by more than this share: the target has another size. Of
// shapes made by formula and bent by up to 80 degrees, the right size let them grow by 0.005 at most.
constexpr double grows = 0.1;

} // namespace

/// The factor by which the matched surface has grown beyond its maps.
double Fitter::Run::Growth() const { return GrowthOf(region, graph, MatchedShares(isFree.size(), *matches, samples)); }

/// The motion with this scale that takes most matched nodes nearest to where they went. If too few are matched, of all
/// nodes.
Eigen::Affine3d Fitter::Run::MotionOfMatched(double factor) const {
    const std::vector<double> share = MatchedShares(isFree.size(), *matches, samples);
    std::vector<std::size_t> some;
    for (std::size_t j = 0; j < share.size(); ++j)
        if (share[j] >= 0.5)
            some.push_back(j);
    if (some.size() < 4)
        return MotionOfMost(asItLies.position, graph.position, factor);
    return MotionOfMost(asItLies.position(Eigen::all, some), graph.position(Eigen::all, some), factor);
}

/// Tries other starts, and keeps one if two things hold. It strains the surface far less, or less if the surface at
/// rest lies nearer. And as much of the surface lies on the target, or as little of the target is unreached (the target
/// may be a part), or half of either if a third of the strain is left (both may be parts). A fit that may have missed
/// the target also gives way to a nearer one that brings more of the surface onto it. The fit then begins again from
/// where most of the surface went, with the scale that it found.
void Fitter::Run::TryOtherStarts(const Progress &progress) {
    const double strained = StrainOf(region, graph);
    double mostOn = report.matched + aLimb;
    const bool hasMissed = report.matched < half;
    if ((strained < unstrained && !hasMissed) || !fitter.MayBegin(report, isLed))
        return;
    const double on = OnIt() - aLimb, unreached = matches->Unreached() + aLimb;
    const bool isPressed = strained > (hasMissed ? unstrained : pressed);
    std::vector<OtherStart> starts = OtherStarts(samples.Places(matched, asItLies), fitter.sampleNormal, target,
                                                 MotionOfMost(asItLies.position, graph.position, 1),
                                                 isPressed || std::abs(Growth() - 1) > grows, threads);
    if (starts.empty())
        return;
    ends.clear();                               // they belong to the old start
    const std::size_t most = starts.size() + 3; // with those of tryScaled
    const auto scaleOf = [](const Eigen::Affine3d &motion) { return motion.linear().col(0).norm(); };
    // If one scale explains most of the strain of the matched surface, that is the next start. So it is at first, and
    // as long as a scaled start is less strained: a part of a target tells its scale step by step.
    const auto tryScaled = [&](std::size_t next, double from, bool isOnItsWay) {
        const std::vector<double> share = MatchedShares(isFree.size(), *matches, samples);
        const double growth = GrowthOf(region, graph, share);
        if (starts.size() < most && std::abs(growth - 1) > (from == 1 ? grows : grows / 2) &&
            (isOnItsWay || StrainOf(region, Grown(graph, growth), share) < farLess * StrainOf(region, graph, share)))
            starts.insert(starts.begin() + std::ptrdiff_t(next), {MotionOfMatched(from * growth), false});
    };
    tryScaled(0, 1, true);
    Kept asItLay = SetAside();
    const GraphPose first = start;
    double least = strained;
    bool isFound = false, isFoundScaled = false;
    Eigen::Affine3d began = Eigen::Affine3d::Identity();
    for (std::size_t m = 0; m < starts.size() && !(isFound && least < farLess * std::max(farLess * strained, pressed));
         ++m) {
        const auto [motion, isNearer] = starts[m]; // a copy: starts grows
        const bool isScaled = std::abs(scaleOf(motion) - 1) > grows;
        start = Moved(asItLies, motion);
        Draw(progress.Slice(0.75 * double(m) / double(most), 0.75 * double(m + 1) / double(most)));
        tryScaled(m + 1, scaleOf(motion), isScaled && StrainOf(region, graph) < strained);
        const double strain = StrainOf(region, graph);
        // Both may be parts. A scaled surface fits onto any part.
        const bool isPart = strain < strained / 3 && !isScaled && Covered() > half,
                   isLess = strain < least && (isNearer || strain < farLess * strained) &&
                            (OnIt() >= on || matches->Unreached() <= unreached || isPart);
        if (isLess || (hasMissed && isNearer && report.matched > mostOn && strain < std::max(strained, unstrained))) {
            least = strain;
            mostOn = report.matched;
            isFound = true;
            isFoundScaled = isScaled;
            began = MotionOfMatched(isScaled ? scaleOf(motion) * Growth() : 1);
        }
    }
    if (isFound) {
        report = asItLay.report;
        start = Moved(asItLies, began);
        Lay(progress.Slice(0.75, 1));
        report.scaledBy = isFoundScaled ? scaleOf(began) * Growth() : 1; // the fit tells the rest of it
        report.turnedBy = detail::ArcCosine((began.linear().trace() / scaleOf(began) - 1) / 2);
    } else {
        TakeBack(std::move(asItLay));
        start = first;
        report.strained = strained > pressed ? strained : 0;
    }
}

} // namespace vcg::fcd
