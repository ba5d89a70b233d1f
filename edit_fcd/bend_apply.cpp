// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_session.h"

#include <layer_fcd/tagging.h>

#include <charconv>

// How a bend becomes what a filter would have made of it.

namespace {

std::string digits(double number) {
    char text[32];
    return std::string(text, std::to_chars(text, text + sizeof text, number).ptr);
}

} // namespace

HandleParam BendSession::handleParam() const {
    HandleParam param;
    if (!target.attribute.isEmpty()) {
        param.source = HandleParam::Attribute;
        param.tagAttribute = target.attribute;
    }
    param.transforms = QString::fromStdString(motionText());
    return param;
}

/// The layer at rest, with the tags that the filters read.
void BendSession::handOver() {
    restore();
    TagTarget silent = target;
    silent.colorize = false; // the look is as it is
    writeTags(layer, *effective, silent);
}

std::string BendSession::filterCall(const std::string &script, const std::string &more) const {
    std::string call =
        "ms.apply_filter('" + script + "', handles=" +
        (target.attribute.isEmpty() ? std::string("0") : "2, tag_attribute='" + target.attribute.toStdString() + "'") +
        ", transforms='" + motionText() + "'";
    const BendOptions defaults;
    if (options.smoothness != defaults.smoothness)
        call += ", smoothness=" + digits(double(Scalarm(options.smoothness)));
    if (options.pose != defaults.pose)
        call += ", pose=" + digits(double(Scalarm(options.pose)));
    if (options.initialPatches != defaults.initialPatches)
        call += ", initial_patches=" + std::to_string(options.initialPatches);
    if (options.weights != defaults.weights)
        call += ", weights=" + std::to_string(int(options.weights));
    return call + more + ")";
}

std::string BendSession::applyInPlace(const Remark &remark) {
    PoseParam param;
    param.handles = handleParam();
    param.deformation = deformationOf(options);
    handOver();
    std::string calls;
    if (RestShape::exists(layer) && RestShape(layer).shape() != shapeOf(layer.cm)) {
        resetPose(layer, {true, ResetPoseParam::LastShape}); // poses begin with the shape that it has here
        calls = "ms.apply_filter('apply_coord_fcd_reset', keep_shape=True); ";
    }
    LayerDeformer(document, layer, solver.preparedLayers(), remark).pose(param, vcg::fcd::Progress());
    calls += filterCall("apply_coord_fcd_deformation", "");
    keepRest();
    if (!now.marks && target.attribute.isEmpty()) { // the tags that the call needs stay
        quality.assign(effective->begin(), effective->end());
    }
    now.motion.clear();
    if (!now.marks)
        now.points.clear();
    history.clear();
    updateTags();
    return calls;
}

std::string BendSession::applyToNewLayer(bool graphLayers, const Remark &remark) {
    DeformMeshParam param;
    param.handles = handleParam();
    param.deformation = deformationOf(options);
    param.graphLayers = graphLayers;
    const std::string call = filterCall("generate_fcd_deformed_mesh", graphLayers ? "" : ", graph_layers=False");
    handOver();
    LayerDeformer deformer(document, layer, solver.preparedLayers(), remark);
    deformer.deform(std::move(param), false, vcg::fcd::Progress());
    return call; // of this session there may be nothing left: another layer is the current one
}
