// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/read_surface.h> // before Qt

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/bend_state.h>
#include <layer_fcd/kept_tool.h>
#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_labels.h>
#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/rest_shape.h>
#include <layer_fcd/handle_sources.h>

#include <algorithm>

using vcg::fcd::Error;

BendSession::BendSession(MeshDocument &document, MeshModel &layer)
    : document(document), layer(layer), rest(layer), reach([this] {
          readSurface();
          return std::make_pair(surface, Eigen::Matrix3d(rest.world().linear()));
      }),
      solver(document, layer) {
    if (layer.cm.vn == 0)
        throw Error("The layer " + inQuotes(layer) + " has no vertices, so there is nothing to bend.");
    data.state.marks = marksNow(layer);
    isMarkedHere = hasMarks(layer);
    kept = LayerState::known(layer).tool;
    keepRest();
    updateTags();
}

void BendSession::keepRest() {
    rest.keep();
    surface.reset();
    reach.clear();
    solver.clear();
    data.ground = {rest.positions().size(),
                   rest.diagonal(),
                   rest.world(),
                   rest.middle(),
                   [this](std::size_t i) { return rest.at(i); },
                   [this](std::size_t i) { return toVector(rest.normals()[i]); },
                   &reach};
}

bool BendSession::isUpToDate() const {
    return hasMarks(layer) == isMarkedHere && LayerState::known(layer).tool == kept && rest.isAsKnown();
}

bool BendSession::isAsLeft() const {
    if (!isUpToDate())
        return false;
    const auto marks = marksNow(layer);
    return marks && state().marks ? *marks == *state().marks : !marks && !state().marks;
}

std::optional<std::size_t> BendSession::nearest(const Eigen::Vector3d &place, double &distance) const {
    const std::vector<CVertexO> &vertices = layer.cm.vert;
    const Eigen::Vector3d at = rest.world().inverse() * place;
    const std::optional<Least> found = leastOf(vertices.size(), [&](std::size_t i) {
        return vertices[i].IsD() ? Least().value : (toVector(vertices[i].cP()) - at).squaredNorm();
    });
    if (!found)
        return {};
    distance = (positionOf(found->item) - place).norm();
    return found->item;
}

/// The vertex on the other side of the mirror for the twin of a new handle; none if nothing free lies there.
std::optional<std::size_t> BendSession::twinSlot(std::size_t slot) const {
    if (data.options.mirror < 0)
        return {};
    const vcg::fcd::SurfaceView view = surface->View();
    const Eigen::Vector3d there = rest.world().inverse() * (mirrorOf(data) * (rest.world() * rest.at(slot)));
    const std::optional<Least> found = leastOf(view.vertexSlots, [&](std::size_t i) {
        return view.IsDeleted(i) ? Least().value : (rest.at(i) - there).squaredNorm();
    });
    const bool isTwinThere = found && isTwin(data, slot, found->item) && canBecomePoint(data, found->item);
    return isTwinThere ? std::optional(found->item) : std::nullopt;
}

Eigen::Vector3d BendSession::positionOf(std::size_t slot) const {
    return rest.world() * toVector(!besides                    ? layer.cm.vert[slot].cP()
                                   : besides->position.empty() ? rest.positions()[slot]
                                                               : besides->position[slot]);
}

/// Reads the surface at rest, if it is not read, or the faces have changed.
void BendSession::readSurface() {
    if (besides && surface)
        return;
    const std::uint64_t now = facesOf(layer.cm);
    if (surface && now == facesOfSurface)
        return;
    surface = std::make_shared<const vcg::fcd::SurfaceArrays>(
        vcg::tri::ReadSurface(layer.cm, {}, [&](std::size_t slot) { return rest.positions()[slot]; }));
    facesOfSurface = now;
}

void BendSession::beginBeside() {
    readSurface();
    auto made = std::make_unique<Beside>();
    if (rest.isPosed()) {
        made->position.resize(rest.positions().size());
        forVertices(layer.cm, [&](std::size_t i) { made->position[i] = layer.cm.vert[i].cP(); });
    }
    if (state().poses)
        for (const vcg::fcd::NamedPose &each : state().poses->pose)
            made->poses[each.motions] = inNumbers(each.motions);
    besides = std::move(made);
}

void BendSession::endBeside() {
    const std::unique_ptr<Beside> ended = std::move(besides);
    if (ended && ended->arePosesNew)
        writePoses();
}

// --- changes ---

/// Updates all after undo, redo or cancel has set the state.
void BendSession::takeState() {
    crossApplies();
    if (loads != state().loads) {
        optionsOf[loads] = data.options;
        data.options = optionsOf[loads = state().loads];
    }
    data.options.pose = state().pose;
    updateTags();
    writeMarks();
    writePoses();
}

void BendSession::undo() {
    forgetWhatIsGone();
    if (history.undo(data.state))
        takeState();
}

void BendSession::redo() {
    if (history.redo(data.state))
        takeState();
}

void BendSession::cancel() {
    if (!history.cancel(data.state))
        return;
    marking.reset();
    marked.clear();
    takeState();
}

// --- what the layer keeps of a session, for later sessions and files ---

/// The tags of a layer, null if there are none. A quality that is no valid tags counts as none.
std::shared_ptr<const BendTags> BendSession::marksNow(const MeshModel &layer) {
    HandleParam param;
    param.source = HandleParam::Known;
    auto present = std::make_shared<const BendTags>(readTags(layer, param));
    return std::all_of(present->begin(), present->end(), [](int tag) { return tag == 1; }) ? nullptr : present;
}

/// Makes the layer keep the state, if it is more than a filter's tags.
void BendSession::keepState() {
    BendState own = state();
    own.marks.reset();
    own.pose = BendState().pose;
    own.applies = own.loads = 0;
    keepTool(document, layer, own == BendState() ? "" : bendText(state(), data.options, liveSlots(layer.cm)),
             isMoved(data));
    kept = LayerState::known(layer).tool;
}

bool BendSession::goOn() {
    const std::shared_ptr<const ToolState> tool = toolOf(layer);
    if (!tool)
        return false;
    const std::vector<std::size_t> live = liveSlots(layer.cm);
    auto [known, options] = readBendText(tool->text, layer.label().toStdString(), live, layer.cm.vert.size());
    if (auto poses = posesOf(layer))
        known.poses = std::make_shared<const vcg::fcd::PoseSequence>(std::move(*poses));
    const bool hasWeights = known.weights.empty() || (known.poses && known.weights.size() == known.poses->pose.size());
    const auto isOnFree = [&s = known](const auto &each) { return isFree(s, each.second.slot); };
    const auto isSame = [&a = known.marks, &b = state().marks](std::size_t i) { return (*a)[i] == (*b)[i]; };
    const bool areSame =
        known.marks && state().marks ? std::all_of(live.begin(), live.end(), isSame) : !known.marks && !state().marks;
    if (!hasWeights || !areSame || !std::all_of(known.points.begin(), known.points.end(), isOnFree))
        throw Error("The handles that the layer " + inQuotes(layer) +
                    " keeps do not fit its marks, or its poses: bends begin from the shape that it has now.");
    if (tool->isPosed)
        rest.keepPosed([this] { keepRest(); });
    data.state = std::move(known);
    data.options = options;
    takeState();
    isLeft = tool->isPosed;
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
