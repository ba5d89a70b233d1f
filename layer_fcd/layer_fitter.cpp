// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // these before Qt
#include <vcg_ext/fit/fit_target.h>

#include "layer_contents.h"
#include "layer_fitter.h"
#include "layer_matrix.h"
#include "motion_sources.h"
#include "new_layers.h"
#include "point_sources.h"
#include "results.h"
#include "tag_sources.h"

#include <algorithm>
#include <memory>

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::FitGoal;
using vcg::fcd::FitTarget;
using vcg::fcd::Fitter;
using vcg::fcd::Handles;
using vcg::fcd::Landmark;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;

namespace {

std::string inQuotes(const MeshModel &layer) { return "'" + layer.label().toStdString() + "'"; }

const MeshModel &checkedTarget(const MeshModel &layer, const MeshModel *target) {
    if (!target)
        throw Error("'target_layer' names no layer of this document. Choose the layer that " + inQuotes(layer) +
                    " is laid onto.");
    if (target == &layer)
        throw Error("The target is the layer that is fitted itself. Choose another one as 'target_layer'.");
    if (target->cm.vn == 0)
        throw Error("The target " + inQuotes(*target) +
                    " has no vertices. Choose a layer with a surface, or with points, as 'target_layer'.");
    return *target;
}

std::vector<Landmark> readLandmarks(const MeshModel &layer, const Handles &handles, const QString &file,
                                    const QString &targets) {
    std::vector<Landmark> landmarks;
    if (!file.isEmpty() || !targets.isEmpty())
        for (const vcg::fcd::PointHandle &point : readPointHandles(layer, nullptr, file, targets))
            landmarks.push_back({point.vertex, handles.world * point.target});
    return landmarks;
}

/// The distance of each vertex slot from the target, world units, at \p position; or whether it has a counterpart
/// there, 1 or 0.
std::vector<float> qualityOf(const SurfaceView &surface, const Deformer &deformer, const Handles &handles,
                             const FitGoal &goal, const Eigen::Matrix3Xd &position, const FitMeshParam &param,
                             const vcg::fcd::FitReport &report, const Progress &progress) {
    // As seen from the surface, where single precision is fine.
    const vcg::fcd::Frame &frame = deformer.surface.frame;
    Eigen::Affine3d toFrame = Eigen::Affine3d(frame.metric) * handles.world.inverse() * goal.world;
    toFrame = Eigen::Translation3d(-frame.origin / frame.scale) * Eigen::Scaling(1 / frame.scale) * toFrame;
    const FitTarget target(goal.surface, goal.normal, toFrame, progress.Slice(0, 0.3));
    // Beside an open border, what is farther than it mostly is where it is matched is beyond the border. Elsewhere,
    // what is three times as far as nineteen in twenty of these are is not the target's noise.
    const double besideBorder = std::max(report.percentile95, 1e-4 * frame.scale), far = 3 * besideBorder;
    std::vector<float> quality(surface.vertexSlots, 0.f);
    ParallelFor(progress.Slice(0.3, 1), "Measuring the distance", quality.size(), 1 << 12,
                [&](std::size_t first, std::size_t last) {
                    vcg::fcd::NearestPlace::Hint hint; // the next vertex mostly is beside the last one
                    for (std::size_t i = first; i < last; ++i) {
                        if (surface.IsDeleted(i))
                            continue;
                        const Eigen::Vector3d p = frame.ToFrame(Eigen::Vector3d(position.col(Eigen::Index(i))));
                        const FitTarget::Match match = target.Nearest(p, hint);
                        const double distance = (p - match.point).norm() * frame.scale;
                        if (param.quality == FitMeshParam::Distance)
                            quality[i] = float(distance);
                        else
                            quality[i] = distance <= (match.onBorder ? besideBorder : far) &&
                                                 distance <= param.fit.largestDistance
                                             ? 1.f
                                             : 0.f;
                    }
                });
    return quality;
}

} // namespace

FittedLayers fitLayer(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
                      const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    FittedLayers made;
    vcg::fcd::DeformationResult &result = made.result;
    const MeshModel &target = checkedTarget(layer, param.target);
    Handles handles = readHandles(layer, nullptr, param.handles);
    const std::vector<Landmark> landmarks = readLandmarks(layer, handles, param.landmarkFile, param.targetFile);
    made.landmarks = landmarks.size();
    const vcg::fcd::SurfaceArrays surface = vcg::tri::ReadSurface(layer.cm, progress.Slice(0, 0.02)),
                                  targetSurface = vcg::tri::ReadSurface(target.cm, progress.Slice(0.02, 0.04));
    const SurfaceView view = surface.View();
    const auto center = vcg::fcd::HandleCenters(handles.tag, [&](std::size_t i) { return view.At(i); });
    readMotions(document, layer, nullptr, param.handles, center, remark, handles);

    const vcg::fcd::NormalOf normal = vcg::tri::NormalsOf(layer.cm);
    vcg::fcd::FitParam fit = param.fit;
    fit.linear = hasDirections(layer);
    const auto fitter = std::make_shared<const Fitter>(view, normal, handles, fit, progress.Slice(0.04, 0.4));
    const Deformer &deformer = fitter->Surface();
    result.tags = vcg::fcd::CountTags(handles.tag, view.deleted);
    made.diagonal = deformer.surface.frame.scale;

    const FitGoal goal = {targetSurface.View(), vcg::tri::NormalsOf(target.cm), matrixOf(target)};
    result.pose = fitter->Solve(goal, landmarks, made.report, progress.Slice(0.4, 0.8));
    if (made.report.matched == 0)
        throw Error("Nothing of " + inQuotes(layer) + " has a counterpart on " + inQuotes(target) +
                    ". Lay the layers onto each other first, or raise largest_distance or largest_angle.");
    result.converged = made.report.converged;
    result.position = view.Copy();
    vcg::fcd::CarryPose(view, normal, handles, deformer, fit, progress.Slice(0.8, 0.85), result);
    fitter->PutLandmarks(landmarks, result.position);
    std::vector<float> quality;
    if (param.quality != FitMeshParam::Input)
        quality =
            qualityOf(view, deformer, handles, goal, result.position, param, made.report, progress.Slice(0.85, 0.95));

    const Progress adding = progress.Slice(0.95, 1);
    adding(0, "Adding layers...");
    NewLayers layers(document, layer, remark);
    std::shared_ptr<Prepared> graphOf;
    if (param.graphLayers) {
        graphOf = std::make_shared<Prepared>();
        graphOf->deformer = std::shared_ptr<const Deformer>(fitter, &deformer); // lives as long as the fitter
        graphOf->tags = result.tags;
    }
    made.layers = layers.addResult("fitted", result, quality, graphOf);
    adding(1, "Done");
    layers.keep(*made.layers.back());
    if (host::inWindow()) // one sees what one asked for
        showLast(document, layer, made.layers);
    made.seconds = watch.Seconds();
    return made;
}
