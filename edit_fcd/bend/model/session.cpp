// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/read_surface.h> // before Qt

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/marks.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/marks.h>

#include <algorithm>
#include <cassert>
#include <limits>

using vcg::fcd::Error;
using vcg::fcd::ParallelFor;

namespace {

// Radius of a limb that turns by itself, over that of the limb that was turned and has it, at most: for a finger and an
// arm, it is less; for a forearm, more.
const double thinLimb = 0.5;

} // namespace

BendSession::BendSession(MeshDocument &document, MeshModel &layer)
    : document(document), layer(layer), rest(layer), reach([this] {
          readSurface();
          return std::make_pair(surface, Eigen::Matrix3d(rest.world().linear()));
      }),
      solver(document, layer) {
    if (layer.cm.vn == 0)
        throw Error("The layer '" + layer.label().toStdString() + "' has no vertices, so there is nothing to bend.");
    data.state.marks = marksNow(layer);
    isMarkedHere = hasMarks(layer);
    kept = toolNow();
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
    Eigen::Matrix4d present;
    layer.cm.Tr.ToEigenMatrix(present);
    return fits() && present == rest.world().matrix() && hasMarks(layer) == isMarkedHere && toolNow() == kept &&
           rest.isAsKnown();
}

bool BendSession::isAsLeft() const {
    if (!isUpToDate())
        return false;
    const auto marks = marksNow(layer);
    return marks && state().marks ? *marks == *state().marks : !marks && !state().marks;
}

namespace {

/// The live vertex nearest to a place, layer units. \param count of slots \param isDeleted, at of a slot
template <class IsDeleted, class At>
std::optional<std::size_t> nearestOf(std::size_t count, const Eigen::Vector3d &place, const IsDeleted &isDeleted,
                                     const At &at) {
    struct Found {
        double square = std::numeric_limits<double>::infinity();
        std::size_t slot = 0;
    };
    const std::size_t grain = 1 << 14;
    std::vector<Found> found((count + grain - 1) / grain);
    ParallelFor(0, count, grain, [&](std::size_t first, std::size_t last) {
        Found here;
        for (std::size_t i = first; i < last; ++i) {
            const double square = (toVector(at(i)) - place).squaredNorm();
            if (square < here.square && !isDeleted(i))
                here = {square, i};
        }
        found[first / grain] = here;
    });
    const auto best = std::min_element(found.begin(), found.end(),
                                       [](const Found &a, const Found &b) { return a.square < b.square; });
    if (best == found.end() || !std::isfinite(best->square))
        return {};
    return best->slot;
}

} // namespace

std::optional<std::size_t> BendSession::nearest(const Eigen::Vector3d &place, double &distance) const {
    const std::vector<CVertexO> &vertices = layer.cm.vert;
    const auto slot = nearestOf(
        vertices.size(), rest.world().inverse() * place, [&](std::size_t i) { return vertices[i].IsD(); },
        [&](std::size_t i) { return vertices[i].cP(); });
    if (slot)
        distance = (positionOf(*slot) - place).norm();
    return slot;
}

/// The vertex on the other side of the mirror for the twin of a new handle; none if nothing free lies there.
std::optional<std::size_t> BendSession::twinSlot(std::size_t slot) const {
    if (data.options.mirror < 0)
        return {};
    const vcg::fcd::SurfaceView view = surface->View();
    const Eigen::Vector3d there = rest.world().inverse() * (mirrorOf(data) * (rest.world() * rest.at(slot)));
    const auto found = nearestOf(
        view.vertexSlots, there, [&](std::size_t i) { return view.IsDeleted(i); },
        [&](std::size_t i) { return rest.positions()[i]; });
    return found && isTwin(data, slot, *found) && canBecomePoint(data, *found) ? found : std::nullopt;
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

int BendSession::addPoint(std::size_t slot, double usual) {
    if (const std::size_t carrier = reach.carrierOf(slot, usualGap(rest.diagonal())); canBecomePoint(data, carrier))
        slot = carrier;
    return addAt(slot, reach.radiusAt(slot, usual));
}

/// Adds a handle around a vertex, and its twin.
int BendSession::addAt(std::size_t slot, double radius) {
    const auto add = [&, rank = rankOfNew(state())](std::size_t at) {
        assert(canBecomePoint(data, at));
        const int tag = data.influence.unusedTag();
        data.state.points[tag] = {at, radius};
        if (rank > 0)
            data.state.rank[tag] = rank;
        changeTagsOf(tag);
        return tag;
    };
    const int tag = add(slot);
    if (const auto other = twinSlot(slot))
        add(*other);
    return tag;
}

std::shared_ptr<const BendExtent> BendSession::glimpse(std::size_t slot, double usual) {
    reach.begin();
    if (!reach.isRead())
        return nullptr;
    reach.lookAt(slot);
    return glimpseAt(slot, usual);
}

/// The same by what was looked at last.
std::shared_ptr<const BendExtent> BendSession::glimpseAt(std::size_t slot, double usual) {
    const double hair = usualGap(rest.diagonal());
    BendReach &glance = reach.glance();
    if (const std::size_t carrier = glance.carrierOf(slot, hair); canBecomePoint(data, carrier))
        slot = carrier;
    return glance.whole({slot}, glance.radiusAt(slot, usual), hair);
}

std::shared_ptr<const BendExtent> BendSession::glimpseOf(int tag) {
    const auto point = state().points.find(tag);
    reach.begin();
    return point == state().points.end() || !reach.isRead()
               ? nullptr
               : reach.glance().whole({point->second.slot}, point->second.radius, usualGap(rest.diagonal()));
}

std::shared_ptr<const BendExtent> BendSession::glimpseTwin(int tag, const BendExtent &own) {
    if (tag)
        return glimpseOf(mirrored(data, tag));
    const auto slot = twinSlot(own.vertices.front());
    return slot ? reach.glance().whole({*slot}, own.radius, usualGap(rest.diagonal())) : nullptr;
}

void BendSession::makeGrip(int tag) {
    const auto point = data.state.points.find(tag);
    if (point == state().points.end() || point->second.isGrip)
        return;
    const int other = mirrored(data, tag);
    point->second.isGrip = true;
    changeTagsOf(tag);
    if (other)
        makeGrip(other);
}

/// The nearest turned handle from a vertex towards the body; 0: none.
int BendSession::turnedLimb(std::size_t slot) const {
    int found = 0;
    std::size_t least = 0;
    for (const auto &[tag, extent] : data.influence.extents) {
        // Around the limb, also what is farther from the handle than its core turns with it.
        const bool isOn = data.state.points.count(tag) > 0 &&
                          (data.state.points.at(tag).slot == slot || tags()[slot] == tag || extent->shareOf(slot) == 1);
        const std::size_t size = extent->beyond.size();
        if (isOn && jointOf(data, tag) && !handleOf(state(), tag).isLocked && (!found || size < least)) {
            found = tag;
            least = size;
        }
    }
    return found;
}

/// The vertex for a new handle of a vertex's limb; none if it is on no limb.
std::optional<std::size_t> BendSession::newLimb(std::size_t slot, double usual) {
    BendReach &glance = reach.glance();
    const double hair = usualGap(rest.diagonal());
    const std::size_t carrier = glance.carrierOf(slot, hair);
    const std::optional<std::size_t> root = glance.rootOfLimb(carrier, usual, hair);
    if (root && !canBecomePoint(data, *root))
        return canBecomePoint(data, carrier) ? std::optional(carrier) : std::nullopt;
    return root;
}

/// The handle of the limb that a vertex is on, else where a new one would be, if it is on a limb.
std::pair<int, std::optional<std::size_t>> BendSession::limbOf(std::size_t slot, double usual) {
    reach.lookAt(slot);
    const int found = turnedLimb(slot);
    const std::optional<std::size_t> root = newLimb(slot, usual);
    if (found && !(root && reach.glance().radiusAt(*root, usual) < thinLimb * radiusOf(data, found)))
        return {found, {}};
    return {0, root};
}

std::pair<int, std::shared_ptr<const BendExtent>> BendSession::glimpseLimb(int tag, std::optional<std::size_t> slot,
                                                                           double usual) {
    if (const auto point = state().points.find(tag); point != state().points.end())
        slot = point->second.slot;
    reach.begin();
    if (!slot || !reach.isRead())
        return {0, nullptr};
    const auto [found, root] = limbOf(*slot, usual);
    return {found, found ? glimpseOf(found) : root ? glimpseAt(*root, usual) : nullptr};
}

int BendSession::limbAt(std::size_t slot, double usual) {
    const auto [found, root] = limbOf(slot, usual);
    if (found || !root)
        return found;
    const int tag = addPoint(*root, usual);
    makeGrip(tag);
    return tag;
}

void BendSession::setRadius(int tag, double radius) {
    radius = std::min(std::max(radius, leastRadius * rest.diagonal()), mostRadius * rest.diagonal());
    const int other = mirrored(data, tag);
    setRadiusOf(data.state, tag, radius);
    if (other)
        setRadiusOf(data.state, other, radius);
    changeTags();
}

void BendSession::setRimAt(std::size_t slot, double radius) {
    const BendTags &marks = *state().marks;
    std::vector<char> isFixed(marks.size());
    for (std::size_t i = 0; i < isFixed.size(); ++i)
        isFixed[i] = marks[i] == 0;
    setRims(data.state, reach.piece(slot, isFixed), radius, marks.size());
    changeTags();
}

void BendSession::removeHandle(int tag) {
    freeHandle(data.state, tag);
    changeTags();
    writeMarks();
}

void BendSession::reset() {
    motionByHand(data.state).clear();
    if (state().poses || state().rank.empty())
        return; // named poses rely on what handles bend
    data.state.rank.clear();
    changeTags();
}
