// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_curves.h>
#include <vcg_ext/fit/fit_gaps.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_parts.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace vcg::fcd {

namespace {

/// Whether no connected part of what is free has as much as a third of its area: not of its vertices, so that crumbs
/// count as what they are.
bool IsInParts(const SurfaceView &source, const Deformer &deformer) {
    std::vector<Index> componentOf;
    const Index parts = ConnectedComponents(deformer.Whole().surface.graph.adjacency, componentOf);
    std::vector<double> area(std::size_t(parts), 0);
    double all = 0;
    for (std::size_t f = 0; f < source.faces; ++f) {
        if (!source.IsFace(f) || deformer.slotTag[source.corner[3 * f]] != 1)
            continue;
        const auto at = [&](std::size_t k) {
            return deformer.Whole().surface.frame.ToFrame(Eigen::Vector3d(source.At(source.corner[3 * f + k])));
        };
        const Eigen::Vector3d p = at(0), a = at(1) - p, b = at(2) - p;
        const double each = a.cross(b).norm();
        all += each;
        if (const Index node = deformer.nodeOf[source.corner[3 * f]]; node >= 0) // else a loose part
            area[std::size_t(componentOf[std::size_t(node)])] += each;
    }
    return !area.empty() && 3 * *std::max_element(area.begin(), area.end()) < all;
}

// Of Eq. 2 over A against the mean square of the distances, chosen on the training half of tests/fit_recipes.py
// (armadillo, bunny, head; posed by CGAL) and on the half tube of tests/host_fit.py: stiff enough that limbs follow
// their roots and nothing slides along the surface, soft enough that it reaches the target.
constexpr double stiffest = 1e-2, softest = 1e-6;
// The last steps, of all: it has arrived, and is as soft as it gets.
constexpr double lastSteps = 0.2;
// It is at rest when this is left to move, of the diagonal, root mean square: a tenth of what fits of clean scans are
// off by; or when a step moves it by no more: a smooth shape may slide along itself for hundreds of steps.
constexpr double rest = 1e-4;
// It gets softer by a step's share, and up to so many times that, the less it moves: what moves by more than that, of
// the diagonal, is still on its way, and so to be found by what is stiff.
constexpr double hurry = 2, onItsWay = 1e-3;
// Where it follows the target's noise, it gets stiffer, by so much and as often as this, in so many steps each: as long
// as this share of what it followed is left, the distances grow by no more than this (Morozov's discrepancy principle),
// and no more than this comes off the target. What slides along the target shows in none of these, so it ends there.
// Chosen on 32 shapes made by formula, smooth, with relief, open and halved: one is worse by 2 %, the others are not.
constexpr double stiffer = 3, noiseLeft = 0.6, mostNoise = 1.07, comesOff = 0.0005;
constexpr int stifferTimes = 2, stifferSteps = 6;
// A gap may be as stiff as leaves what lies around it no farther from the target than this often what it is without
// (Morozov's discrepancy principle): its own noise, and hardly more.
constexpr double mostMisfit = 1.2;
constexpr int gapSteps = 6;
// Of the target: fits that have arrived leave a thousandth unreached at most (24 of people and beasts turned at their
// joints). Where it is more, a limb may not have been found, or the source lacks it. Matched both ways, a limb that is
// found brings more of the source onto the target, and leaves nothing; surface that is drawn over what the source lacks
// comes off elsewhere.
constexpr double mostUnreached = 0.002;
// Of surface and target: what a landmark must lead onto each other if it shall be right against the others although it
// tears the surface, and what it must keep off each other if it shall be wrong although it only strains it. A patch of
// 150 has two thirds of that, and a limb is one at least.
constexpr double aLimb = 0.01;
// Strain of edges (rms) above which other starts are tried, and the share of it that one must leave. Shapes made by
// formula had 0.36 and more where they lay turned, and 0.19 (a hand with touching fingers) where they lay right.
constexpr double pressed = 0.25, farLess = 0.5;

} // namespace

Fitter::Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
               const Progress &progress, const WeightOf &weight)
    : source(source), handles(handles), param(param) {
    param.ValidateFit();
    if (std::count(handles.tag.begin(), handles.tag.end(), 1) == 0)
        throw BadInput("There is nothing to fit: no vertex is free. Mark the part that may bend with tag 1.");
    deformer = PrepareDeformer(source, handles, param, progress.Slice(0, 0.7));
    if (!source.isCloud && IsInParts(source, *deformer)) { // what joins its parts is that they lie beside each other
        SurfaceView points = source;
        points.faces = points.edges = 0;
        points.isCloud = true;
        deformer = PrepareDeformer(points, handles, param, progress.Slice(0.7, 0.9));
    }
    if (weight && !FollowsAlone())
        nodeWeight = WeightsAtNodes(source, weight, *deformer);
    sample = EvenSample(deformer->Whole(), std::size_t(param.samples), nodeWeight);
    if (sample.empty() && !nodeWeight.empty())
        throw BadInput(
            "The weights of the surface are 0 wherever it is free, so nothing of it can be matched. Give what "
            "counts one up to 1.");
    sampleNormal = NormalsAtNodes(source, normal, *deformer, sample);
    progress(1, "Preparing the fit");
}

Deformer::Pose Fitter::Solve(const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
                             const Progress &progress) const {
    const RegionDeformer &region = deformer->Whole();
    const SurfaceGraph &surface = region.surface;
    const Frame &frame = surface.frame;
    Deformer::Pose all = deformer->Solve(handles, param, progress.Slice(0, 0.05));
    RegionPose &pose = all.region[0];
    pose.solved.moves = true;
    GraphPose &graph = pose.graph;
    graph = pose.solved;
    graph.rests.assign(std::size_t(region.graph.Size()), 0);

    FitSamples samples;
    samples.isAffine = param.rigidity < 1;
    for (Index node : sample)
        samples.Add(region, pose, node);
    samples.normal = sampleNormal;
    const std::size_t matched = samples.Size();
    for (std::size_t s = 0; s < matched && !nodeWeight.empty(); ++s)
        samples.weight[s] = double(nodeWeight[std::size_t(sample[s])]);
    report.counted = CountedShare();
    const std::vector<Eigen::Vector3d> place = Lead(landmark, pose, samples);

    std::vector<char> isFree(std::size_t(region.graph.Size()));
    for (Index j = 0; j < region.graph.Size(); ++j)
        isFree[std::size_t(j)] = region.held.tag[std::size_t(region.patches.center[std::size_t(j)])] == 1;
    const std::vector<char> isAnyFree = isFree;
    const bool isAlone = FollowsAlone();
    FitSamples drawn = samples; // behind those that are matched are the landmarks, and then what lies on curves
    const FitCurves curves(target.curves, deformer->nodeOf, region, pose, drawn);
    const bool isLed = drawn.Size() > matched;
    FitParts parts(region, isAlone ? drawn.From(matched) : drawn, isAlone ? 0 : matched);
    isFree = parts.Led(std::move(isFree));
    if (!isAlone)
        Judge(target, PlacementOf(samples.Places(matched, graph), target, progress.threads), isLed, report);
    const GraphPose asItLies = graph;
    if (param.start != FitStart::AsItLies || report.fromAfar)
        graph = Moved(graph, Start(target, samples, matched, place, report, progress.threads));

    samples.Shrink(matched);
    FitSystem system(region, isFree, drawn, param.smoothness, param.rigidity);
    MatchParam how;
    how.farthest = param.largestDistance / frame.scale;
    how.edge = detail::Cosine(param.largestAngle * detail::pi / 180);
    how.spacing = std::sqrt(std::max(region.surface.area, 1e-12) / double(std::max<std::size_t>(matched, 1)));
    const double tolerance = param.landmarkTolerance / frame.scale;
    std::unique_ptr<FitMatches> matches;
    std::vector<char> leads(drawn.Size() - matched, 1); // the landmarks and curves that it follows
    std::vector<FitSystem::Pull> pull(drawn.Size());
    // One step. Root mean square of the nodes' moves.
    const auto move = [&](double part, const std::vector<double> &stiffness) {
        matches->Find(graph, part, progress.threads, pull);
        for (std::size_t l = 0; l < place.size(); ++l)
            pull[matched + l] =
                leads[l] ? LandmarkPull(tolerance, place[l], drawn.At(matched + l, graph), 10 / double(place.size()))
                         : FitSystem::Pull();
        curves.Find(drawn, graph, pull);
        const auto change = system.Step(graph, pull, stiffness, progress.threads);
        FitSystem::Take(change, graph);
        return std::sqrt(change.bottomRows<3>().squaredNorm() / double(std::max<std::size_t>(isFree.size(), 1)));
    };
    const double soft = softest * param.stiffness, pace = 1 / ((1 - lastSteps) * (param.fitSteps - 1));
    // From stiff to soft.
    const auto soften = [&](const Progress &fitting) {
        report.converged = false;
        double part = 0, last = 0; // how far from stiff to soft; the move before
        for (int step = 0; step < param.fitSteps && !report.converged; ++step) {
            fitting(double(step) / param.fitSteps, "Fitting");
            const double moved =
                move(part, std::vector<double>(isFree.size(), stiffest * detail::Power(soft / stiffest, part)));
            report.steps = step + 1;
            // As a geometric series, the moves that are left add up to moved^2 / (last - moved).
            report.converged = part >= 1 && (moved <= rest || moved * moved <= rest * (last - moved));
            last = moved;
            part = std::min(1.0, part + pace * std::clamp(onItsWay / std::max(moved, 1e-12), 1.0, hurry));
        }
        matches->Find(graph, 1, progress.threads, pull); // where it is now
    };
    // What has arrived follows no more of the target's noise than it must. \return the stiffness that this leaves
    const auto settle = [&](const Progress &fitting) {
        Measure(*matches, report);
        const FitReport before = report;
        const std::size_t on = CountOn(*matches, before);
        const double alike = report.converged && !isAlone ? matches->Alike() : 0;
        double end = soft;
        for (int k = 0; k < stifferTimes && alike < 0; ++k) {
            fitting(0.9, "Fitting");
            const GraphPose softer = graph;
            const std::vector<double> stiffness(isFree.size(), stiffer * end);
            for (int step = 0; step < stifferSteps && move(1, stiffness) > rest / 3; ++step)
                ;
            matches->Find(graph, 1, progress.threads, pull);
            Measure(*matches, report);
            if (matches->Alike() > noiseLeft * alike || report.rms > mostNoise * before.rms ||
                double(CountOn(*matches, before)) < (1 - comesOff) * double(on)) {
                graph = softer;
                matches->Find(graph, 1, progress.threads, pull);
                break;
            }
            end *= stiffer;
        }
        return end;
    };
    GraphPose start = graph;
    // From stiff to soft, from the start.
    const auto draw = [&](const Progress &fitting) {
        graph = start;
        how.bothWays = report.bothWays = param.bothWays;
        matches = std::make_unique<FitMatches>(target, samples, how);
        soften(fitting);
        Measure(*matches, report);
    };
    // All of a fit, from the start.
    const auto lay = [&](const Progress &fitting) {
        draw(fitting.Slice(0, 0.6));
        if (!param.bothWays && matches->Unreached() > mostUnreached) {
            const FitReport before = report;
            how.bothWays = true;
            auto oneWay = std::exchange(matches, std::make_unique<FitMatches>(target, samples, how));
            const GraphPose there = std::exchange(graph, start);
            soften(fitting.Slice(0.6, 0.9));
            Measure(*matches, report);
            report.bothWays = matches->Unreached() <= mostUnreached && report.matched > before.matched;
            if (!report.bothWays) {
                matches = std::move(oneWay);
                graph = there;
                report = before;
            }
        }
        const double end = settle(fitting);
        const FitGaps gaps(region, *matches, samples);
        const double bearable = std::max(mostMisfit * gaps.Misfit(*matches), FitMatches::least);
        const GraphPose without = graph;
        bool isStiff = !gaps.Any();
        for (double stiff = stiffest; !isStiff; stiff /= 10) {
            graph = without;
            if (stiff > 2 * end) { // else it stays as it is
                const std::vector<double> stiffness = gaps.Stiffness(end, stiff);
                for (int step = 0; step < gapSteps && move(1, stiffness) > rest / 10; ++step)
                    fitting(0.95, "Fitting");
            }
            matches->Find(graph, 1, progress.threads, pull);
            isStiff = stiff <= 2 * end || gaps.Misfit(*matches) <= bearable;
        }
        Measure(*matches, report);
    };
    const std::vector<Contradiction> doubted = Doubted(drawn, matched, place, isFree, graph, progress.Slice(0.05, 0.1));
    const bool isTried = !doubted.empty() && (!isAlone || tolerance > 0);
    lay(progress.Slice(0.1, isTried ? 0.5 : 0.9));
    for (const Contradiction &each : doubted)
        report.contradicted.push_back(each.landmark);
    const auto onIt = [&](const FitMatches &all) { return report.matched - all.Unreached(); };
    if (const double strained = StrainOf(region, graph); strained > pressed && MayBegin(report, isLed)) {
        const FitReport before = report;
        const GraphPose there = graph;
        auto with = std::exchange(matches, nullptr);
        const double on = onIt(*with) - aLimb;
        double least = farLess * strained;
        Eigen::Affine3d began = Eigen::Affine3d::Identity();
        const std::vector<Eigen::Affine3d> motions =
            OtherStarts(samples.Places(matched, asItLies), sampleNormal, target, progress.threads);
        const double each = 0.06 / double(motions.size());
        for (std::size_t m = 0; m < motions.size() && least >= farLess * farLess * strained; ++m) {
            const Eigen::Affine3d &motion = motions[m];
            const GraphPose best = std::exchange(start, Moved(asItLies, motion));
            draw(progress.Slice(0.9 + double(m) * each, 0.9 + double(m + 1) * each));
            if (const double strain = StrainOf(region, graph); strain < least && onIt(*matches) >= on) {
                least = strain;
                began = motion;
            } else {
                start = best;
            }
        }
        report = before;
        if (least < farLess * strained) {
            lay(progress.Slice(0.96, 0.98));
            report.scaledBy = began.linear().col(0).norm();
            report.turnedBy = detail::ArcCosine((began.linear().trace() / report.scaledBy - 1) / 2);
        } else {
            graph = there;
            matches = std::move(with);
            report.strained = strained;
        }
    }
    if (isTried) { // a landmark that the target bears out leads more of the surface onto it
        const FitReport before = report;
        const GraphPose there = graph;
        auto with = std::exchange(matches, nullptr);
        const double withAll = onIt(*with);
        for (const Contradiction &each : doubted)
            leads[each.landmark] = 0;
        lay(progress.Slice(0.5, 0.98));
        const double enough = std::max({tolerance, noHand, 3 * report.nearest / frame.scale});
        report.contradicted.clear();
        for (const auto &[l, strain] : doubted) {
            leads[l] = (drawn.At(matched + l, graph) - place[l]).norm() <= enough;
            if (!leads[l] && (isAlone || onIt(*matches) >= withAll + (strain >= tornStrain ? -aLimb : aLimb)))
                report.contradicted.push_back(l);
        }
        report.leftOut = tolerance > 0 && !report.contradicted.empty();
        if (!report.leftOut) {
            const std::vector<std::size_t> named = std::move(report.contradicted);
            report = before;
            report.contradicted = named;
            graph = there;
            matches = std::move(with);
            leads.assign(leads.size(), 1);
        }
    }
    report.insideOut = matches->IsInsideOut();
    if (report.insideOut && !report.converged && place.empty()) // as of what was mirrored by negating a coordinate
        report.mirrored = true;
    if (!isAlone) {
        parts.Judge(
            *matches, [&](std::size_t s) { return IsOn(*matches, s, report); }, leads);
        matches->LeaveOut(parts.CarriedSamples());
    }
    Arrive(drawn, matched, place, leads, parts.Led(isFree), graph, report, progress.Slice(0.98, 1));
    parts.Carry(isAnyFree, param.smoothness, param.rigidity, stiffest, graph, progress.threads);
    report.curves = curves.Farthest(drawn, graph) * frame.scale;
    report.carried = parts.Carried();
    report.carriedNode = parts.CarriedNodes();
    pose.solved.position = graph.position;
    pose.solved.linear = graph.linear;
    pose.solved.rests = graph.rests;
    graph.converged = report.converged;
    MeasureEnergy(region.graph, param.smoothness * surface.area, graph);
    all.converged = report.converged;
    all.energy = graph.energy * frame.scale * frame.scale;
    Measure(*matches, report);
    MeasureGuess(*matches, drawn, isAnyFree, leads, graph, report);
    progress(1, "Fitting");
    return all;
}

} // namespace vcg::fcd
