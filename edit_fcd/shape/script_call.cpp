// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <vcg_ext/base/words.h>

#include <layer_fcd/marks.h>
#include <layer_fcd/motion_sources.h>

// The filter calls that make of a layer in a script what is applied here.

using vcg::fcd::Motion;
using vcg::fcd::PoseSequence;
using vcg::fcd::detail::ToText;

namespace {

/// As Python has it.
std::string quoted(const std::string &text) {
    std::string all = "'";
    for (const char c : text)
        if (c == '\n')
            all += "\\n";
        else
            (all += c == '\'' || c == '\\' ? "\\" : "") += c;
    return all + "'";
}

} // namespace

std::string BendSession::filterCall(const std::string &script, const BendCall &call, const std::string &more) const {
    std::string text = "ms.apply_filter('" + script + "', handles=2, tag_attribute='" + appliedTags(document, layer) +
                       "', transforms=" + quoted(call.transforms);
    const BendOptions defaults;
    if (call.pose != defaults.pose)
        text += ", pose=" + ToText(asTyped(call.pose));
    if (options.weights != defaults.weights)
        text += ", weights=" + std::to_string(int(options.weights));
    return text + shapeCall() + more + ")";
}

/// What the filter calls have in common of the options.
std::string BendSession::shapeCall() const {
    std::string call;
    const BendOptions defaults;
    if (options.smoothness != defaults.smoothness)
        call += ", smoothness=" + ToText(asTyped(options.smoothness));
    if (options.initialPatches != defaults.initialPatches)
        call += ", initial_patches=" + std::to_string(options.initialPatches);
    return call;
}

/// Whether what is shown is one pose, in the filter's own numbers, and no other one turns a handle that this one does
/// not: where several poses are blended, such a handle keeps its own turn.
std::optional<std::size_t> BendSession::poseOfFilter() const {
    std::optional<std::size_t> shown;
    for (std::size_t i = 0; i < now.weights.size(); ++i)
        if (now.weights[i] != 0) {
            if (shown)
                return {};
            shown = i;
        }
    if (!shown || now.weights[*shown] != asTyped(now.weights[*shown]))
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

BendCall BendSession::callOfPose() const {
    if (now.weights.empty())
        return {motionText(), options.pose, true};
    if (const std::optional<std::size_t> alone = poseOfFilter())
        return {vcg::fcd::WriteMotionText(
                    readMotionSteps(document, layer, QString::fromStdString(now.poses->pose[*alone].motions))),
                now.weights[*alone], true};
    return {motionText(), options.pose, false};
}

/// A new layer with what is shown of the poses: the table with one key frame, and the call that reads it. Empty where
/// the filter has no such parameter.
std::string BendSession::blendCall() const {
    if (options.weights != BendOptions().weights)
        return {};
    PoseSequence table = *now.poses;
    table.surface.reset();
    table.key = {{0, vcg::fcd::Easing::Linear, now.weights}};
    return "open('poses.csv', 'w', encoding='utf-8').write(" + quoted(PoseSequenceText(table)) +
           "); ms.apply_filter('generate_fcd_pose_sequence', poses_file='poses.csv', handles=2, tag_attribute='" +
           appliedTags(document, layer) + "'" + shapeCall() + ")";
}

std::string BendSession::callInPlace() const {
    const BendCall own = callOfPose();
    std::string call = filterCall("apply_coord_fcd_deformation", own, "");
    if (own.isExact)
        return call;
    const std::string exact = blendCall();
    return call + " (nearly: no filter blends poses in place" +
           (exact.empty() ? std::string(")") : "; a new layer has this blend to the bit by " + exact + ")");
}

std::string BendSession::callToNewLayer(bool graphLayers) const {
    const BendCall own = callOfPose();
    std::string call = filterCall("generate_fcd_deformed_mesh", own, graphLayers ? "" : ", graph_layers=False");
    if (own.isExact)
        return call;
    const std::string exact = blendCall();
    if (exact.empty())
        return call + " (nearly: FCD: Pose Sequence, which blends poses, has no other distances)";
    return graphLayers ? exact + " (which makes no graph layers; with these, and nearly: " + call + ")" : exact;
}
