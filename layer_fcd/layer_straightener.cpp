// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "layer_contents.h"
#include "layer_matrix.h"
#include "layer_straightener.h"
#include "line_sources.h"
#include "new_layers.h"
#include "results.h"

#include <memory>

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::LineGoal;
using vcg::fcd::LineMotion;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;

namespace {

LineGoal goalOf(const MeshModel &layer, const StraightenMeshParam &param) {
    LineGoal goal;
    if (!param.lineFile.isEmpty())
        goal.line = readLine(param.lineFile);
    else if (!param.lineLayer || param.lineLayer == &layer)
        throw Error("There is no line. Choose a layer with its edges as 'line_layer', or give a file with its points "
                    "as 'line_file'.");
    else
        goal.line = readLine(*param.lineLayer);
    goal.smoothing = param.smoothing;
    goal.length = param.length;
    goal.middle = param.middle;
    goal.untwist = param.untwist;
    if (param.shape == StraightenMeshParam::Line) {
        if (!param.targetLayer || param.targetLayer == &layer)
            throw Error("Choose the layer with the line that the mesh is bent along as 'target_layer'.");
        goal.target = readLine(*param.targetLayer);
        if (param.reverse)
            goal.target = goal.target.rowwise().reverse().eval();
    } else {
        goal.arc.degrees = param.shape == StraightenMeshParam::Arc ? param.angle : 0;
        goal.arc.direction = param.direction;
        goal.arc.towards = param.towards;
    }
    return goal;
}

} // namespace

StraightenedLayers straightenLayer(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   const Remark &remark, const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    StraightenedLayers made;
    vcg::fcd::DeformationResult &result = made.result;
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    const LineGoal goal = goalOf(layer, param);
    vcg::fcd::MotionTo(goal); // what is wrong with the lines is told at once
    const vcg::fcd::SurfaceArrays surface = vcg::tri::ReadSurface(layer.cm, progress.Slice(0, 0.02));
    const SurfaceView view = surface.View();
    const vcg::fcd::Handles handles = vcg::fcd::AllFree(view.vertexSlots, world);
    result.tags = vcg::fcd::CountTags(handles.tag, view.deleted);

    vcg::fcd::StraightenParam bend = param.bend;
    bend.linear = hasDirections(layer);
    const auto prepared = std::make_shared<Prepared>();
    prepared->deformer = vcg::fcd::PrepareDeformer(view, handles, bend, progress.Slice(0.02, 0.6));
    prepared->tags = result.tags;
    const Deformer &deformer = *prepared->deformer;
    const LineMotion motion = vcg::fcd::MotionTo(goal, deformer, world, made.report);
    result.pose = vcg::fcd::Straighten(deformer, world, motion, bend, made.report, progress.Slice(0.6, 0.7));
    result.converged = result.pose.solved.converged;
    result.position = view.Copy();
    const vcg::fcd::NormalOf normal = vcg::tri::NormalsOf(layer.cm);
    vcg::fcd::CarryPose(view, normal, handles, deformer, bend, progress.Slice(0.7, 0.9), result);
    std::vector<float> quality;
    if (param.quality == StraightenMeshParam::Place)
        quality = vcg::fcd::PlacesOfVertices(view, deformer, world, motion.From(), progress.Slice(0.9, 0.95));

    const Progress adding = progress.Slice(0.95, 1);
    adding(0, "Adding layers...");
    NewLayers layers(document, layer, remark);
    made.layers = layers.addResult("straightened", result, quality, param.graphLayers ? prepared : nullptr);
    adding(1, "Done");
    layers.keep(*made.layers.back());
    if (host::inWindow()) // one sees what one asked for
        showLast(document, layer, made.layers);
    made.seconds = watch.Seconds();
    return made;
}
