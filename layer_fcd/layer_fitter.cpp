// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/curve_file.h> // these before Qt
#include <vcg_ext/fit/fit_target.h>

#include "layer_fitter.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "kept_tool.h"
#include "measured_quality.h"
#include "handle_sources.h"
#include "new_layers.h"
#include "point_sources.h"
#include "weight_sources.h"

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::FitGoal;
using vcg::fcd::Fitter;
using vcg::fcd::Handles;
using vcg::fcd::Landmark;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;

LayerFit::LayerFit(MeshDocument &document, MeshModel &layer, const FitMeshParam &asked, const Remark &remark,
                   const Progress &progress, const Point3m *rest, const Point3m *restNormal)
    : param([&] {
          FitMeshParam fit = asked;
          if (!rest)
              fit.fit.linear = hasDirections(layer);
          // An attribute or quality with weights holds no tags.
          const bool isTold =
              fit.weights == FitMeshParam::WeightsQuality
                  ? fit.handles.source == HandleParam::Quality && !hasMarks(layer)
                  : fit.weights == FitMeshParam::WeightsSelection && fit.handles.source == HandleParam::Selection;
          fit.handles.allFree = fit.handles.allFree || isTold;
          if (fit.landmarksOnly)
              fit.fit = fit.fit.LandmarksAlone();
          return fit;
      }()),
      name(inQuotes(layer)) {
    inheritMeasured(document, layer);
    const MeshModel *target = nullptr; // null: landmarks only
    if (param.target || !param.landmarksOnly) {
        target = &checkedTarget(layer, param.target, "target_layer");
        targetName = inQuotes(*target);
    }
    if (remark && !param.handles.allFree && param.handles.source == HandleParam::Quality && hasQuality(layer) &&
        !mayHaveTags(layer))
        remark("The quality of " + name + " is a measure, not tags, so nothing is held.");
    handles = readHandles(layer, rest, param.handles, remark);
    const auto read = [&](const QString &file, const QString &targets) {
        return file.isEmpty() && targets.isEmpty() ? std::vector<Landmark>()
                                                   : readLandmarks(layer, rest, file, targets, remark);
    };
    landmarks = read(param.landmarkFile, param.targetFile);
    landmarks.insert(landmarks.end(), param.landmarks.begin(), param.landmarks.end());
    checks = read(param.checkFile, param.checkTargetFile);
    if (param.landmarksOnly && landmarks.empty())
        throw Error("There are no landmarks to follow. Give a file with some as 'landmarks_file'.");
    if (!param.curveFile.isEmpty() && param.landmarksOnly)
        throw Error("Curves do not go with 'landmarks_only', which ignores all else of the target. Leave one of "
                    "'curves_file' and 'landmarks_only' out.");
    curves = param.curves;
    if (!param.curveFile.isEmpty())
        curves = vcg::fcd::ReadCurveFile(pathOf(param.curveFile));
    surface = rest ? vcg::tri::ReadSurface(layer.cm, progress.Slice(0, 0.5), [&](std::size_t i) { return rest[i]; })
                   : vcg::tri::ReadSurface(layer.cm, progress.Slice(0, 0.5));
    const SurfaceView view = surface.View();
    normal =
        restNormal ? [restNormal](std::size_t i) { return toVector(restNormal[i]); } : vcg::tri::NormalsOf(layer.cm);
    weight = readWeights(layer, param.weights, param.weightAttribute);
    const auto center = vcg::fcd::HandleCenters(handles.tag, [&](std::size_t i) { return view.At(i); });
    readMotions(document, layer, rest, param.handles, center, remark, handles);
    if (!target)
        return;
    targetSurface = vcg::tri::ReadSurface(target->cm, progress.Slice(0.5, 1));
    if (target->cm.fn == 0)
        for (const CVertexO &vertex : target->cm.vert)
            targetNormal.push_back(toVector(vertex.cN()));
    targetWeight = readWeights(*target, param.targetWeights, param.weightAttribute);
    goal = {targetSurface.View(),   [this](std::size_t i) { return targetNormal[i]; },
            matrixOf(*target),      [this] { targetSurface = {}; },
            weightOf(targetWeight), {}};
}

std::shared_ptr<const Fitter> LayerFit::prepare(const Progress &progress) const {
    return std::make_shared<const Fitter>(surface.View(), normal, handles, param.fit, progress, weightOf(weight));
}

FittedSurface LayerFit::solve(bool measured, const Progress &progress) && {
    FittedSurface fitted;
    vcg::fcd::DeformationResult &result = fitted.result;
    const SurfaceView view = surface.View();
    const std::shared_ptr<const Fitter> fitter = prepare(progress.Slice(0, 0.4));
    if (param.graphLayers)
        fitted.fitter = fitter;
    const Deformer &deformer = fitter->Surface();
    result.tags = vcg::fcd::CountTags(handles.tag, view.deleted);
    fitted.diagonal = deformer.frame.scale;
    fitted.landmarks = landmarks.size();
    fitted.landmarksOnly = param.landmarksOnly;

    std::shared_ptr<const vcg::fcd::FitTarget> target;
    const double first = param.leaveOneOut ? 0.55 : 0.8; // share of the fit; the rest are those without one landmark
    if (param.landmarksOnly) {
        target = fitter->TargetOf(landmarks);
    } else {
        if (!curves.empty()) {
            fitted.curves = fitter->LeadAlong(curves, name, progress.Slice(0.4, 0.42));
            goal.curves = fitted.curves.curve;
        }
        target = fitter->Prepare(goal, progress.Slice(0.42, 0.5));
    }
    result.pose = fitter->Solve(*target, landmarks, fitted.report, progress.Slice(0.5, first));
    if (param.leaveOneOut)
        fitted.leftOut = fitter->LeaveOneOut(*target, landmarks, progress.Slice(first, 0.8));
    if (!param.landmarksOnly && fitted.report.matched == 0)
        throw Error("Nothing of " + name + " has a counterpart on " + targetName +
                    ". Move the layers onto each other first, or raise largest_distance or largest_angle.");
    if (!measured || param.landmarksOnly)
        target = nullptr; // frees as much memory as the rest needs
    result.converged = fitted.report.converged;
    result.position = view.Copy();
    vcg::fcd::CarryPose(view, normal, handles, deformer, param.fit, progress.Slice(0.8, 0.85), result);
    fitter->PutLandmarks(landmarks, result.position);
    fitted.check = fitter->Residuals(checks, result.pose, result.position);
    if (measured && !target)
        target = fitter->Prepare(goal);
    if (measured)
        fitter->Compare(*target, fitted.report, result.position, fitted.distance, fitted.matched,
                        progress.Slice(0.85, 1));
    return fitted;
}

std::shared_ptr<Prepared> preparedOf(const std::shared_ptr<const Fitter> &fitter, const vcg::fcd::TagCount &tags) {
    if (!fitter)
        return nullptr;
    const auto prepared = std::make_shared<Prepared>();
    prepared->deformer = std::shared_ptr<const Deformer>(fitter, &fitter->Surface()); // lives as long as the fitter
    prepared->tags = tags;
    return prepared;
}

void addFitted(MeshDocument &document, MeshModel &layer, const FittedSurface &fitted, const FitMeshParam &param,
               const Remark &remark, const Progress &progress) {
    progress(0, "Adding layers...");
    NewLayers layers(document, layer, remark);
    std::vector<float> quality;
    if (param.quality == FitMeshParam::Distance)
        quality = fitted.distance;
    else if (param.quality == FitMeshParam::Matched)
        quality.assign(fitted.matched.begin(), fitted.matched.end());
    const auto prepared = preparedOf(param.graphLayers ? fitted.fitter : nullptr, fitted.result.tags);
    layers.keepResults(layer, layers.addResult("fitted", fitted.result, quality, prepared), progress);
}

void poseFitted(const MeshDocument &document, MeshModel &layer, const FittedSurface &fitted) {
    poseAs(
        document, layer, [&](std::size_t i) { return toPoint(fitted.result.position.col(Eigen::Index(i))); },
        [&](std::size_t i, const Point3m &atRest) {
            const Eigen::Matrix3d map = fitted.result.linear[i].cast<double>();
            return toPoint((vcg::fcd::Cofactors(map) * toVector(atRest)).stableNormalized());
        });
}

FittedLayers fitLayer(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
                      const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    FittedLayers made;
    const bool measured = param.quality != FitMeshParam::Input;
    static_cast<FittedSurface &>(made) =
        LayerFit(document, layer, param, remark, progress.Slice(0, 0.05)).solve(measured, progress.Slice(0.05, 0.95));
    addFitted(document, layer, made, param, remark, progress.Slice(0.95, 1));
    made.seconds = watch.Seconds();
    return made;
}
