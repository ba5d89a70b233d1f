// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_session.h"

#include "../filter_fcd/fcd_aside.h"
#include "../filter_fcd/fcd_copy.h"
#include "../filter_fcd/fcd_pose.h"
#include "../filter_fcd/fcd_rest.h"
#include "../filter_fcd/fcd_window.h"

#include <vcg_ext/surface_reach.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>

using vcg::fcd::Error;
using vcg::fcd::MotionStep;
using vcg::fcd::ParallelFor;

namespace {

const std::size_t grain = 1 << 14;
const double pointSize = 0.08;    // of a point's radius: so far it is held, that a single vertex makes no spike
const std::size_t mostSteps = 32; // of undo: each may hold tags of its own

std::string digits(double number) {
    char text[32];
    return std::string(text, std::to_chars(text, text + sizeof text, number).ptr);
}

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

bool isSame(const MotionStep &a, const MotionStep &b) {
    return a.kind == b.kind && a.vector == b.vector && a.degrees == b.degrees && a.about == b.about &&
           a.matrix == b.matrix;
}

} // namespace

bool BendState::operator==(const BendState &other) const {
    return marks == other.marks && points == other.points && motion.size() == other.motion.size() &&
           std::equal(motion.begin(), motion.end(), other.motion.begin(), [](const auto &a, const auto &b) {
               return a.first == b.first &&
                      std::equal(a.second.begin(), a.second.end(), b.second.begin(), b.second.end(), isSame);
           });
}

BendSession::BendSession(MeshModel &layer) : layer(layer), world(invertibleMatrixOf(layer)) {
    if (layer.cm.vn == 0)
        throw Error("The layer '" + layer.label().toStdString() + "' has no vertices, so there is nothing to bend.");
    BendTags present;
    try {
        present = presentTags(layer, target);
        if (std::set<int>(present.begin(), present.end()).size() > 64) // of something else, patches for example
            throw Error("not tags");
    } catch (const Error &) {
        target.attribute = "fcd_tag"; // leaves a quality that is none of ours alone
        present = presentTags(layer, target);
    }
    if (std::any_of(present.begin(), present.end(), [](int tag) { return tag != 1; }))
        now.marks = std::make_shared<const BendTags>(std::move(present));
    const int mask = layer.dataMask() & (MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY);
    color.resize((mask & MeshModel::MM_VERTCOLOR) != 0 ? layer.cm.vert.size() : 0);
    quality.resize((mask & MeshModel::MM_VERTQUALITY) != 0 ? layer.cm.vert.size() : 0);
    for (std::size_t i = 0; i < color.size(); ++i)
        color[i] = layer.cm.vert[i].cC();
    for (std::size_t i = 0; i < quality.size(); ++i)
        quality[i] = layer.cm.vert[i].cQ();
    keepRest();
    updateTags();
}

void BendSession::keepRest() {
    const CMeshO &mesh = layer.cm;
    position.resize(mesh.vert.size());
    normal.resize(mesh.vert.size());
    faceNormal.resize(mesh.face.size());
    for (std::size_t i = 0; i < position.size(); ++i) {
        position[i] = mesh.vert[i].cP();
        normal[i] = mesh.vert[i].cN();
    }
    for (std::size_t f = 0; f < faceNormal.size(); ++f)
        faceNormal[f] = mesh.face[f].cN();
    box = mesh.bbox;
    Eigen::AlignedBox3d all, allInWorld;
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD()) {
            all.extend(toVector(vertex.cP()));
            allInWorld.extend(world * toVector(vertex.cP()));
        }
    middle = all.center();
    size = allInWorld.diagonal().norm();
    shape = shapeOf(mesh);
    isPosed = false;
    surface.reset();
    reachedFrom = std::size_t(-1);
    deformer.reset();
    preparedFor.reset();
    last.reset();
}

bool BendSession::isUpToDate() const {
    const CMeshO &mesh = layer.cm;
    if (mesh.vert.size() != position.size() || mesh.face.size() != faceNormal.size() || shapeOf(mesh) != shape)
        return false;
    Eigen::Matrix4d present;
    mesh.Tr.ToEigenMatrix(present);
    if (present != world.matrix())
        return false;
    if (!now.marks || !target.attribute.isEmpty())
        return true;
    if (!layer.hasDataMask(MeshModel::MM_VERTQUALITY))
        return false;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD() && double(mesh.vert[i].cQ()) != double((*effective)[i]))
            return false;
    return true;
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
    Eigen::Vector3d rest = world * center.at(tag);
    const auto steps = now.motion.find(tag);
    if (steps == now.motion.end())
        return rest;
    return (vcg::fcd::ToMotion(steps->second, rest).At(options.pose, rest) * rest.homogeneous()).head<3>();
}

Eigen::Affine3d BendSession::mirror() const {
    Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
    if (options.mirror >= 0) {
        mirror.linear()(options.mirror, options.mirror) = -1;
        mirror.translation()[options.mirror] = 2 * middle[options.mirror];
    }
    return world * mirror * world.inverse();
}

int BendSession::mirrored(int tag) const {
    if (options.mirror < 0 || !center.count(tag))
        return 0;
    const Eigen::Vector3d there = mirror() * (world * center.at(tag));
    int found = 0;
    double least = 0.05 * size;
    for (const auto &[other, place] : center) {
        const double distance = (world * place - there).norm();
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
        nearestOf(layer.cm, world.inverse() * place, [&](std::size_t i) { return layer.cm.vert[i].cP(); });
    if (slot)
        distance = (positionOf(*slot) - place).norm();
    return slot;
}

std::optional<std::size_t> BendSession::mirroredSlot(std::size_t slot) const {
    if (options.mirror < 0)
        return {};
    const Eigen::Vector3d there = world.inverse() * (mirror() * (world * toVector(position[slot])));
    return nearestOf(layer.cm, there, [&](std::size_t i) { return position[i]; });
}

Eigen::Vector3d BendSession::positionOf(std::size_t slot) const { return world * toVector(layer.cm.vert[slot].cP()); }

const std::vector<std::size_t> &BendSession::reach(std::size_t slot, double radius) {
    if (reachedFrom == slot && reachedRadius == radius)
        return reached;
    if (!surface) {
        const bool posed = isPosed;
        restoreVertices();
        surface = std::make_unique<vcg::fcd::SurfaceGraph>(
            vcg::tri::BuildSurfaceGraph(layer.cm, nullptr, {}, world.linear()));
        if (posed)
            pose(true);
    }
    reached.clear();
    const vcg::fcd::Index seed = surface->nodeOf[slot];
    if (seed >= 0) {
        std::vector<char> isIn(std::size_t(surface->graph.Size()), 0);
        for (vcg::fcd::Index node : vcg::fcd::NodesWithin(surface->graph, seed, radius / surface->frame.scale))
            isIn[std::size_t(node)] = 1;
        for (std::size_t i = 0; i < surface->nodeOf.size(); ++i)
            if (surface->nodeOf[i] >= 0 && isIn[std::size_t(surface->nodeOf[i])])
                reached.push_back(i);
    }
    reachedFrom = slot;
    reachedRadius = radius;
    return reached;
}

/// Makes the tags that marks and points amount to.
void BendSession::updateTags() {
    if (now.marks && now.points.empty()) {
        effective = now.marks;
    } else if (!now.marks && now.points.empty()) {
        effective = std::make_shared<const BendTags>(position.size(), 1);
    } else {
        auto made = now.marks ? std::make_shared<BendTags>(*now.marks) : std::make_shared<BendTags>(position.size(), 0);
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
    center = vcg::fcd::HandleCenters(*effective, [&](std::size_t i) { return toVector(position[i]); });
    for (auto each = now.motion.begin(); each != now.motion.end();)
        each = center.count(each->first) ? std::next(each) : now.motion.erase(each);
}

void BendSession::showTags() {
    hideStretch();
    if (now.marks) {
        writeTags(layer, *effective, target);
        return;
    }
    for (std::size_t i = 0; i < color.size(); ++i)
        layer.cm.vert[i].C() = color[i];
    if (layer.hasDataMask(MeshModel::MM_VERTCOLOR) && color.empty())
        for (CVertexO &vertex : layer.cm.vert)
            vertex.C() = vcg::Color4b(vcg::Color4b::White);
    if (layer.hasDataMask(MeshModel::MM_VERTQUALITY))
        for (std::size_t i = 0; i < layer.cm.vert.size(); ++i)
            layer.cm.vert[i].Q() = quality.empty() ? 0 : quality[i];
}

// --- changes ---

void BendSession::change() {
    if (!before.empty() && before.back() == now)
        return; // nothing came of the last
    before.push_back(now);
    if (before.size() > mostSteps)
        before.erase(before.begin());
    after.clear();
}

/// The last of \p states becomes the present one.
void BendSession::take(std::vector<BendState> &states) {
    now = states.back();
    states.pop_back();
    updateTags();
    showTags();
}

void BendSession::undo() {
    while (!before.empty() && before.back() == now)
        before.pop_back();
    if (before.empty())
        return;
    after.push_back(now);
    take(before);
}

void BendSession::redo() {
    if (after.empty())
        return;
    before.push_back(now);
    take(after);
}

void BendSession::cancel() {
    if (before.empty())
        return;
    if (marking)
        coloredByTags(layer);
    marking.reset();
    take(before);
}

void BendSession::mark(const std::vector<std::size_t> &vertices, int tag) {
    if (!marking) {
        hideStretch();
        marking = std::make_shared<BendTags>(*effective);
        now.points.clear(); // they are marks from now on
        if (!now.marks || !layer.hasDataMask(MeshModel::MM_VERTCOLOR))
            writeTags(layer, *marking, target);
    }
    for (std::size_t i : vertices) {
        (*marking)[i] = tag;
        layer.cm.vert[i].C() = colorOfTag(tag);
    }
}

void BendSession::endMarks() {
    if (!marking)
        return;
    coloredByTags(layer); // mark() did it
    now.marks = std::move(marking);
    updateTags();
    showTags();
}

void BendSession::clearMarks() {
    now = BendState();
    updateTags();
    showTags();
}

int BendSession::addPoint(std::size_t slot, double radius) {
    const auto add = [&](std::size_t at) {
        if (now.marks && (*effective)[at] != 1)
            throw Error(
                "There the surface does not bend: it is " +
                std::string((*effective)[at] > 1 ? "a handle" : "fixed, or outside of the region of influence") +
                ". Mark it as free first, or clear the marks.");
        const int tag = unusedTag();
        now.points[tag] = {at, radius};
        updateTags();
        return tag;
    };
    const int tag = add(slot);
    const auto other = mirroredSlot(slot);
    if (other && (toVector(position[*other]) - toVector(position[slot])).norm() > 1e-3 * size &&
        (*effective)[*other] < 2 && !(now.marks && (*effective)[*other] != 1))
        add(*other);
    if (now.marks)
        showTags();
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
        vcg::fcd::ToMotion(steps, world * center.at(tag)); // to say what is wrong with it
    }
    now.motion = std::move(motion);
}

void BendSession::reset() { now.motion.clear(); }

// --- the pose ---

/// What the panel sets, as it reaches a filter.
template <class Param>
void BendSession::setUp(Param &param) const {
    if (!target.attribute.isEmpty()) {
        param.handles.source = HandleParam::Attribute;
        param.handles.tagAttribute = target.attribute;
    }
    param.handles.transforms = QString::fromStdString(motionText());
    param.deformation.smoothness = options.smoothness;
    param.deformation.pose = options.pose;
    param.deformation.graph.initialPatches = options.initialPatches;
    param.deformation.weights = options.weights;
}

PoseParam BendSession::poseParamNow() const {
    PoseParam param;
    setUp(param);
    const MeshDocument none; // hosts hand numbers over in single precision
    PoseParam given = poseParam(toRichParameters(param, none), none);
    given.deformation.weights = options.weights; // not in every host's dialog
    return given;
}

vcg::fcd::Handles BendSession::handlesNow() const {
    vcg::fcd::Handles held;
    held.world = world;
    for (const auto &[tag, steps] : now.motion)
        if (center.count(tag))
            held.motion[tag] = vcg::fcd::ToMotion(steps, world * center.at(tag));
    return held;
}

bool BendSession::moves() const {
    const vcg::fcd::Handles held = handlesNow();
    return options.pose != 0 && std::any_of(held.motion.begin(), held.motion.end(), [](const auto &each) {
               return !each.second.matrix.isIdentity(0) || !each.second.turn.isZero(0);
           });
}

double BendSession::prepare() {
    if (deformer && preparedFor == effective && preparedPatches == options.initialPatches &&
        preparedWeights == options.weights)
        return 0;
    const vcg::fcd::Stopwatch watch;
    restoreVertices();
    last.reset();
    deformer.reset();
    vcg::fcd::Handles held = handlesNow();
    held.tag = *effective;
    vcg::tri::CountHandles(layer.cm, held); // something to hold, and to bend
    Eigen::Matrix3Xd rest;
    deformer = vcg::tri::PrepareDeformer(layer.cm, held, poseParamNow().deformation, rest);
    preparedFor = effective;
    preparedPatches = options.initialPatches;
    preparedWeights = options.weights;
    return 1000 * watch.Seconds();
}

BendSession::Times BendSession::pose(bool full) {
    Times times;
    if (!moves()) {
        restoreShape();
        updateStretch();
        return times;
    }
    times.prepare = prepare();
    vcg::fcd::Stopwatch watch;
    vcg::fcd::DeformationParam param = poseParamNow().deformation;
    const vcg::fcd::Handles held = handlesNow();
    if (full) {
        last = deformer->Solve(held, param);
    } else {
        param.maxIterations = 20;
        param.tolerance = std::max(param.tolerance, 1e-4);
        last = deformer->Solve(deformer->MotionsOf(held, param.pose), param, last ? &*last : nullptr);
    }
    times.solve = 1000 * watch.Seconds();
    watch = {};
    writeVertices(*last);
    if (full) {
        computeFaceNormals(layer.cm, {});
        vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
        shape = shapeOf(layer.cm);
    }
    updateStretch();
    times.write = 1000 * watch.Seconds();
    return times;
}

/// Positions and normals, in one pass.
void BendSession::writeVertices(const vcg::fcd::Deformer::Pose &pose) {
    CMeshO &mesh = layer.cm;
    isPosed = true;
    vcg::fcd::Carrier(*deformer, pose)
        .ApplyWithNormals([&](std::size_t i) { return toVector(position[i]); },
                          [&](std::size_t i) { return toVector(normal[i]); },
                          [&] {
                              return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Vector3d &n) {
                                  mesh.vert[i].P() = toPoint(p);
                                  mesh.vert[i].N() = toPoint(n);
                              };
                          },
                          vcg::fcd::Progress(), [&](std::size_t i) { prefetch(position[i], normal[i], mesh.vert[i]); });
}

void BendSession::restoreVertices() {
    if (!isPosed || layer.cm.vert.size() != position.size())
        return;
    ParallelFor(0, position.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            layer.cm.vert[i].P() = position[i];
            layer.cm.vert[i].N() = normal[i];
        }
    });
    isPosed = false;
}

void BendSession::restore() {
    hideStretch();
    restoreShape();
}

void BendSession::restoreShape() {
    if (layer.cm.vert.size() != position.size() || layer.cm.face.size() != faceNormal.size())
        return; // another mesh by now
    restoreVertices();
    for (std::size_t f = 0; f < faceNormal.size(); ++f)
        layer.cm.face[f].N() = faceNormal[f];
    layer.cm.bbox = box;
    shape = shapeOf(layer.cm);
    last.reset();
}

void BendSession::updateStretch() {
    if (!options.stretch || marking || layer.cm.fn == 0) {
        hideStretch();
        return;
    }
    if (!stretch)
        stretch = std::make_unique<StretchColors>(layer);
    stretch->show(position, world.linear());
}

void BendSession::hideStretch() {
    if (stretch)
        stretch->bringBack();
    stretch.reset();
}

// --- apply ---

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

std::string BendSession::applyInPlace(MeshDocument &document, const Remark &remark) {
    const PoseParam param = poseParamNow();
    restore();
    TagTarget silent = target;
    silent.colorize = false; // the look is as it is
    writeTags(layer, *effective, silent);
    std::string calls;
    if (RestShape::exists(layer) && RestShape(layer).shape() != shapeOf(layer.cm)) {
        resetPose(layer, true); // poses begin with the shape that it has here
        calls = "ms.apply_filter('apply_coord_fcd_reset', keep_shape=True); ";
    }
    PreparedLayers prepared;
    poseInPlace(document, layer, param, prepared, remark, vcg::fcd::Progress());
    calls += filterCall("apply_coord_fcd_deformation", "");
    keepRest();
    if (!now.marks && target.attribute.isEmpty()) { // the tags that the call needs stay
        quality.assign(effective->begin(), effective->end());
    }
    now.motion.clear();
    if (!now.marks)
        now.points.clear();
    before.clear();
    after.clear();
    updateTags();
    return calls;
}

std::string BendSession::applyToNewLayer(MeshDocument &document, bool graphLayers, const Remark &remark) {
    DeformMeshParam param;
    setUp(param);
    param.graphLayers = graphLayers;
    const std::string call = filterCall("generate_fcd_deformed_mesh", graphLayers ? "" : ", graph_layers=False");
    param = deformMeshParam(toRichParameters(param, document), document);
    restore();
    TagTarget silent = target;
    silent.colorize = false;
    writeTags(layer, *effective, silent);

    // As FCD: Deform Mesh does it.
    vcg::fcd::Handles given = readHandles(layer, param.handles);
    param.deformation.linear = hasDirections(layer);
    vcg::fcd::DeformationResult result;
    PreparedLayers cache;
    const std::shared_ptr<Prepared> prepared = cache.get(document, layer, nullptr, given, param.deformation, [&] {
        return vcg::tri::PrepareDeformer(layer.cm, given, param.deformation, result.position);
    });
    readMotions(document, layer, param.handles, prepared->deformer->center, remark, given);
    vcg::tri::PoseMesh(layer.cm, given, *prepared->deformer, param.deformation, vcg::fcd::Progress(), result);
    NewLayers layers(document, layer, remark);
    const std::vector<MeshModel *> results = addResult(layers, layer, prepared, result, graphLayers, {});
    now.motion.clear();
    layers.keep(*results.back());
    showResult(document, layer, results);
    return call;
}
