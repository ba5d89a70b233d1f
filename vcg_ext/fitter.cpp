// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_system.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>

namespace vcg {
namespace fcd {

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
    deformer = PrepareDeformer(source, handles, param, progress.Slice(0, 0.9));
    sample = EvenSample(*deformer, std::size_t(param.samples));
    sampleNormal = NormalsAtNodes(source, normal, *deformer, sample);
    progress(1, "Preparing the fit");
}

namespace {

/// A part of a sorted list.
double Quantile(std::vector<double> values, double part) {
    if (values.empty())
        return 0;
    const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// The rotation by a vector: along its axis, by its length.
Eigen::Matrix3d RotationBy(const Eigen::Vector3d &w) {
    const double angle = w.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

} // namespace

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
    FitSystem system(*deformer, isFree, samples, param.smoothness);

    std::vector<FitSystem::Pull> pull(samples.Size());
    std::vector<Eigen::Vector3d> at(samples.Size()), turned(matched);
    std::vector<FitTarget::Match> match(matched);
    std::vector<double> distance(matched), weight(matched);
    const double least = 1e-4; // of the diagonal: nearer is as good as on it
    const double farthest = param.largestDistance / frame.scale;
    const double edge = std::cos(param.largestAngle * double(EIGEN_PI) / 180), full = edge + (1 - edge) / 2;
    // Of Eq. 2 over A against the mean square of the distances, chosen on pairs of an armadillo, a bunny and a head:
    // from where limbs are still drawn by what is far from them to where noise of a tenth of a percent does not dent
    // it.
    const double stiffest = 2e-3, softest = 3e-7;
    double first = 0; // the width of the weights in the first step
    for (int step = 0; step < param.fitSteps; ++step) {
        const double a = double(step) / (param.fitSteps - 1);
        progress.Slice(0.3, 1)(a, "Fitting");
        ParallelFor(progress.threads, samples.Size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t s = begin; s < end; ++s) {
                at[s] = samples.At(s, graph);
                if (s >= matched)
                    continue;
                match[s] = target.Nearest(at[s]);
                turned[s] = samples.NormalAt(s, graph);
                distance[s] = (at[s] - match[s].point).norm();
            }
        });
        const double median = Quantile(distance, 0.5);
        if (step == 0)
            first = 2 * std::max(median, 1e-6);
        const double width = std::max({first * std::pow(0.02, a), 1.5 * median, least});
        const double along = 0.5 * (1 - a) + 0.01; // how much a match holds along the surface
        for (std::size_t s = 0; s < matched; ++s) {
            double w = std::exp(-0.5 * std::pow(distance[s] / width, 2));
            Eigen::Vector3d n = match[s].normal;
            if (!n.isZero(0) && !turned[s].isZero(0)) {
                double cosine = n.dot(turned[s]);
                if (!match[s].isOriented && cosine < 0) {
                    n = -n;
                    cosine = -cosine;
                }
                w *= std::clamp((cosine - edge) / (full - edge), 0.0, 1.0);
                n = (n + turned[s]) / 2;
            }
            if (distance[s] > farthest || (match[s].onBorder && distance[s] > std::max(1.5 * median, least)))
                w = 0;
            weight[s] = w;
            const double unit = w / double(matched);
            pull[s].form = unit * (n * n.transpose() + (n.isZero(0) ? 1 : along) * Eigen::Matrix3d::Identity());
            pull[s].gradient = pull[s].form * (at[s] - match[s].point);
        }
        for (std::size_t s = matched; s < samples.Size(); ++s) {
            pull[s].form = Eigen::Matrix3d::Identity() * (10 / double(landmark.size()));
            pull[s].gradient = pull[s].form * (at[s] - place[s - matched]);
        }
        const double stiffness = stiffest * std::pow(softest * param.stiffness / stiffest, a);
        const auto change = system.Step(graph, pull, stiffness, progress.threads);
        for (Index j = 0; j < deformer->graph.Size(); ++j) {
            graph.linear[std::size_t(j)] = RotationBy(change.col(j).head<3>()) * graph.linear[std::size_t(j)];
            graph.position.col(j) += change.col(j).tail<3>();
        }
        report.steps = step + 1;
        report.converged = change.bottomRows<3>().colwise().norm().maxCoeff() < 1e-3;
    }
    pose.solved.position = graph.position;
    pose.solved.linear = graph.linear;
    pose.solved.rests = graph.rests;
    graph.converged = report.converged;

    std::vector<double> near;
    double squares = 0;
    // The nearest fifth lies on the target wherever that is a fifth of the source, and tells its noise: 12 times the
    // 20th percentile of the distances of a plane's noise is three times its standard deviation.
    const double noise = std::max(12 * Quantile(distance, 0.2), 1e-3);
    for (std::size_t s = 0; s < matched; ++s)
        if (weight[s] > 0.01 && distance[s] <= noise) {
            near.push_back(distance[s] * frame.scale);
            squares += near.back() * near.back();
        }
    report.matched = double(near.size()) / double(std::max<std::size_t>(matched, 1));
    report.rms = near.empty() ? 0 : std::sqrt(squares / double(near.size()));
    report.median = Quantile(near, 0.5);
    report.percentile95 = Quantile(near, 0.95);
    for (std::size_t s = matched; s < samples.Size(); ++s)
        report.landmarks = std::max(report.landmarks, (samples.At(s, graph) - place[s - matched]).norm() * frame.scale);
    progress(1, "Fitting");
    return pose;
}

} // namespace fcd
} // namespace vcg
