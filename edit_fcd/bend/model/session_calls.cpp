// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/animation_export.h" // before Qt

#include "edit_fcd/bend/model/session.h"

#include "edit_fcd/shape/script_call.h"

#include <layer_fcd/kept_tool.h>
#include <layer_fcd/handle_sources.h>

// The filter calls with which a script repeats what is applied.

using vcg::fcd::Motion;
using vcg::fcd::PoseSequence;

/// Adds the options that all filter calls share.
static ScriptCall withShape(ScriptCall call, const BendOptions &options) {
    const BendOptions usual;
    if (options.smoothness != usual.smoothness)
        call.with("smoothness", asTyped(options.smoothness));
    call.with("falloff", int(options.falloff), int(usual.falloff));
    if (options.elastic)
        call.with("elastic", true);
    else if (options.rigidity != usual.rigidity)
        call.with("rigidity", asTyped(options.rigidity));
    return call.with("initial_patches", options.initialPatches, usual.initialPatches);
}

/// The call that writes the file of poses.
static std::string tableCall(PoseSequence table, std::vector<vcg::fcd::KeyFrame> frames) {
    table.key = std::move(frames);
    table.surface.reset();
    return "open('poses.csv', 'w', encoding='utf-8').write(" + inPython(PoseSequenceText(table)) + "); ";
}

std::string BendSession::filterCall(const std::string &script, const Call &own, bool graphLayers) const {
    const BendOptions usual;
    ScriptCall call(script);
    call.with("handles", 2).with("tag_attribute", appliedTags(document, layer)).with("transforms", own.transforms);
    if (own.pose != usual.pose)
        call.with("pose", asTyped(own.pose));
    call.with("weights", int(data.options.weights), int(usual.weights));
    return withShape(call, data.options).with("graph_layers", graphLayers, true).end();
}

std::string BendSession::sequenceCall(bool hasTable) const {
    ScriptCall call("generate_fcd_pose_sequence");
    if (hasTable)
        call.with("poses_file", std::string("poses.csv"));
    return withShape(call.with("handles", 2).with("tag_attribute", appliedTags(document, layer)), data.options).end();
}

/// The number of the pose in the filter, if one pose is shown alone and it turns each handle that any other pose turns.
/// (In a blend, another handle would keep its own turn.)
std::optional<std::size_t> BendSession::poseOfFilter() const {
    std::optional<std::size_t> shown;
    for (std::size_t i = 0; i < state().weights.size(); ++i)
        if (state().weights[i] != 0) {
            if (shown)
                return {};
            shown = i;
        }
    if (!shown || state().weights[*shown] != asTyped(state().weights[*shown]))
        return {};
    const auto turns = [](const std::map<int, Motion> &pose, int tag) {
        const auto found = pose.find(tag);
        return found != pose.end() && found->second.Turns();
    };
    const std::vector<std::map<int, Motion>> poses = motionsOfPoses();
    for (const std::map<int, Motion> &other : poses)
        for (const auto &each : other)
            if (turns(other, each.first) && !turns(poses[*shown], each.first))
                return {};
    return shown;
}

BendSession::Call BendSession::callOfPose() const {
    if (!state().weights.empty())
        if (const std::optional<std::size_t> alone = poseOfFilter())
            return {vcg::fcd::WriteMotionText(
                        readMotionSteps(document, layer, QString::fromStdString(state().poses->pose[*alone].motions))),
                    state().weights[*alone], true};
    return {vcg::fcd::WriteMotionText(state().motion), data.options.pose, state().weights.empty()};
}

/// The calls for a new layer with the blend: a table with one key frame, and its reader. Empty: a parameter is missing.
std::string BendSession::blendCall() const {
    if (data.options.weights != BendOptions().weights)
        return {};
    return tableCall(*state().poses, {{0, vcg::fcd::Easing::Linear, state().weights}}) + sequenceCall(true);
}

std::string BendSession::callInPlace() const {
    const Call own = callOfPose();
    std::string call = filterCall("apply_coord_fcd_deformation", own, true);
    if (own.isExact)
        return call;
    const std::string exact = blendCall();
    return call + " (nearly: no filter blends poses in place" +
           (exact.empty() ? std::string(")") : "; a new layer has this blend to the bit by " + exact + ")");
}

std::string BendSession::callToNewLayer(bool graphLayers) const {
    const Call own = callOfPose();
    std::string call = filterCall("generate_fcd_deformed_mesh", own, graphLayers);
    if (own.isExact)
        return call;
    const std::string exact = blendCall();
    if (exact.empty())
        return call + " (nearly: FCD: Pose Sequence, which blends poses, has no other distances)";
    return graphLayers ? exact + " (which makes no graph layers; with these, and nearly: " + call + ")" : exact;
}

std::string BendSession::exportCall(const Animation &animation, const AnimationExport &how) const {
    const bool isWhole = animation.key.size() == state().poses->key.size() && how.from == animation.key.front().time &&
                         how.to == animation.key.back().time;
    ScriptCall call("generate_fcd_pose_sequence");
    if (!isWhole)
        call.with("poses_file", std::string("poses.csv"));
    call.with("handles", 2).with("tag_attribute", appliedTags(document, layer)).with("frame_layers", int(how.layers));
    call.with("frames_per_second", asTyped(how.rate), asTyped(AnimationExport().rate));
    if (how.isFile())
        call.with(how.isPc2() ? "pc2_file" : how.isMdd() ? "mdd_file" : "gltf_file", how.file.toStdString());
    if (how.isGltf())
        call.with("gltf_shapes", int(how.shapes), 0);
    std::string text = withShape(call, data.options).end();
    if (data.options.weights != BendOptions().weights)
        text += " (nearly: FCD: Pose Sequence has no other distances)";
    return isWhole ? text : tableCall(animation.poses, animation.key) + text;
}
