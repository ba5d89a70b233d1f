// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/carrier.h> // before Qt

#include "edit_fcd/bend/model/animation_export.h" // before Qt
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/handle_sources.h>
#include <layer_fcd/new_layers.h>

#include <utility>

// Named poses, which the layer keeps.

using vcg::fcd::Error;
using vcg::fcd::Motion;
using vcg::fcd::MotionStep;
using vcg::fcd::PoseSequence;

/// A text of motions without names of layers, which the background cannot read. If one is missing, it is unchanged.
std::string BendSession::inNumbers(const std::string &motions) const {
    if (besides) {
        const auto known = besides->poses.find(motions);
        return known == besides->poses.end() ? motions : known->second;
    }
    const QString text = QString::fromStdString(motions);
    if (!text.contains("layer", Qt::CaseInsensitive))
        return motions;
    try {
        return vcg::fcd::WriteMotionText(readMotionSteps(document, layer, text));
    } catch (const Error &) {
        return motions;
    }
}

PoseSequence BendSession::posesInNumbers() const {
    PoseSequence poses = *state().poses;
    for (vcg::fcd::NamedPose &each : poses.pose)
        each.motions = inNumbers(each.motions);
    return poses;
}

std::vector<std::map<int, Motion>> BendSession::motionsOfPoses() const {
    return motionsOf(posesInNumbers(), document, layer, data.influence.center, rest.world());
}

/// The positions of the vertices in a pose.
std::vector<Point3m> BendSession::positionsIn(const vcg::fcd::Deformer::Pose &pose) const {
    std::vector<Point3m> position = rest.positions();
    const auto take = [&](std::size_t slot, const Eigen::Vector3d &p, const Eigen::Matrix3f &) {
        position[slot] = toPoint(p);
    };
    vcg::fcd::Carrier(*solver.prepared()->deformer, pose)
        .Apply([&](std::size_t slot) { return rest.at(slot); }, [&] { return take; }, false, {}, [](std::size_t) {});
    return position;
}

/// Changes the named poses after a handle is new or holds other vertices, so that it stays in its place in each pose.
/// \param tagsBefore, centerBefore before that change
void BendSession::keepPlaceInPoses(int tag, std::shared_ptr<const BendTags> tagsBefore,
                                   const std::map<vcg::fcd::Index, Eigen::Vector3d> &centerBefore) {
    const bool isNew = centerBefore.count(tag) == 0;
    bool isMoving = !isNew; // its vertices move in some pose
    for (std::size_t i = 0; !isMoving && i < tags().size(); ++i)
        isMoving = tags()[i] == tag && (*tagsBefore)[i] != 0;
    if (!state().poses || !isMoving)
        return;
    PoseSequence changed = *state().poses;
    const auto motions = motionsOf(posesInNumbers(), document, layer, centerBefore, rest.world());
    const std::vector<Point3m> shown = besides->position;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        auto steps = vcg::fcd::ReadMotionText(inNumbers(changed.pose[i].motions));
        if (!isNew && !steps.count(tag))
            continue;
        data.influence.tags.swap(tagsBefore);
        prepare();
        besides->position =
            positionsIn(solver.solve({motions[i].begin(), motions[i].end()}, deformationOf(data.options), true));
        data.influence.tags.swap(tagsBefore);
        steps[tag] = stepsSeen(tag);
        changed.pose[i].motions = vcg::fcd::WriteMotionText(steps);
    }
    besides->position = shown;
    setPoses(std::move(changed));
}

bool BendSession::takePoses() {
    std::optional<PoseSequence> poses = posesOf(layer);
    if (!poses && !state().poses)
        return true;
    if (poses && state().poses && PoseSequenceText(*poses) == PoseSequenceText(*state().poses))
        return true;
    change();
    data.state.weights.clear();
    data.state.poses = poses ? std::make_shared<const PoseSequence>(std::move(*poses)) : nullptr;
    return !state().poses || !state().poses->surface || state().poses->surface->IsSame(rest.mark());
}

void BendSession::setPoses(PoseSequence poses) {
    poses.surface = rest.mark();
    if (!poses.pose.empty())
        poses.Validate();
    data.state.poses = poses.pose.empty() ? nullptr : std::make_shared<const PoseSequence>(std::move(poses));
    writePoses();
}

void BendSession::writePoses() {
    if (besides) {
        besides->arePosesNew = true;
        return;
    }
    keepPoses(document, layer, state().poses ? *state().poses : PoseSequence());
    if (state().poses)
        writeAppliedTags(); // the filter knows handles by their tags
}

std::string BendSession::keepPose() {
    if (!isMoved(data))
        throw Error("Nothing was moved, so there is no pose to keep.");
    BendMotions motion = state().motion;
    if (const double percent = data.options.pose; percent != 100)
        for (auto &[tag, steps] : motion) {
            const Eigen::Vector3d place = data.rest(tag);
            steps = stepsOf(vcg::fcd::Blend({{vcg::fcd::ToMotion(steps, place), percent}}, place), place);
        }
    setPoses(withPose(state().poses ? *state().poses : PoseSequence(), vcg::fcd::WriteMotionText(motion)));
    blend(aloneOf(state().poses->pose.size(), state().poses->pose.size() - 1));
    return sequenceCall(false);
}

void BendSession::replacePose(std::size_t other, std::size_t number) {
    PoseSequence poses = *state().poses;
    poses.pose[other].motions = poses.pose[number].motions;
    const bool wasAlone = weightsOfPoses(state())[number] == 100;
    data.state.poses = std::make_shared<const PoseSequence>(std::move(poses));
    removePose(number);
    if (wasAlone)
        blend(aloneOf(state().poses->pose.size(), other < number ? other : other - 1)); // the same shape as before
}

void BendSession::removePose(std::size_t number) {
    data.state.weights.clear(); // the motions stay, but are no blend any more
    setPoses(withoutPose(*state().poses, number));
}

void BendSession::blend(const std::vector<double> &weights) {
    const std::vector<std::map<int, Motion>> poses = motionsOfPoses();
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (weights[i] != 0)
            shown.push_back(i);
    BendMotions blended;
    if (shown.size() == 1 && weights[shown.front()] == 100) {
        blended = readMotionSteps(document, layer, QString::fromStdString(state().poses->pose[shown.front()].motions));
    } else {
        for (const auto &[tag, middle] : data.influence.center) {
            std::vector<std::pair<Motion, double>> motions;
            motions.reserve(shown.size());
            for (const std::size_t i : shown)
                motions.emplace_back(poses[i].at(int(tag)), weights[i]);
            const Eigen::Vector3d place = rest.world() * middle;
            std::vector<MotionStep> steps = stepsOf(vcg::fcd::Blend(motions, place), place);
            if (!steps.empty())
                blended[int(tag)] = std::move(steps);
        }
    }
    setPose(data, 100);
    motionByHand(data.state) = std::move(blended);
    if (!shown.empty())
        data.state.weights = weights;
}

void BendSession::loadPoses(const QString &file) {
    PoseSequence poses = readPoses(layer, file, rest.mark());
    motionsOf(poses, document, layer, data.influence.center, rest.world()); // throws if they are wrong
    data.state.weights.clear();
    setPoses(std::move(poses));
}

double BendSession::beginAnimation(const vcg::fcd::Progress &progress) {
    expectAnimation(state());
    std::vector<std::map<int, Motion>> motions = motionsOfPoses();
    prepare(progress);
    solver.beginBlends(std::move(motions), rest.world(), deformationOf(data.options));
    return state().poses->key.back().time - state().poses->key.front().time;
}

void BendSession::showAnimation(double time) {
    isLeft = false;
    writePose(solver.solveNextBlend(state().poses->WeightsAt(state().poses->key.front().time + time)));
}

BendSession::BlendSource BendSession::blendSource() const {
    BlendSource source = {data.influence.tags, state().poses, surface, data.options};
    source.options.pose = 100; // blends do not depend on it
    return source;
}

std::shared_ptr<BlendShapes> BendSession::blendShapes() {
    readSurface();
    auto made = std::make_shared<BlendShapes>();
    made->surface = surface;
    made->tags = data.influence.tags;
    made->world = rest.world();
    made->param = deformationOf(data.options);
    try {
        made->poses = motionsOfPoses();
    } catch (const Error &) {
        return nullptr;
    }
    if (solver.isPrepared(made->tags, made->param))
        made->deformer = solver.prepared()->deformer;
    return made;
}

// --- files and layers of the animation, as FCD: Pose Sequence makes them ---

using vcg::fcd::PoseSequence;

BendSession::Animation BendSession::animation(const AnimationExport &how) {
    writeAppliedTags(); // by which the filter knows the handles
    const PoseSequence &all = expectAnimation(state());
    return {posesInNumbers(),
            partOfAnimation(all, how.from, how.to, asTyped(how.rate)).key,
            layer.label().toStdString(),
            {},
            {}};
}

void BendSession::readLook(Animation &animation) const {
    animation.look = lookOf(document, layer, [&](const std::string &text) { animation.remarks.push_back(text); });
}

void BendSession::exportAnimation(const Animation &animation, const AnimationExport &how, ExportedAnimation &made,
                                  const vcg::fcd::Progress &progress) {
    prepare(progress.Slice(0, 0.2));
    PoseSequence sequence = animation.poses;
    sequence.key = animation.key;
    vcg::fcd::Handles handles;
    handles.tag = tags();
    handles.world = rest.world();
    vcg::fcd::SequenceOutput output;
    output.rate = asTyped(how.rate);
    output.name = animation.name;
    output.look = animation.look;
    output.shapes = how.shapes;
    const vcg::fcd::SurfaceView view = surface->View();
    const vcg::fcd::Deformer &deformer = *solver.prepared()->deformer;
    if (how.isFile())
        (how.isPc2() ? output.pc2 : how.isMdd() ? output.mdd : output.gltf) = made.files.add(how.file);
    takeFrames(how.layers, layer, view, deformer, output,
               [&](const QString &what, const auto &position, const auto &linear) {
                   made.frames.push_back({what, position, linear});
               });
    made.report = WriteFrames(view, handles, deformer, sequence, motionsOfPoses(), deformationOf(data.options), output,
                              progress.Slice(0.2, 1));
}

void BendSession::addLayers(ExportedAnimation &made, const Remark &remark) {
    restore(); // the layers get its normals, turned
    NewLayers layers(document, layer, remark);
    std::vector<MeshModel *> added;
    added.reserve(made.frames.size());
    for (ExportedAnimation::Frame &each : made.frames) {
        const ExportedAnimation::Frame frame = std::move(each); // its memory is for the next layers
        added.push_back(&layers.addDeformed(frame.what, frame.position, frame.linear, {}));
    }
    layers.keep(layer, {});
    for (MeshModel *each : added)
        host::setVisible(*each, false);
    host::showChanges(document);
}
