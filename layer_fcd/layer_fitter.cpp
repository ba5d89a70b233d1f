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

#include <memory>

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::FitGoal;
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
    const auto goalTarget = fitter->Prepare(goal, progress.Slice(0.4, 0.5));
    result.pose = fitter->Solve(*goalTarget, landmarks, made.report, progress.Slice(0.5, 0.8));
    if (made.report.matched == 0)
        throw Error("Nothing of " + inQuotes(layer) + " has a counterpart on " + inQuotes(target) +
                    ". Lay the layers onto each other first, or raise largest_distance or largest_angle.");
    result.converged = made.report.converged;
    result.position = view.Copy();
    vcg::fcd::CarryPose(view, normal, handles, deformer, fit, progress.Slice(0.8, 0.85), result);
    fitter->PutLandmarks(landmarks, result.position);
    std::vector<float> quality;
    if (param.quality != FitMeshParam::Input) {
        std::vector<char> liesOn;
        fitter->Compare(*goalTarget, made.report, result.position, quality, liesOn, progress.Slice(0.85, 0.95));
        if (param.quality == FitMeshParam::Matched)
            quality.assign(liesOn.begin(), liesOn.end());
    }

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
