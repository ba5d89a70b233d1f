// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace vcg {
namespace fcd {

namespace {

/// Whether no connected part of the surface that bends has as much as a third of the free vertices.
bool IsInParts(const Deformer &deformer) {
    std::vector<Index> componentOf;
    const Index parts = ConnectedComponents(deformer.surface.graph.adjacency, componentOf);
    std::vector<std::size_t> size(std::size_t(parts), 0);
    for (const MovingSurface::Bent &each : deformer.bent)
        ++size[std::size_t(componentOf[std::size_t(each.node)])];
    const std::size_t all = deformer.bent.size() + deformer.carried.size();
    return size.empty() || 3 * *std::max_element(size.begin(), size.end()) < all;
}

// Of Eq. 2 over A against the mean square of the distances, chosen on the training half of tests/fit_recipes.py
// (armadillo, bunny, head; posed by CGAL) and on the half tube of tests/host_fit.py: stiff enough that limbs follow
// their roots and nothing slides along the surface, soft enough that it reaches the target.
constexpr double stiffest = 1e-2, softest = 1e-6;

} // namespace

FitParam::FitParam() {
    // A vertex then follows some seven nodes; with more, a step takes several times as long.
    influence = 2;
    graph.initialPatches = 150; // the data say where it bends; twice as many fit no better and take four times as long
    bendsUnheld = true;
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
}

Fitter::Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
               const Progress &progress)
    : source(source), handles(handles), param(param) {
    param.ValidateFit();
    if (std::count(handles.tag.begin(), handles.tag.end(), 1) == 0)
        throw BadInput("There is nothing to fit: no vertex is free. Mark the part that may bend with tag 1.");
    deformer = PrepareDeformer(source, handles, param, progress.Slice(0, 0.7));
    if (!source.isCloud && IsInParts(*deformer)) { // what joins its parts is that they lie beside each other
        SurfaceView points = source;
        points.faces = points.edges = 0;
        points.isCloud = true;
        deformer = PrepareDeformer(points, handles, param, progress.Slice(0.7, 0.9));
    }
    sample = EvenSample(*deformer, std::size_t(param.samples));
    sampleNormal = NormalsAtNodes(source, normal, *deformer, sample);
    progress(1, "Preparing the fit");
}

Deformer::Pose Fitter::Solve(const FitGoal &goal, const std::vector<Landmark> &landmark, FitReport &report,
                             const Progress &progress) const {
    const SurfaceGraph &surface = deformer->surface;
    const Frame &frame = surface.frame;
    Deformer::Pose pose = deformer->Solve(handles, param, progress.Slice(0, 0.05));
    pose.solved.moves = true;
    GraphPose &graph = pose.graph;
    graph = pose.solved;
    graph.rests.assign(std::size_t(deformer->graph.Size()), 0);

    // The frame has the source's matrix without its translation.
    Eigen::Affine3d toFrame = handles.world.inverse() * goal.world;
    toFrame = Eigen::Translation3d(-frame.origin / frame.scale) * Eigen::Scaling(1 / frame.scale) *
              Eigen::Affine3d(frame.metric) * toFrame;
    const FitTarget target(goal.surface, goal.normal, toFrame, progress.Slice(0.05, 0.3));

    FitSamples samples;
    for (Index node : sample)
        samples.Add(*deformer, pose, node);
    samples.normal = sampleNormal;
    const std::size_t matched = samples.Size();
    std::vector<Eigen::Vector3d> place; // of each landmark
    for (const Landmark &each : landmark) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite())
            throw BadInput("Landmark " + std::to_string(place.size() + 1) + " is no vertex, or belongs nowhere.");
        const Index node = surface.nodeOf[each.vertex];
        place.push_back(frame.ToFrame(handles.world.inverse() * each.target));
        if (node < 0 || deformer->held.tag[std::size_t(node)] != 1)
            throw BadInput("Landmark " + std::to_string(place.size()) + " is at a vertex that is not free.");
        if (std::find(samples.surfaceNode.begin() + std::ptrdiff_t(matched), samples.surfaceNode.end(), node) !=
            samples.surfaceNode.end())
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
    FitMatches matches(
        target, samples,
        {param.largestDistance / frame.scale, detail::Cosine(param.largestAngle * detail::pi / 180),
         std::sqrt(std::max(deformer->surface.area, 1e-12) / double(std::max<std::size_t>(matched, 1)))});
    std::vector<FitSystem::Pull> pull(drawn.Size());
    for (int step = 0; step < param.fitSteps; ++step) {
        const double a = double(step) / (param.fitSteps - 1);
        progress.Slice(0.3, 1)(a, "Fitting");
        matches.Find(graph, a, progress.threads, pull);
        for (std::size_t s = matched; s < drawn.Size(); ++s) {
            pull[s].form = Eigen::Matrix3d::Identity() * (10 / double(landmark.size()));
            pull[s].gradient = pull[s].form * (drawn.At(s, graph) - place[s - matched]);
        }
        const double stiffness = stiffest * detail::Power(softest * param.stiffness / stiffest, a);
        const auto change = system.Step(graph, pull, stiffness, progress.threads);
        for (Index j = 0; j < deformer->graph.Size(); ++j) {
            graph.linear[std::size_t(j)] = detail::RotationBy(change.col(j).head<3>()) * graph.linear[std::size_t(j)];
            graph.position.col(j) += change.col(j).tail<3>();
        }
        report.steps = step + 1;
        report.converged = change.bottomRows<3>().colwise().norm().maxCoeff() < 1e-3;
    }
    report.insideOut = matches.IsInsideOut();
    report.pull = MoveOnto(drawn, matched, place, isFree, graph) * frame.scale;
    pose.solved.position = graph.position;
    pose.solved.linear = graph.linear;
    pose.solved.rests = graph.rests;
    graph.converged = report.converged;
    MeasureEnergy(deformer->graph, param.smoothness * surface.area, graph);
    Measure(matches, report);
    for (std::size_t s = matched; s < drawn.Size(); ++s)
        report.landmarks = std::max(report.landmarks, (drawn.At(s, graph) - place[s - matched]).norm() * frame.scale);
    progress(1, "Fitting");
    return pose;
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

void Fitter::Measure(const FitMatches &matches, FitReport &report) const {
    const double scale = deformer->surface.frame.scale;
    std::vector<double> distance, near;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        distance.push_back(matches.Distance(s));
    // The nearest fifth lies on the target wherever that is a fifth of the source, and tells its noise: 12 times the
    // 20th percentile of the distances of a plane's noise is three times its standard deviation.
    const double noise = std::max(12 * Quantile(distance, 0.2), 1e-3);
    double squares = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        if (matches.Counts(s) && distance[s] <= noise) {
            near.push_back(distance[s] * scale);
            squares += near.back() * near.back();
        }
    report.matched = double(near.size()) / double(std::max<std::size_t>(distance.size(), 1));
    report.rms = near.empty() ? 0 : std::sqrt(squares / double(near.size()));
    report.median = Quantile(near, 0.5);
    report.percentile95 = Quantile(near, 0.95);
}

void Fitter::PutLandmarks(const std::vector<Landmark> &landmark, Eigen::Ref<Eigen::Matrix3Xd> position) const {
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
