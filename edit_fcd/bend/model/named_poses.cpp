// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/carrier.h> // these before Qt
#include <vcg_ext/sequence/sequence_solver.h>

#include "edit_fcd/bend/model/named_poses.h"

#include <algorithm>
#include <utility>

using vcg::fcd::Easing;
using vcg::fcd::Error;
using vcg::fcd::KeyFrame;
using vcg::fcd::PoseSequence;

PoseSequence withPose(PoseSequence poses, const std::string &motions) {
    const auto isName = [&](const std::string &name) {
        return std::any_of(poses.pose.begin(), poses.pose.end(), [&](const auto &each) { return each.name == name; });
    };
    std::size_t number = poses.pose.size() + 1;
    while (isName("Pose " + std::to_string(number)))
        ++number;
    poses.pose.push_back({"Pose " + std::to_string(number), motions});
    for (KeyFrame &each : poses.key)
        each.weight.push_back(0);
    const std::size_t count = poses.pose.size();
    if (poses.key.empty())
        poses.key.push_back({0, Easing::Smooth, std::vector<double>(count, 0)});
    poses.key.push_back({poses.key.back().time + 1, Easing::Smooth, aloneOf(count, count - 1)});
    return poses;
}

PoseSequence withoutPose(PoseSequence poses, std::size_t number) {
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
    return poses;
}

PoseSequence renamed(PoseSequence poses, std::size_t number, const std::string &name) {
    poses.pose[number].name = name;
    return poses;
}

std::optional<std::size_t> poseOfName(const BendState &state, const std::string &name, std::size_t number) {
    for (std::size_t i = 0; state.poses && i < state.poses->pose.size(); ++i)
        if (i != number && state.poses->pose[i].name == name)
            return i;
    return {};
}

std::vector<double> aloneOf(std::size_t poses, std::size_t number) {
    std::vector<double> alone(poses, 0);
    alone[number] = 100;
    return alone;
}

std::vector<double> weightsOfPoses(const BendState &state) {
    return state.weights.empty() && state.poses ? std::vector<double>(state.poses->pose.size(), 0) : state.weights;
}

const PoseSequence &expectPoses(const BendState &state) {
    if (!state.poses)
        throw Error("There is no pose yet: 'Keep pose' makes one of the shape that you see.");
    return *state.poses;
}

const PoseSequence &expectAnimation(const BendState &state) {
    if (!state.poses || state.poses->key.size() < 2)
        throw Error("An animation needs two key frames: 'Keep pose' and 'Key frame' make them.");
    return *state.poses;
}

std::vector<KeyFrame> keyFrames(const BendState &state) {
    return state.poses ? state.poses->key : std::vector<KeyFrame>();
}

PoseSequence withKeyFrames(PoseSequence poses, std::vector<KeyFrame> frames) {
    poses.key = std::move(frames);
    std::stable_sort(poses.key.begin(), poses.key.end(),
                     [](const KeyFrame &a, const KeyFrame &b) { return a.time < b.time; });
    return poses;
}

PoseSequence withKeyFrame(const BendState &state, bool moves) {
    if (state.weights.empty() && moves)
        throw Error("The shape that you see is no named pose: 'Keep pose' makes it one.");
    PoseSequence poses = expectPoses(state);
    poses.key.push_back({poses.key.empty() ? 0 : poses.key.back().time + 1, Easing::Smooth, weightsOfPoses(state)});
    return poses;
}

PoseSequence partOfAnimation(PoseSequence poses, double from, double to, double rate) {
    if (to < from)
        throw Error("The animation would end before it begins. Give an earlier 'From', or a later 'To'.");
    if (from <= poses.key.front().time && to >= poses.key.back().time)
        return poses;
    PoseSequence cut = poses;
    cut.key = {{from, Easing::Linear, {}}, {to, Easing::Linear, {}}};
    const std::vector<double> times = FrameTimes(cut, rate);
    cut.key.clear();
    for (const double time : times)
        cut.key.push_back({time, Easing::Linear, poses.WeightsAt(time)});
    return cut;
}

GhostFrames ghostFrames(const std::vector<vcg::fcd::KeyFrame> &keys, double time, bool isShown) {
    GhostFrames ghosts;
    if (keys.size() < 2)
        return ghosts;
    for (const vcg::fcd::KeyFrame &each : keys) {
        if (each.time < time || (each.time == time && !isShown))
            ghosts.before = each.weight;
        if (each.time > time) {
            ghosts.after = each.weight;
            break;
        }
    }
    return ghosts;
}

std::vector<float> BlendShapes::of(const std::vector<double> &weight, const std::vector<std::uint32_t> &slot,
                                   const vcg::fcd::Progress &progress) {
    if (!deformer) {
        vcg::fcd::Handles handles;
        handles.tag = *tags;
        handles.world = world;
        vcg::fcd::CountHandles(handles, surface->Slots(), surface->View().deleted);
        deformer = vcg::fcd::PrepareDeformer(surface->View(), handles, param, progress);
    }
    vcg::fcd::SequenceSolver solver(*deformer, world, poses, param);
    Eigen::Matrix3Xd position = surface->View().Copy();
    vcg::fcd::Carrier(*deformer, solver.Go(weight, progress)).Apply(position, nullptr, progress);
    std::vector<float> shape;
    shape.reserve(3 * slot.size());
    for (const std::uint32_t i : slot)
        for (int d = 0; d < 3; ++d)
            shape.push_back(float(position(d, i)));
    return shape;
}
