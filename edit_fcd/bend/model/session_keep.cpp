// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include "edit_fcd/bend/model/handles.h"

#include <layer_fcd/bend_text.h>
#include <layer_fcd/kept_tool.h>
#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/rest_shape.h>
#include <layer_fcd/tag_sources.h>

#include <algorithm>

// What the layer keeps of a session, for later sessions and files.

namespace {

bool haveSame(const std::shared_ptr<const BendTags> &a, const std::shared_ptr<const BendTags> &b,
              const std::vector<std::size_t> &live) {
    return a && b ? std::all_of(live.begin(), live.end(), [&](std::size_t i) { return (*a)[i] == (*b)[i]; }) : !a && !b;
}

} // namespace

/// The tags of a layer, null if there are none. A quality that is no valid tags counts as none.
std::shared_ptr<const BendTags> BendSession::marksNow(const MeshModel &layer) {
    HandleParam param;
    param.source = HandleParam::Known;
    auto present = std::make_shared<const BendTags>(readTags(layer, param));
    return std::all_of(present->begin(), present->end(), [](int tag) { return tag == 1; }) ? nullptr : present;
}

std::shared_ptr<const ToolState> BendSession::toolNow() const { return LayerState::known(layer).tool; }

/// Makes the layer keep the state, if it is more than a filter's tags.
void BendSession::keepState() {
    BendState own = state();
    own.marks.reset();
    own.pose = BendState().pose;
    own.applies = own.loads = 0;
    keepTool(document, layer, own == BendState() ? "" : bendText(state(), data.options, liveSlots(layer.cm)),
             isMoved(data));
    kept = toolNow();
}

bool BendSession::goOn() {
    const std::shared_ptr<const ToolState> its = toolOf(layer);
    if (!its)
        return false;
    const std::vector<std::size_t> live = liveSlots(layer.cm);
    auto [known, options] = readBendText(its->text, layer.label().toStdString(), live, layer.cm.vert.size());
    if (auto poses = posesOf(layer))
        known.poses = std::make_shared<const vcg::fcd::PoseSequence>(std::move(*poses));
    const bool hasWeights = known.weights.empty() || (known.poses && known.weights.size() == known.poses->pose.size());
    const auto isOnFree = [&s = known](const auto &each) { return isFree(s, each.second.slot); };
    if (!hasWeights || !haveSame(known.marks, state().marks, live) ||
        !std::all_of(known.points.begin(), known.points.end(), isOnFree))
        throw vcg::fcd::Error("The handles that the layer '" + layer.label().toStdString() +
                              "' keeps do not fit its marks, or its poses: it is bent from the shape that it has now.");
    if (its->isPosed)
        rest.keepPosed([this] { keepRest(); });
    data.state = std::move(known);
    data.options = options;
    takeState();
    isLeft = its->isPosed;
    return true;
}

void BendSession::follow(BendSession &&before) {
    if (rest.world().matrix() != before.rest.world().matrix() || rest.positions() != before.rest.positions())
        return;
    history = std::move(before.history);
    history.begin(before.state());
    applied = std::move(before.applied);
    data.state.applies = applies = before.applies;
    optionsOf = std::move(before.optionsOf);
    optionsOf.resize(before.loads + 2);
    optionsOf[before.loads] = before.data.options;
    data.state.loads = loads = before.loads + 1;
}
