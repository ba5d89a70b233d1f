// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_session.h"

#include <layer_fcd/marks.h>
#include <layer_fcd/tagging.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <set>

using vcg::fcd::Error;
using vcg::fcd::MotionStep;
using vcg::fcd::ParallelFor;

namespace {

const std::size_t grain = 1 << 14;
const std::size_t mostTags = 64;       // of those that a person gives
const unsigned char markOpacity = 150; // of 255: the surface is still seen
const double pointSize = 0.08;         // of a point's radius: so far it is held, that a single vertex makes no spike

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

/// The tags of a layer, null where nothing is tagged. What is no tags, patches for example, counts as nothing.
std::shared_ptr<const BendTags> marksNow(const MeshModel &layer) {
    auto present = std::make_shared<BendTags>();
    try {
        *present = presentTags(layer, {});
    } catch (const Error &) { // no whole numbers
        return nullptr;
    }
    std::set<int> tags;
    for (auto tag = present->begin(); tag != present->end() && tags.size() <= mostTags; ++tag)
        if (tag == present->begin() || *tag != *std::prev(tag))
            tags.insert(*tag);
    return tags.size() > mostTags || tags == std::set<int>{1} ? nullptr : present;
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

bool BendSession::isAsLeft() const {
    if (!isUpToDate())
        return false;
    const auto marks = marksNow(layer);
    return marks && now.marks ? *marks == *now.marks : !marks && !now.marks;
}

void BendSession::keepRest() {
    rest.keep();
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

Eigen::Vector3d BendSession::centerOf(int tag) const {
    Eigen::Vector3d place = rest.world() * center.at(tag);
    const auto steps = now.motion.find(tag);
    if (steps == now.motion.end())
        return place;
    return (vcg::fcd::ToMotion(steps->second, place).At(options.pose, place) * place.homogeneous()).head<3>();
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
    const Eigen::Vector3d there = mirror() * (rest.world() * center.at(tag));
    int found = 0;
    double least = 0.05 * rest.diagonal();
    for (const auto &[other, place] : center) {
        const double distance = (rest.world() * place - there).norm();
        if (other != tag && distance < least) {
            least = distance;
            found = int(other);
        }
    }
    return found;
}

namespace {

/// The live vertex nearest to a place, both in the layer. \param at position of a slot
template <class At>
std::optional<std::size_t> nearestOf(const CMeshO &mesh, const Eigen::Vector3d &place, const At &at) {
    struct Found {
        double square = std::numeric_limits<double>::infinity();
        std::size_t slot = 0;
    };
    std::vector<Found> found((mesh.vert.size() + grain - 1) / grain);
    ParallelFor(0, mesh.vert.size(), grain, [&](std::size_t first, std::size_t last) {
        Found here;
        for (std::size_t i = first; i < last; ++i) {
            const double square = (toVector(at(i)) - place).squaredNorm();
            if (square < here.square && !mesh.vert[i].IsD())
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
    const auto slot =
        nearestOf(layer.cm, rest.world().inverse() * place, [&](std::size_t i) { return layer.cm.vert[i].cP(); });
    if (slot)
        distance = (positionOf(*slot) - place).norm();
    return slot;
}

std::optional<std::size_t> BendSession::mirroredSlot(std::size_t slot) const {
    if (options.mirror < 0)
        return {};
    const Eigen::Vector3d there = rest.world().inverse() * (mirror() * (rest.world() * rest.at(slot)));
    return nearestOf(layer.cm, there, [&](std::size_t i) { return rest.positions()[i]; });
}

Eigen::Vector3d BendSession::positionOf(std::size_t slot) const {
    return rest.world() * toVector(layer.cm.vert[slot].cP());
}

const std::vector<std::size_t> &BendSession::reach(std::size_t slot, double radius) {
    if (!reachOfRest.isReady() && !reachOfRest.knows(slot, radius)) {
        const bool posed = rest.isPosed();
        rest.restoreVertices();
        reachOfRest.read(layer, rest.world().linear());
        if (posed)
            pose(true);
    }
    return reachOfRest.of(slot, radius);
}

/// Makes the tags that marks and points amount to.
void BendSession::updateTags() {
    if (now.marks && now.points.empty()) {
        effective = now.marks;
    } else if (!now.marks && now.points.empty()) {
        effective = std::make_shared<const BendTags>(rest.positions().size(), 1);
    } else {
        auto made =
            now.marks ? std::make_shared<BendTags>(*now.marks) : std::make_shared<BendTags>(rest.positions().size(), 0);
        if (!now.marks)
            for (const auto &each : now.points)
                for (std::size_t i : reach(each.second.slot, each.second.radius))
                    (*made)[i] = 1;
        for (const auto &[tag, point] : now.points) {
            for (std::size_t i : reach(point.slot, point.radius * pointSize))
                if ((*made)[i] == 1)
                    (*made)[i] = tag;
            (*made)[point.slot] = tag;
        }
        if (!effective || *made != *effective)
            effective = made;
    }
    center = vcg::fcd::HandleCenters(*effective, [&](std::size_t i) { return rest.at(i); });
    for (auto each = now.motion.begin(); each != now.motion.end();)
        each = center.count(each->first) ? std::next(each) : now.motion.erase(each);
}

/// Gives the layer the marks.
void BendSession::writeMarks() {
    dropMarks(layer);
    if (now.marks)
        setMarks(layer, *now.marks);
    else if (marksNow(layer)) // it has tags elsewhere, which are not to be seen
        setMarks(layer, BendTags(layer.cm.vert.size(), 1));
    isMarkedHere = hasMarks(layer);
}

std::vector<vcg::Color4b> BendSession::overlay() {
    if (isStretchShown()) {
        if (!stretch)
            stretch = std::make_unique<StretchColors>(layer);
        return stretch->of(rest.positions(), rest.world().linear());
    }
    std::vector<vcg::Color4b> color;
    if (!marking && !now.marks)
        return color;
    const BendTags &tags = marking ? *marking : *effective;
    color.assign(tags.size(), vcg::Color4b(0, 0, 0, 0));
    ParallelFor(0, tags.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (tags[i] != 1) {
                color[i] = colorOfTag(tags[i]);
                color[i][3] = markOpacity;
            }
    });
    return color;
}

bool BendSession::isStretchShown() const { return options.stretch && !marking && layer.cm.fn > 0; }

// --- changes ---

/// The state is another one.
void BendSession::takeState() {
    crossApplies();
    updateTags();
    writeMarks();
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
    takeState();
}

void BendSession::mark(const std::vector<std::size_t> &vertices, int tag) {
    if (!marking) {
        marking = std::make_shared<BendTags>(*effective);
        now.points.clear(); // they are marks from now on
    }
    for (std::size_t i : vertices)
        (*marking)[i] = tag;
}

void BendSession::endMarks() {
    if (!marking)
        return;
    now.marks = std::move(marking);
    updateTags();
    writeMarks();
}

void BendSession::clearMarks() {
    now.marks.reset();
    now.points.clear();
    now.motion.clear();
    updateTags();
    writeMarks();
}

int BendSession::addPoint(std::size_t slot, double radius) {
    const auto add = [&](std::size_t at) {
        assert(!now.marks || (*effective)[at] == 1);
        const int tag = unusedTag();
        now.points[tag] = {at, radius};
        updateTags();
        return tag;
    };
    const int tag = add(slot);
    const auto other = mirroredSlot(slot);
    if (other && (rest.at(*other) - rest.at(slot)).norm() > 1e-3 * rest.diagonal() && (*effective)[*other] < 2 &&
        !(now.marks && (*effective)[*other] != 1))
        add(*other);
    return tag;
}

void BendSession::setRadius(int tag, double radius) {
    const auto set = [&](int which) {
        const auto point = now.points.find(which);
        if (point != now.points.end())
            point->second.radius = radius;
    };
    set(tag);
    set(mirrored(tag));
    updateTags();
}

void BendSession::setMotion(int tag, std::vector<MotionStep> steps) {
    if (const int other = mirrored(tag)) {
        std::vector<MotionStep> there;
        there.reserve(steps.size());
        for (const MotionStep &step : steps)
            there.push_back(mirroredStep(step, mirror()));
        now.motion[other] = there;
    }
    now.motion[tag] = std::move(steps);
}

void BendSession::setMotions(const std::string &text) {
    auto motion = vcg::fcd::ReadMotionText(text, "The motions");
    for (const auto &[tag, steps] : motion) {
        if (!center.count(tag))
            throw Error("The motions move handle " + std::to_string(tag) + ", but no vertex has that tag.");
        vcg::fcd::ToMotion(steps, rest.world() * center.at(tag)); // to say what is wrong with it
    }
    now.motion = std::move(motion);
}

void BendSession::reset() { now.motion.clear(); }
