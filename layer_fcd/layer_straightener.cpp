// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "layer_matrix.h"
#include "layer_straightener.h"
#include "new_layers.h"
#include "point_sources.h"

#include <cstring>
#include <sstream>
#include <utility>

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::LineGoal;
using vcg::fcd::LineMotion;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;

LineGoal lineGoalOf(const MeshModel &layer, const StraightenMeshParam &param) {
    LineGoal goal;
    if (param.line.cols() > 0)
        goal.line = param.line;
    else if (!param.lineFile.isEmpty())
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
            throw Error("There is no target line. Choose the layer with the line to bend along as 'target_layer'.");
        goal.target = readLine(*param.targetLayer);
        if (param.reverse)
            goal.target = goal.target.rowwise().reverse().eval();
    } else {
        goal.arc.degrees = param.shape == StraightenMeshParam::Arc ? param.angle : 0;
        goal.arc.direction = param.direction;
        goal.arc.towards = param.towards;
    }
    vcg::fcd::MotionTo(goal); // throws at once if the lines are wrong
    return goal;
}

StraightenedShape straightened(LineSurface surface, LineGoal goal, const StraightenMeshParam &param,
                               const Progress &progress, const KnownLine &known) {
    StraightenedShape shape;
    StraightenedLayers &made = shape.made;
    vcg::fcd::DeformationResult &result = made.result;
    vcg::fcd::StraightenParam bend = param.bend;
    bend.linear = surface.hasDirections;
    if (known.surface && surface.isSame(*known.surface)) {
        surface.prepared = known.surface->prepared;
        if (known.middle.cols() > 0) {
            goal.line = known.middle;
            goal.isFound = true;
            made.report = known.report;
        }
    } else {
        surface.prepare(bend, progress.Slice(0.02, 0.5));
    }
    shape.prepared = surface.prepared;
    result.tags = surface.prepared->tags;
    const SurfaceView view = surface.arrays.View();
    const Eigen::Affine3d &world = surface.world;
    const Deformer &deformer = *surface.prepared->deformer;
    const LineMotion motion = vcg::fcd::MotionTo(goal, deformer, world, made.report, progress.Slice(0.5, 0.65));
    result.pose = vcg::fcd::Straighten(deformer, world, motion, bend, made.report, progress.Slice(0.65, 0.75));
    result.converged = result.pose.converged;
    result.position = view.Copy();
    const vcg::fcd::NormalOf normal = [&](std::size_t i) { return toVector(surface.normal[i]); };
    vcg::fcd::CarryPose(view, normal, surface.handles, deformer, bend, progress.Slice(0.75, 0.95), result);
    if (param.quality == StraightenMeshParam::Place)
        shape.quality = vcg::fcd::PlacesOfVertices(view, deformer, world, motion.From(), progress.Slice(0.95, 1));
    return shape;
}

StraightenedLayers addStraightened(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   StraightenedShape shape, const Remark &remark, const Progress &progress) {
    StraightenedLayers made = std::move(shape.made);
    progress(0, "Adding layers...");
    NewLayers layers(document, layer, remark);
    if (param.line.cols() > 0)
        made.line = &layers.addLine("line", param.line);
    layers.keepResults(
        layer,
        layers.addResult("straightened", made.result, shape.quality, param.graphLayers ? shape.prepared : nullptr),
        progress);
    made.seconds = shape.watch.Seconds();
    return made;
}

StraightenedLayers straightenLayer(MeshDocument &document, MeshModel &layer, const StraightenMeshParam &param,
                                   const Remark &remark, const Progress &progress) {
    const LineGoal goal = lineGoalOf(layer, param);
    LineSurface surface(layer, progress.Slice(0, 0.02));
    return addStraightened(document, layer, param,
                           straightened(std::move(surface), goal, param, progress.Slice(0.02, 0.95)), remark,
                           progress.Slice(0.95, 1));
}

std::string describe(const StraightenedLayers &made) {
    const vcg::fcd::StraightenReport &report = made.report;
    std::ostringstream line;
    line << "The line " << (report.isMiddle ? "through the middles of the cross-sections " : "") << "is "
         << report.length << " long, and " << report.newLength << " now; " << report.following << " of "
         << report.following + report.released << " nodes go with it. The surface is off from where its "
         << "cross-sections go by " << report.rms << " (rms), and nowhere by more than " << report.largest << ".";
    if (report.jitter > 0)
        line << " The points of the line jitter by " << report.jitter << " (rms), which is smoothed.";
    if (report.twist != 0)
        line << " A twist of " << report.twist << " degrees from end to end is removed.";
    line << " " << made.seconds << " s.";
    return line.str();
}

std::vector<std::string> warningsOf(const StraightenedLayers &made) {
    std::vector<std::string> warnings = made.report.Warnings();
    if (made.result.check.flipped > 0)
        warnings.push_back(trianglesFlipped(std::size_t(made.result.check.flipped)) +
                           ": the surface is folded there. " + made.report.Remedy());
    if (!made.result.converged)
        warnings.emplace_back("The surface did not converge where it does not go with the line.");
    return warnings;
}

LineSurface::LineSurface(const MeshModel &layer, const vcg::fcd::Progress &progress)
    : world(invertibleMatrixOf(layer)), arrays(vcg::tri::ReadSurface(layer.cm, progress)), normal(layer.cm.vert.size()),
      hasDirections(::hasDirections(layer)), handles(vcg::fcd::AllFree(arrays.Slots(), world)) {
    forVertices(layer.cm, [&](std::size_t i) { normal[i] = layer.cm.vert[i].cN(); });
}

bool LineSurface::isSame(const LineSurface &other) const {
    const auto isEqual = [](const auto *a, const auto *b, std::size_t count) {
        return !a == !b && (!a || count == 0 || std::memcmp(a, b, count * sizeof *a) == 0);
    };
    const SurfaceView a = arrays.View(), b = other.arrays.View();
    return world.matrix() == other.world.matrix() && a.vertexSlots == b.vertexSlots && a.faces == b.faces &&
           a.edges == b.edges && isEqual(a.position, b.position, 3 * a.vertexSlots) &&
           isEqual(a.deleted, b.deleted, a.vertexSlots) && isEqual(a.corner, b.corner, 3 * a.faces) &&
           isEqual(a.end, b.end, 2 * a.edges);
}

void LineSurface::prepare(const vcg::fcd::StraightenParam &param, const vcg::fcd::Progress &progress) {
    const SurfaceView view = arrays.View();
    const auto made = std::make_shared<Prepared>();
    made->tags = vcg::fcd::CountTags(handles.tag, view.deleted);
    made->deformer = vcg::fcd::PrepareDeformer(view, handles, param, progress);
    prepared = made;
}
