// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/read_surface.h> // before Qt

#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/marks.h>

#include <algorithm>
#include <cassert>
#include <limits>

using vcg::fcd::Error;
using vcg::fcd::MotionStep;
using vcg::fcd::ParallelFor;

namespace {

const std::size_t grain = 1 << 14;

// From where a handle is mirrored, of the diagonal: the sides of a body are as different as that.
const double farthestTwin = 0.05;

/// The step on the other side of a mirror. (Exact where the layer's matrix keeps angles.)
MotionStep mirroredStep(const MotionStep &step, const Eigen::Affine3d &mirror) {
    MotionStep other = step;
    switch (step.kind) {
    case MotionStep::Translation: other.vector = mirror.linear() * step.vector; break;
    case MotionStep::Rotation: other.vector = -(mirror.linear() * step.vector); break;
    case MotionStep::Scaling: break;
    case MotionStep::Matrix:
        other.matrix = (mirror * Eigen::Affine3d(step.matrix) * mirror.inverse()).matrix();
        other.matrix.row(3) << 0, 0, 0, 1;
        break;
    }
    if (step.about)
        other.about = mirror * *step.about;
    return other;
}

} // namespace

BendSession::BendSession(MeshDocument &document, MeshModel &layer)
    : document(document), layer(layer), rest(layer), solver(document, layer) {
    if (layer.cm.vn == 0)
        throw Error("The layer '" + layer.label().toStdString() + "' has no vertices, so there is nothing to bend.");
    now.marks = marksNow(layer);
    isMarkedHere = hasMarks(layer);
    keepRest();
    updateTags();
}

void BendSession::keepRest() {
    rest.keep();
    surface.reset();
    reachOfRest.clear();
    solver.clear();
}

// --- what is held ---

std::vector<int> BendSession::handleTags() const {
    std::vector<int> all;
    all.reserve(center.size());
    for (const auto &each : center)
        all.push_back(int(each.first));
    return all;
}

int BendSession::unusedTag() const {
    int tag = 2;
    while (center.count(tag))
        ++tag;
    return tag;
}

Eigen::Affine3d BendSession::mirror() const {
    Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
    if (options.mirror >= 0) {
        mirror.linear()(options.mirror, options.mirror) = -1;
        mirror.translation()[options.mirror] = 2 * rest.middle()[options.mirror];
    }
    return rest.world() * mirror * rest.world().inverse();
}

int BendSession::mirrored(int tag) const {
    if (options.mirror < 0 || !center.count(tag))
        return 0;
    const Eigen::Vector3d there = mirror() * (rest.world() * placeOf(tag));
    int found = tag; // in the middle, it is its own
    double least = std::min(farthestTwin * rest.diagonal(), (rest.world() * placeOf(tag) - there).norm());
    for (const int other : handleTags()) {
        const double distance = (rest.world() * placeOf(other) - there).norm();
        if (other != tag && distance < least) {
            least = distance;
            found = other;
        }
    }
    return found == tag ? 0 : found;
}

namespace {

/// The live vertex nearest to a place, both in the layer. \param isDeleted, at of a slot, of \p count
template <class IsDeleted, class At>
std::optional<std::size_t> nearestOf(std::size_t count, const Eigen::Vector3d &place, const IsDeleted &isDeleted,
                                     const At &at) {
    struct Found {
        double square = std::numeric_limits<double>::infinity();
        std::size_t slot = 0;
    };
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

std::optional<std::size_t> BendSession::mirroredSlot(std::size_t slot) const {
    if (options.mirror < 0)
        return {};
    const vcg::fcd::SurfaceView view = surface->View();
    const Eigen::Vector3d there = rest.world().inverse() * (mirror() * (rest.world() * rest.at(slot)));
    return nearestOf(
        view.vertexSlots, there, [&](std::size_t i) { return view.IsDeleted(i); },
        [&](std::size_t i) { return rest.positions()[i]; });
}

Eigen::Vector3d BendSession::positionOf(std::size_t slot) const {
    return rest.world() * toVector(!besides                    ? layer.cm.vert[slot].cP()
                                   : besides->position.empty() ? rest.positions()[slot]
                                                               : besides->position[slot]);
}

/// Reads the surface at rest, if that has not been done, or its faces are others since.
void BendSession::readSurface() {
    if (besides && surface)
        return;
    const std::uint64_t faces = facesOf(layer.cm);
    if (surface && faces == facesOfSurface)
        return;
    surface = std::make_shared<const vcg::fcd::SurfaceArrays>(
        vcg::tri::ReadSurface(layer.cm, {}, [&](std::size_t slot) { return rest.positions()[slot]; }));
    facesOfSurface = faces;
}

void BendSession::expectReach() {
    if (reachOfRest.isReady())
        return;
    readSurface();
    reachOfRest.read(surface, rest.world().linear());
}

void BendSession::beginBeside() {
    readSurface();
    auto made = std::make_unique<Beside>();
    if (rest.isPosed()) {
        made->position.resize(rest.positions().size());
        forVertices(layer.cm, [&](std::size_t i) { made->position[i] = layer.cm.vert[i].cP(); });
    }
    for (const vcg::fcd::NamedPose &each : namedPoses())
        made->poses[each.motions] = inNumbers(each.motions);
    besides = std::move(made);
}

void BendSession::endBeside() {
    const std::unique_ptr<Beside> ended = std::move(besides);
    if (ended && ended->arePosesNew)
        writePoses();
}

const std::vector<std::size_t> &BendSession::reach(const std::vector<std::size_t> &vertices, double radius) {
    if (!reachOfRest.knows(vertices, radius))
        expectReach();
    return reachOfRest.of(vertices, radius);
}

// --- changes ---

/// The state is another one.
void BendSession::takeState() {
    crossApplies();
    options.pose = now.pose;
    updateTags();
    writeMarks();
    writePoses();
}

void BendSession::undo() {
    forgetWhatIsGone();
    if (history.undo(now))
        takeState();
}

void BendSession::redo() {
    if (history.redo(now))
        takeState();
}

void BendSession::cancel() {
    if (!history.cancel(now))
        return;
    marking.reset();
    marked.clear();
    takeState();
}

/// Whether a point could be made of a vertex.
bool BendSession::canBecomePoint(std::size_t slot) const {
    return isFree(slot) && ((*effective)[slot] < 2 || isAlong(slot));
}

int BendSession::addPoint(std::size_t slot, double radius) {
    const auto add = [&, rank = rankOfNew()](std::size_t at) {
        assert(canBecomePoint(at));
        const int tag = unusedTag();
        now.points[tag] = {at, radius};
        if (rank > 0)
            now.rank[tag] = rank;
        changeTagsOf(tag);
        return tag;
    };
    expectReach();
    if (const std::size_t carrier = reachOfRest.carrierOf(slot, usualGap()); canBecomePoint(carrier))
        slot = carrier;
    const int tag = add(slot);
    const auto other = mirroredSlot(slot);
    if (!other || (rest.at(*other) - rest.at(slot)).norm() <= 1e-3 * rest.diagonal())
        return tag;
    const Eigen::Vector3d there = mirror() * (rest.world() * rest.at(slot));
    if ((rest.world() * rest.at(*other) - there).norm() < farthestTwin * rest.diagonal() && canBecomePoint(*other))
        add(*other);
    return tag;
}

void BendSession::setMotion(const std::map<int, std::vector<MotionStep>> &steps) {
    for (const auto &[tag, here] : steps) {
        if (const int other = mirrored(tag); other && steps.count(other) == 0) {
            std::vector<MotionStep> there;
            there.reserve(here.size());
            for (const MotionStep &step : here)
                there.push_back(mirroredStep(step, mirror()));
            motionByHand()[other] = there;
        }
        motionByHand()[tag] = here;
    }
}

void BendSession::setMotions(const std::string &text) {
    auto motion = vcg::fcd::ReadMotionText(text, "The motions");
    for (const auto &[tag, steps] : motion) {
        if (!center.count(tag))
            throw Error("The motions move handle " + std::to_string(tag) + ", but no vertex has that tag.");
        vcg::fcd::ToMotion(steps, rest.world() * center.at(tag)); // to say what is wrong with it
    }
    motionByHand() = std::move(motion);
}

void BendSession::setPose(double percent) {
    if (percent != now.pose)
        now.weights.clear(); // a part of a blend is none
    options.pose = now.pose = percent;
}

void BendSession::reset() {
    motionByHand().clear();
    if (now.poses || now.rank.empty())
        return; // what handles bend is the named poses', too
    now.rank.clear();
    changeTags();
}
