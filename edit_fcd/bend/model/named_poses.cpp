// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/carrier.h> // before Qt

#include "edit_fcd/bend/model/session.h"

#include <layer_fcd/layer_sequence.h>
#include <layer_fcd/marks.h>
#include <layer_fcd/motion_sources.h>
#include <layer_fcd/save_files.h>

#include <algorithm>

// Poses that have names.

using vcg::fcd::Easing;
using vcg::fcd::Error;
using vcg::fcd::KeyFrame;
using vcg::fcd::Motion;
using vcg::fcd::MotionStep;
using vcg::fcd::PoseSequence;

std::map<int, std::vector<MotionStep>> &BendSession::motionByHand() {
    now.weights.clear();
    return now.motion;
}

std::vector<vcg::fcd::NamedPose> BendSession::namedPoses() const {
    return now.poses ? now.poses->pose : std::vector<vcg::fcd::NamedPose>();
}

std::vector<double> BendSession::weightsOfPoses() const {
    return now.weights.empty() && now.poses ? std::vector<double>(now.poses->pose.size(), 0) : now.weights;
}

/// A text of motions that names no layer, which beside the window cannot be asked; the same where it names one that is
/// not there, which is told by whoever reads it.
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
    PoseSequence poses = *now.poses;
    for (vcg::fcd::NamedPose &each : poses.pose)
        each.motions = inNumbers(each.motions);
    return poses;
}

std::vector<std::map<int, Motion>> BendSession::motionsOfPoses() const {
    return motionsOf(posesInNumbers(), document, layer, center, rest.world());
}

/// Where a pose takes the vertices.
std::vector<Point3m> BendSession::positionsIn(const vcg::fcd::Deformer::Pose &pose) const {
    std::vector<Point3m> position = rest.positions();
    const auto take = [&](std::size_t slot, const Eigen::Vector3d &p, const Eigen::Matrix3f &) {
        position[slot] = toPoint(p);
    };
    vcg::fcd::Carrier(*solver.prepared()->deformer, pose)
        .Apply([&](std::size_t slot) { return rest.at(slot); }, [&] { return take; }, false, {}, [](std::size_t) {});
    return position;
}

/// The poses that have names leave a handle, which is new, or holds other vertices now, where they did. \param
/// tagsBefore tags before that \param centerBefore centers then
void BendSession::keepPlaceInPoses(int tag, std::shared_ptr<const BendTags> tagsBefore,
                                   const std::map<vcg::fcd::Index, Eigen::Vector3d> &centerBefore) {
    const bool isNew = centerBefore.count(tag) == 0;
    if (!now.poses || (isNew && (*tagsBefore)[now.points.at(tag).slot] == 0)) // no pose moves it then
        return;
    PoseSequence changed = *now.poses;
    const auto motions = motionsOf(posesInNumbers(), document, layer, centerBefore, rest.world());
    const std::vector<Point3m> shown = besides->position;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        auto steps = vcg::fcd::ReadMotionText(inNumbers(changed.pose[i].motions));
        if (!isNew && !steps.count(tag))
            continue;
        effective.swap(tagsBefore);
        prepare();
        besides->position = positionsIn(solver.solve({motions[i].begin(), motions[i].end()}, options, true));
        effective.swap(tagsBefore);
        steps[tag] = stepsSeen(tag);
        changed.pose[i].motions = vcg::fcd::WriteMotionText(steps);
    }
    besides->position = shown;
    setPoses(std::move(changed));
}

bool BendSession::takePoses() {
    std::optional<PoseSequence> kept = posesOf(layer);
    if (!kept && !now.poses)
        return true;
    if (kept && now.poses && PoseSequenceText(*kept) == PoseSequenceText(*now.poses))
        return true;
    change();
    now.weights.clear();
    now.poses = kept ? std::make_shared<const PoseSequence>(std::move(*kept)) : nullptr;
    return !now.poses || !now.poses->surface || now.poses->surface->IsSame(rest.mark());
}

/// The layer keeps \p poses.
void BendSession::setPoses(PoseSequence poses) {
    poses.surface = rest.mark();
    if (!poses.pose.empty())
        poses.Validate();
    now.poses = poses.pose.empty() ? nullptr : std::make_shared<const PoseSequence>(std::move(poses));
    writePoses();
}

void BendSession::writePoses() {
    if (besides) {
        besides->arePosesNew = true;
        return;
    }
    keepPoses(document, layer, now.poses ? *now.poses : PoseSequence());
    if (now.poses)
        writeAppliedTags(); // by which the filter knows the handles
}

std::string BendSession::keepPose() {
    if (!moves())
        throw Error("Nothing was moved, so there is no pose to keep.");
    std::map<int, std::vector<MotionStep>> motion = now.motion;
    if (options.pose != 100)
        for (auto &[tag, steps] : motion) {
            const Eigen::Vector3d place = rest.world() * center.at(tag);
            steps = stepsOf(vcg::fcd::Blend({{vcg::fcd::ToMotion(steps, place), options.pose}}, place), place);
        }
    PoseSequence poses = now.poses ? *now.poses : PoseSequence();
    const auto isName = [&](const std::string &name) {
        return std::any_of(poses.pose.begin(), poses.pose.end(), [&](const auto &each) { return each.name == name; });
    };
    std::size_t number = poses.pose.size() + 1;
    while (isName("Pose " + std::to_string(number)))
        ++number;
    // It comes a second after what there is, as in a table without key frames.
    poses.pose.push_back({"Pose " + std::to_string(number), vcg::fcd::WriteMotionText(motion)});
    for (KeyFrame &each : poses.key)
        each.weight.push_back(0);
    std::vector<double> alone(poses.pose.size(), 0);
    if (poses.key.empty())
        poses.key.push_back({0, Easing::Smooth, alone});
    alone.back() = 100;
    poses.key.push_back({poses.key.back().time + 1, Easing::Smooth, alone});
    setPoses(std::move(poses));
    blend(alone);
    return std::string("ms.apply_filter('generate_fcd_pose_sequence', handles=2, tag_attribute='") +
           appliedTags(document, layer) + "'" + shapeCall() + ")";
}

std::optional<std::size_t> BendSession::poseOfName(const std::string &name, std::size_t number) const {
    for (std::size_t i = 0; now.poses && i < now.poses->pose.size(); ++i)
        if (i != number && now.poses->pose[i].name == name)
            return i;
    return {};
}

void BendSession::replacePose(std::size_t other, std::size_t number) {
    PoseSequence poses = *now.poses;
    poses.pose[other].motions = poses.pose[number].motions;
    const bool wasAlone = weightsOfPoses()[number] == 100;
    now.poses = std::make_shared<const PoseSequence>(std::move(poses));
    removePose(number);
    if (!wasAlone)
        return;
    std::vector<double> alone(now.poses->pose.size(), 0);
    alone[other < number ? other : other - 1] = 100;
    blend(alone); // what is shown is what it was
}

void BendSession::renamePose(std::size_t number, const std::string &name) {
    PoseSequence poses = *now.poses;
    poses.pose[number].name = name;
    setPoses(std::move(poses));
}

/// Key frames that show nothing else go with it, and those after them come earlier.
void BendSession::removePose(std::size_t number) {
    PoseSequence poses = *now.poses;
    poses.pose.erase(poses.pose.begin() + std::ptrdiff_t(number));
    double before = 0, gone = 0;
    for (auto each = poses.key.begin(); each != poses.key.end();) {
        const double lasted = each->time - before;
        before = each->time;
        const bool wasShown = each->weight[number] != 0;
        each->weight.erase(each->weight.begin() + std::ptrdiff_t(number));
        if (wasShown && std::all_of(each->weight.begin(), each->weight.end(), [](double w) { return w == 0; })) {
            gone += lasted;
            each = poses.key.erase(each);
        } else {
            each->time -= gone;
            ++each;
        }
    }
    now.weights.clear(); // what they show is the handles' own from now on
    setPoses(std::move(poses));
}

void BendSession::blend(const std::vector<double> &weights) {
    const std::vector<std::map<int, Motion>> poses = motionsOfPoses();
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (weights[i] != 0)
            shown.push_back(i);
    std::map<int, std::vector<MotionStep>> blended;
    if (shown.size() == 1 && weights[shown.front()] == 100) {
        blended = readMotionSteps(document, layer, QString::fromStdString(now.poses->pose[shown.front()].motions));
    } else {
        for (const auto &[tag, middle] : center) {
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
    setPose(100);
    motionByHand() = std::move(blended);
    if (!shown.empty())
        now.weights = weights;
}

void BendSession::loadPoses(const QString &file) {
    PoseSequence poses = readPoses(layer, file, rest.mark());
    motionsOf(poses, document, layer, center, rest.world()); // to say what is wrong with them
    now.weights.clear();
    setPoses(std::move(poses));
}

// --- the animation ---

std::vector<KeyFrame> BendSession::keyFrames() const { return now.poses ? now.poses->key : std::vector<KeyFrame>(); }

void BendSession::setKeyFrames(std::vector<KeyFrame> frames) {
    PoseSequence poses = *now.poses;
    poses.key = std::move(frames);
    std::stable_sort(poses.key.begin(), poses.key.end(),
                     [](const KeyFrame &a, const KeyFrame &b) { return a.time < b.time; });
    setPoses(std::move(poses));
}

void BendSession::addKeyFrame() {
    if (now.weights.empty() && moves())
        throw Error("What is shown is no pose that has a name: 'Keep pose' makes it one.");
    expectPoses();
    std::vector<KeyFrame> frames = keyFrames();
    frames.push_back({frames.empty() ? 0 : frames.back().time + 1, Easing::Smooth, weightsOfPoses()});
    setKeyFrames(std::move(frames));
}

void BendSession::setKeyFrame(std::size_t number, KeyFrame frame) {
    std::vector<KeyFrame> frames = keyFrames();
    frames[number] = std::move(frame);
    setKeyFrames(std::move(frames));
}

void BendSession::removeKeyFrame(std::size_t number) {
    std::vector<KeyFrame> frames = keyFrames();
    frames.erase(frames.begin() + std::ptrdiff_t(number));
    setKeyFrames(std::move(frames));
}

double BendSession::beginAnimation(const vcg::fcd::Progress &progress) {
    if (!now.poses || now.poses->key.size() < 2)
        throw Error("An animation needs two key frames: 'Keep pose' and 'Key frame' make them.");
    std::vector<std::map<int, Motion>> motions = motionsOfPoses();
    prepare(progress);
    solver.beginBlends(std::move(motions), rest.world(), options);
    return now.poses->key.back().time - now.poses->key.front().time;
}

void BendSession::showAnimation(double time) {
    isLeft = false;
    writePose(solver.solveNextBlend(now.poses->WeightsAt(now.poses->key.front().time + time)));
}

void BendSession::expectPoses() const {
    if (!now.poses)
        throw Error("There is no pose yet: 'Keep pose' makes one of what is shown.");
}

void BendSession::savePoses(const QString &file) const { saveFiles({{file, PoseSequenceText(*now.poses)}}); }
