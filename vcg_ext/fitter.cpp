// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_gaps.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace vcg {
namespace fcd {

namespace {

/// The place nearest to \p x that is no farther from \p place than that.
Eigen::Vector3d Within(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x) {
    const Eigen::Vector3d off = x - place;
    const double far = off.norm();
    const double inside = 0.999 * tolerance; // what rounding leaves is within, too
    return far <= inside ? x : Eigen::Vector3d(place + (far > 0 ? inside / far : 0) * off);
}

/// Whether no connected part of what is free has as much as a third of its area: not of its vertices, so that crumbs
/// count as what they are.
bool IsInParts(const SurfaceView &source, const Deformer &deformer) {
    std::vector<Index> componentOf;
    const Index parts = ConnectedComponents(deformer.surface.graph.adjacency, componentOf);
    std::vector<double> area(std::size_t(parts), 0);
    double all = 0;
    for (std::size_t f = 0; f < source.faces; ++f) {
        if (!source.IsFace(f) || deformer.slotTag[source.corner[3 * f]] != 1)
            continue;
        const auto at = [&](std::size_t k) {
            return deformer.surface.frame.ToFrame(Eigen::Vector3d(source.At(source.corner[3 * f + k])));
        };
        const Eigen::Vector3d p = at(0), a = at(1) - p, b = at(2) - p;
        const double each = a.cross(b).norm();
        all += each;
        if (const Index node = deformer.surface.nodeOf[source.corner[3 * f]]; node >= 0) // else a loose part
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
// A gap may be as stiff as leaves what lies around it no farther from the target than this often what it is without
// (Morozov's discrepancy principle): its own noise, and hardly more.
constexpr double mostMisfit = 1.2;
constexpr int gapSteps = 6;
// Of the target: fits that have arrived leave a thousandth unreached at most (24 of people and beasts turned at their
// joints). Where it is more, a limb may not have been found, or the source lacks it. Matched both ways, a limb that is
// found brings more of the source onto the target, and leaves nothing; surface that is drawn over what the source lacks
// comes off elsewhere.
constexpr double mostUnreached = 0.002;

} // namespace

FitParam::FitParam() {
    // Smooth where a joint turns: 2 folds there (the arm of tests/fit_recipes.py), and 4 takes twice as long.
    influence = 3;
    graph.initialPatches = 150; // the data say where it bends; twice as many fit no better and take four times as long
    bendsUnheld = true;
}

FitParam FitParam::LandmarksAlone() const {
    FitParam alone = *this;
    alone.largestDistance = std::numeric_limits<double>::min();
    alone.samples = 100;
    alone.fitSteps = std::min(fitSteps, 20);
    return alone;
}

void FitParam::ValidateFit() const {
    Validate();
    if (!(stiffness > 0) || std::isinf(stiffness))
        throw BadInput("The stiffness must be a positive, finite number; 1 is the default.");
    if (!(largestDistance > 0))
        throw BadInput("The largest distance of matches must be positive.");
    if (!(largestAngle > 0 && largestAngle <= 180))
        throw BadInput("The largest angle of matches must be above 0 and at most 180 degrees.");
    if (fitSteps < 2 || fitSteps > 10000)
        throw BadInput("A fit takes 2 to 10000 steps.");
    if (samples < 100)
        throw BadInput("At least 100 places have to be matched.");
    if (!(landmarkTolerance >= 0) || std::isinf(landmarkTolerance))
        throw BadInput("The tolerance of the landmarks must be 0, for exact ones, or a positive, finite length.");
}

Fitter::Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
               const Progress &progress)
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
    sample = EvenSample(*deformer, std::size_t(param.samples));
    sampleNormal = NormalsAtNodes(source, normal, *deformer, sample);
    progress(1, "Preparing the fit");
}

/// From the world. The frame has the source's matrix without its translation.
Eigen::Affine3d Fitter::ToFrame(const Eigen::Affine3d &world) const {
    const Frame &frame = deformer->surface.frame;
    return Eigen::Translation3d(-frame.origin / frame.scale) * Eigen::Scaling(1 / frame.scale) *
           Eigen::Affine3d(frame.metric) * handles.world.inverse() * world;
}

std::shared_ptr<const FitTarget> Fitter::Prepare(const FitGoal &goal, const Progress &progress) const {
    return std::make_shared<const FitTarget>(goal.surface, goal.normal, ToFrame(goal.world), progress, goal.isRead);
}

Deformer::Pose Fitter::Solve(const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
                             const Progress &progress) const {
    const SurfaceGraph &surface = deformer->surface;
    const Frame &frame = surface.frame;
    Deformer::Pose pose = deformer->Solve(handles, param, progress.Slice(0, 0.05));
    pose.solved.moves = true;
    GraphPose &graph = pose.graph;
    graph = pose.solved;
    graph.rests.assign(std::size_t(deformer->graph.Size()), 0);

    FitSamples samples;
    for (Index node : sample)
        samples.Add(*deformer, pose, node);
    samples.normal = sampleNormal;
    const std::size_t matched = samples.Size();
    std::vector<Eigen::Vector3d> place; // of each landmark
    std::vector<char> hasLandmark(std::size_t(surface.graph.Size()), 0);
    for (const Landmark &each : landmark) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite())
            throw BadInput("Landmark " + std::to_string(place.size() + 1) + " is no vertex, or belongs nowhere.");
        const Index node = surface.nodeOf[each.vertex];
        place.push_back(frame.ToFrame(handles.world.inverse() * each.target));
        if (node < 0 || deformer->held.tag[std::size_t(node)] != 1)
            throw BadInput("Landmark " + std::to_string(place.size()) + " is at a vertex that is not free.");
        if (std::exchange(hasLandmark[std::size_t(node)], char(1)))
            throw BadInput("Landmark " + std::to_string(place.size()) +
                           " is at the place of another one. Leave one of the two out.");
        samples.Add(*deformer, pose, node);
    }

    std::vector<char> isFree(std::size_t(deformer->graph.Size()));
    for (Index j = 0; j < deformer->graph.Size(); ++j)
        isFree[std::size_t(j)] = deformer->held.tag[std::size_t(deformer->patches.center[std::size_t(j)])] == 1;
    if (param.start != FitStart::AsItLies) {
        const Eigen::Affine3d start = Start(target, samples, matched, place, progress.threads);
        for (Index j = 0; j < deformer->graph.Size(); ++j) {
            graph.position.col(j) = start * graph.position.col(j).eval();
            graph.linear[std::size_t(j)] = start.linear() * graph.linear[std::size_t(j)];
        }
    }

    FitSamples drawn = samples; // the landmarks are behind those that are matched
    samples.Shrink(matched);
    FitSystem system(*deformer, isFree, drawn, param.smoothness);
    MatchParam how;
    how.farthest = param.largestDistance / frame.scale;
    how.edge = detail::Cosine(param.largestAngle * detail::pi / 180);
    how.spacing = std::sqrt(std::max(deformer->surface.area, 1e-12) / double(std::max<std::size_t>(matched, 1)));
    how.bothWays = param.bothWays;
    auto matches = std::make_unique<FitMatches>(target, samples, how);
    const double tolerance = param.landmarkTolerance / frame.scale;
    std::vector<FitSystem::Pull> pull(drawn.Size());
    // One step. Root mean square of the nodes' moves.
    const auto move = [&](double part, const std::vector<double> &stiffness) {
        matches->Find(graph, part, progress.threads, pull);
        for (std::size_t s = matched; s < drawn.Size(); ++s) {
            const Eigen::Vector3d x = drawn.At(s, graph);
            const Eigen::Vector3d off = x - Within(tolerance, place[s - matched], x);
            const double weight = 10 / double(landmark.size());
            // With a tolerance, only towards the ball around the place, and not along it.
            const Eigen::Vector3d way = off.stableNormalized();
            pull[s].form =
                weight * (tolerance > 0 ? Eigen::Matrix3d(way * way.transpose()) : Eigen::Matrix3d::Identity());
            pull[s].gradient = weight * off;
        }
        const auto change = system.Step(graph, pull, stiffness, progress.threads);
        for (Index j = 0; j < deformer->graph.Size(); ++j) {
            graph.linear[std::size_t(j)] = detail::RotationBy(change.col(j).head<3>()) * graph.linear[std::size_t(j)];
            graph.position.col(j) += change.col(j).tail<3>();
        }
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
    const GraphPose start = graph;
    report.bothWays = param.bothWays;
    soften(progress.Slice(0.05, 0.6));
    if (!param.bothWays && matches->Unreached() > mostUnreached) {
        Measure(*matches, report);
        const FitReport before = report;
        how.bothWays = true;
        auto oneWay = std::exchange(matches, std::make_unique<FitMatches>(target, samples, how));
        const GraphPose there = std::exchange(graph, start);
        soften(progress.Slice(0.6, 0.9));
        Measure(*matches, report);
        report.bothWays = matches->Unreached() <= mostUnreached && report.matched > before.matched;
        if (!report.bothWays) {
            matches = std::move(oneWay);
            graph = there;
            report = before;
        }
    }
    const FitGaps gaps(*deformer, *matches, samples);
    const double bearable = std::max(mostMisfit * gaps.Misfit(*matches), FitMatches::least);
    const GraphPose without = graph;
    bool isStiff = !gaps.Any();
    for (double stiff = stiffest; !isStiff; stiff /= 10) {
        graph = without;
        if (stiff > 2 * soft) { // else it stays as it is
            const std::vector<double> stiffness = gaps.Stiffness(soft, stiff);
            for (int step = 0; step < gapSteps && move(1, stiffness) > rest / 10; ++step)
                progress(0.95, "Fitting");
        }
        matches->Find(graph, 1, progress.threads, pull);
        isStiff = stiff <= 2 * soft || gaps.Misfit(*matches) <= bearable;
    }
    report.insideOut = matches->IsInsideOut();
    std::vector<Eigen::Vector3d> goal = place;
    for (std::size_t l = 0; l < place.size(); ++l)
        goal[l] = Within(tolerance, place[l], drawn.At(matched + l, graph));
    report.pull = MoveOnto(drawn, matched, goal, isFree, graph, progress.Slice(0.95, 1)) * frame.scale;
    pose.solved.position = graph.position;
    pose.solved.linear = graph.linear;
    pose.solved.rests = graph.rests;
    graph.converged = report.converged;
    MeasureEnergy(deformer->graph, param.smoothness * surface.area, graph);
    Measure(*matches, report);
    for (std::size_t s = matched; s < drawn.Size(); ++s)
        report.landmarks = std::max(report.landmarks, (drawn.At(s, graph) - place[s - matched]).norm() * frame.scale);
    report.beyond = std::max(report.landmarks - param.landmarkTolerance, 0.0);
    progress(1, "Fitting");
    return pose;
}

Deformer::Pose Fitter::Follow(const std::vector<Landmark> &landmark, FitReport &report,
                              const Progress &progress) const {
    std::vector<double> place;
    for (const Landmark &each : landmark)
        place.insert(place.end(), each.target.data(), each.target.data() + 3);
    FitGoal goal; // no place of the surface is near enough to these to be matched
    goal.surface.position = place.data();
    goal.surface.vertexSlots = landmark.size();
    goal.surface.isCloud = true;
    goal.normal = [](std::size_t) { return Eigen::Vector3d(0, 0, 1); };
    return Solve(*Prepare(goal), landmark, report, progress);
}

Eigen::Affine3d Fitter::Start(const FitTarget &target, const FitSamples &samples, std::size_t matched,
                              const std::vector<Eigen::Vector3d> &place, unsigned threads) const {
    for (Index tag : deformer->held.tag)
        if (tag != 1)
            throw BadInput("A start that moves all of the surface does not go with fixed vertices or handles: start "
                           "from where the layers lie.");
    std::vector<Eigen::Vector3d> from;
    const bool byAxes = param.start == FitStart::TriedAxes;
    const auto &node = samples.surfaceNode;
    for (std::size_t s = byAxes ? 0 : matched; s < (byAxes ? matched : samples.Size()); ++s)
        from.emplace_back(deformer->surface.graph.position.col(node[s]).cast<double>());
    if (byAxes)
        return StartFromAxes(from, sampleNormal, target, threads);
    return StartFromLandmarks(from, place, param.start == FitStart::Similar);
}

void Fitter::PutLandmarks(const std::vector<Landmark> &landmark, Eigen::Ref<Eigen::Matrix3Xd> position) const {
    if (param.landmarkTolerance > 0)
        return;
    const double rounding = 1e-5 * deformer->surface.frame.scale;
    std::map<Index, Eigen::Vector3d> at;
    for (const Landmark &each : landmark) {
        const Eigen::Vector3d target = handles.world.inverse() * each.target;
        const Eigen::Vector3d off = target - position.col(Eigen::Index(each.vertex));
        if ((handles.world.linear() * off).norm() <= rounding)
            at[deformer->surface.nodeOf[each.vertex]] = target;
    }
    if (at.empty())
        return;
    for (std::size_t i = 0; i < source.vertexSlots; ++i)
        if (const auto found = at.find(deformer->surface.nodeOf[i]); found != at.end())
            position.col(Eigen::Index(i)) = found->second;
}

} // namespace fcd
} // namespace vcg
