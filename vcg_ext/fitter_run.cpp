// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a fit, from its start to rest.
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_ends.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/fitter_run.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace vcg::fcd {

namespace {

// The share of the steps at the end in which the fit is as soft as it gets.
constexpr double lastSteps = 0.2;
// A step softens the fit by its share, or up to `hurry` times that if the surface moves little. A surface that moves by
// more than onItsWay (of the diagonal) is still on its way, and needs the stiffness.
constexpr double hurry = 2, onItsWay = 1e-3;
// The largest share of the target that a good fit leaves unreached: 24 fits of people and beasts, turned at their
// joints, left a thousandth. If it is more, the fit has missed a limb, or the source lacks it. Matching both ways shows
// which: if it finds the limb, more of the source lies on the target, and nothing is left; if the source lacks it, the
// surface is drawn there and comes off elsewhere.
constexpr double mostUnreached = 0.002;
// The fit looks for ends of limbs among endPlaces points of each surface, about a hundredth of the diagonal apart. It
// knows an end to within endSpacing; beyond endElsewhere is another place. Ends lead for the first half of the fit:
// then the surface is near, and the points beside them tell more.
constexpr std::size_t endPlaces = 6000;
constexpr double endSpacing = 0.02, endElsewhere = 0.05, endsLead = 0.5;

// The misfit of a mirror image, over that of the surface, up to which it lies as near: bending alone makes some
// percent.
constexpr double noFarther = 1.25;

} // namespace

Fitter::Run::Run(const Fitter &fitter, const FitTarget &target, const std::vector<Landmark> &landmark,
                 FitReport &report, const Progress &progress)
    : fitter(fitter), param(fitter.param), target(target), report(report), region(fitter.deformer->Whole()),
      threads(progress.threads), scale(region.surface.frame.scale), tolerance(param.landmarkTolerance / scale),
      isAlone(fitter.FollowsAlone()), all(fitter.AtRest(progress)), pose(all.region[0]), graph(pose.graph),
      samples(fitter.Matched(pose)), matched(samples.Size()), drawn(samples), place(fitter.Lead(landmark, pose, drawn)),
      curves(target.curves, fitter.deformer->nodeOf, region, pose, drawn), isLed(drawn.Size() > matched),
      parts(region, isAlone ? drawn.From(matched) : drawn, isAlone ? 0 : matched), isAnyFree(FreeNodes()),
      isFree(parts.Led(isAnyFree)), system(region, isFree, drawn, param.smoothness, param.fitRigidity),
      leads(drawn.Size() - matched, 1), pull(drawn.Size()), asItLies(graph), start(graph) {
    how.farthest = param.largestDistance / scale;
    how.edge = detail::Cosine(param.largestAngle * detail::pi / 180);
    how.spacing = std::sqrt(std::max(region.surface.area, 1e-12) / double(std::max<std::size_t>(matched, 1)));
    report.counted = fitter.CountedShare();
    if (!isAlone)
        fitter.Judge(target, PlacementOf(samples.Places(matched, graph), target, threads), isLed, report);
    if (param.start != FitStart::AsItLies || report.fromAfar)
        start = Moved(graph, fitter.Start(target, drawn, matched, landmark, place, report, threads));
    graph = start;
}

/// Flags of the graph's nodes.
std::vector<char> Fitter::Run::FreeNodes() const {
    std::vector<char> free(std::size_t(region.graph.Size()));
    for (Index j = 0; j < region.graph.Size(); ++j)
        free[j] = region.held.tag[std::size_t(region.patches.center[j])] == 1;
    return free;
}

void Fitter::Run::TakeBack(Kept &&kept) {
    graph = std::move(kept.graph);
    report = std::move(kept.report);
    matches = std::move(kept.matches);
}

void Fitter::Run::MatchAnew(bool bothWays) {
    how.bothWays = bothWays;
    matches = std::make_unique<FitMatches>(target, samples, how);
}

/// One step. \param part share of the fit that has passed, [0, 1] \return rms move of the nodes, frame units
double Fitter::Run::Step(double part, const std::vector<double> &stiffness) {
    Find(part);
    for (std::size_t l = 0; l < place.size(); ++l)
        pull[matched + l] =
            leads[l] ? LandmarkPull(tolerance, place[l], drawn.At(matched + l, graph), 10 / double(place.size()))
                     : FitSystem::Pull();
    for (std::size_t e = 0; part < endsLead && e < ends.size(); ++e) {
        const FitSystem::Pull led =
            LandmarkPull(endSpacing, ends[e].place, drawn.At(ends[e].sample, graph), 10 / double(ends.size()));
        pull[ends[e].sample].form += led.form;
        pull[ends[e].sample].gradient += led.gradient;
    }
    curves.Find(drawn, graph, pull);
    const auto change = system.Step(graph, pull, stiffness, threads);
    FitSystem::Take(change, graph);
    return std::sqrt(change.bottomRows<3>().squaredNorm() / double(std::max<std::size_t>(isFree.size(), 1)));
}

/// Makes the steps from stiff to soft.
void Fitter::Run::Soften(const Progress &progress) {
    const double pace = 1 / ((1 - lastSteps) * (param.fitSteps - 1));
    report.converged = false;
    double part = 0, last = 0; // share of the way from stiff to soft; the last move
    for (int step = 0; step < param.fitSteps && !report.converged; ++step) {
        progress(double(step) / param.fitSteps, "Fitting");
        const double moved = Step(part, AllOf(stiffest * detail::Power(SoftEnd() / stiffest, part)));
        report.steps = step + 1;
        // As a geometric series, the moves that are left add up to moved^2 / (last - moved).
        report.converged = part >= 1 && (moved <= rest || moved * moved <= rest * (last - moved));
        last = moved;
        part = std::min(1.0, part + pace * std::clamp(onItsWay / std::max(moved, 1e-12), 1.0, hurry));
    }
    Find(1); // where it is now
    fitter.Measure(*matches, report);
}

/// Fits from the start, from stiff to soft.
void Fitter::Run::Draw(const Progress &progress) {
    graph = start;
    report.bothWays = param.bothWays;
    MatchAnew(param.bothWays);
    Soften(progress);
}

/// Finds the ends of limbs that source and target have in common. \return whether one of them is off now
bool Fitter::Run::FindEnds() {
    const std::size_t stride = 1 + (matched - 1) / endPlaces;
    std::vector<Eigen::Vector3d> own, ownNormal, there, normalThere;
    for (std::size_t s = 0; s < matched; s += stride) {
        own.push_back(samples.At(s, start));
        ownNormal.push_back(samples.NormalAt(s, start));
    }
    for (const FitTarget::Match &match : target.Places(own.size())) {
        there.push_back(match.point);
        normalThere.push_back(match.isOriented ? match.normal : Eigen::Vector3d::Zero());
    }
    const std::vector<LimbEnd> from = EndsOfLimbs(own, ownNormal), to = EndsOfLimbs(there, normalThere);
    bool isElsewhere = false;
    for (const auto &[i, j] : MatchEnds(from, to)) {
        ends.push_back({from[i].place * stride, to[j].at});
        isElsewhere = isElsewhere || (samples.At(ends.back().sample, graph) - to[j].at).norm() > endElsewhere;
    }
    return isElsewhere;
}

/// Tries a fit that ends of limbs lead at first; keeps it if more of the surface lies on the target, with less strain.
void Fitter::Run::TryEnds(const Progress &progress) {
    if (fitter.MayBegin(report, isLed) && FindEnds()) {
        const double strained = StrainOf(region, graph), on = OnIt();
        Kept without = SetAside();
        Draw(progress);
        report.endsLed = ends.size();
        if (OnIt() > on && StrainOf(region, graph) < strained)
            return;
        TakeBack(std::move(without));
    }
    ends.clear();
}

/// Tries matching both ways; keeps it if it reaches nearly all of the target, and more of the surface lies on it. If
/// half of it did before, the strain must not be as if it lay turned: a part would be drawn over what it lacks.
void Fitter::Run::TryBothWays(GraphPose from, const Progress &progress) {
    const double most = std::max(2 * pressed, StrainOf(region, graph));
    Kept oneWay = SetAside();
    MatchAnew(true);
    graph = std::move(from);
    Soften(progress);
    report.bothWays = matches->Unreached() <= mostUnreached && report.matched > oneWay.report.matched &&
                      (StrainOf(region, graph) <= most || oneWay.report.matched < half);
    if (!report.bothWays)
        TakeBack(std::move(oneWay));
}

/// The whole fit from one start.
void Fitter::Run::Lay(const Progress &progress) {
    ends.clear();
    Draw(progress.Slice(0, 0.4));
    if (!target.reachesFarther && matches->Unreached() > mostUnreached) {
        if (!param.bothWays) {
            TryBothWays(start, progress.Slice(0.4, 0.5));
            if (!report.bothWays && IsBentFar())
                TryBothWays(graph, progress.Slice(0.5, 0.6));
        }
        if (matches->Unreached() > mostUnreached)
            TryEnds(progress.Slice(0.6, 0.8));
    }
    FitAgain(progress.Slice(0.8, 0.9));
    StiffenGaps(Settle(progress), progress);
}

/// Tries the fit without the doubted landmarks, and decides about each: a right one brings more of the surface onto the
/// target. With a tolerance, wrong ones are left out; without, they are only named.
void Fitter::Run::TryWithout(const std::vector<Contradiction> &doubted, const Progress &progress) {
    const double withAll = OnIt();
    Kept kept = SetAside();
    for (const Contradiction &each : doubted)
        leads[each.landmark] = 0;
    report.contradicted.clear();
    Lay(progress);
    const double enough = std::max({tolerance, noHand, 3 * report.nearest / scale});
    for (const auto &[l, strain] : doubted) {
        leads[l] = (drawn.At(matched + l, graph) - place[l]).norm() <= enough;
        if (!leads[l] && (isAlone || OnIt() >= withAll + (strain >= tornStrain ? -aLimb : aLimb)))
            report.contradicted.push_back(l);
    }
    report.leftOut = tolerance > 0 && !report.contradicted.empty();
    if (!report.leftOut) {
        kept.report.contradicted = std::move(report.contradicted);
        TakeBack(std::move(kept));
        leads.assign(leads.size(), 1);
    }
}

/// Meets the landmarks, carries the parts that nothing leads, and measures.
void Fitter::Run::Finish(const Progress &progress) {
    report.insideOut = matches->IsInsideOut();
    // As if mirrored by negating a coordinate, unless the surface lies nearer than its mirror image can.
    if (report.insideOut && !report.converged && place.empty() && report.matched > half)
        report.mirrored =
            report.mirrored || MirrorMisfit(samples.Places(matched, asItLies), target, threads) < noFarther;
    if (!isAlone) {
        parts.Judge(
            *matches, [&](std::size_t s) { return fitter.IsOn(*matches, s, report); }, leads);
        matches->LeaveOut(parts.CarriedSamples());
    }
    fitter.Arrive(drawn, matched, place, leads, parts.Led(isFree), graph, report, progress);
    parts.Carry(isAnyFree, param.smoothness, param.fitRigidity, stiffest, graph, threads);
    report.curves = curves.Farthest(drawn, graph) * scale;
    report.carried = parts.Carried();
    report.carriedNode = parts.CarriedNodes();
    pose.solved.position = graph.position;
    pose.solved.linear = graph.linear;
    pose.solved.rests = graph.rests;
    graph.converged = all.converged = report.converged;
    MeasureEnergy(region.graph, param.smoothness * region.surface.area, graph);
    all.energy = graph.energy * scale * scale;
    fitter.Measure(*matches, report);
    fitter.MeasureGuess(*matches, drawn, isAnyFree, leads, graph, report);
}

Deformer::Pose Fitter::Run::Solve(const Progress &progress) {
    const std::vector<Contradiction> doubted =
        fitter.Doubted(drawn, matched, place, isFree, graph, progress.Slice(0.05, 0.1));
    const bool isTried = !doubted.empty() && (!isAlone || tolerance > 0);
    for (const Contradiction &each : doubted)
        report.contradicted.push_back(each.landmark);
    Lay(progress.Slice(0.1, isTried ? 0.5 : 0.9));
    TryOtherStarts(progress.Slice(0.9, 0.98));
    if (isTried)
        TryWithout(doubted, progress.Slice(0.5, 0.98));
    Finish(progress.Slice(0.98, 1));
    progress(1, "Fitting");
    return std::move(all);
}

/// The pose at rest of all but handles, to start the fit from.
Deformer::Pose Fitter::AtRest(const Progress &progress) const {
    Deformer::Pose all = deformer->Solve(handles, param, progress);
    RegionPose &pose = all.region[0];
    pose.solved.moves = true;
    pose.graph = pose.solved;
    pose.graph.rests.assign(std::size_t(deformer->Whole().graph.Size()), 0);
    return all;
}

/// The samples of the surface that are matched.
FitSamples Fitter::Matched(const RegionPose &pose) const {
    FitSamples samples;
    samples.isAffine = param.fitRigidity < 1;
    for (Index node : sample)
        samples.Add(deformer->Whole(), pose, node);
    samples.normal = sampleNormal;
    for (std::size_t s = 0; s < samples.Size() && !nodeWeight.empty(); ++s)
        samples.weight[s] = double(nodeWeight[std::size_t(sample[s])]);
    return samples;
}

Deformer::Pose Fitter::Solve(const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
                             const Progress &progress) const {
    const LoopHelpers helpers;
    return Run(*this, target, landmark, report, progress.Slice(0, 0.05)).Solve(progress);
}

} // namespace vcg::fcd
