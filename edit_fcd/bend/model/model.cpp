// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/model.h"

#include "edit_fcd/bend/model/handles.h"

#include <algorithm>

using vcg::fcd::MotionStep;

// Largest distance of a twin from the mirror image, over the diagonal: the sides of a body differ by that much.
const double farthestTwin = 0.05;

/// A handle's position at rest, world: the vertex of a point, else the middle.
static Eigen::Vector3d handlePlace(const BendModel &model, int tag) {
    const auto point = model.state.points.find(tag);
    return point == model.state.points.end() ? model.rest(tag)
                                             : model.ground.world * model.ground.at(point->second.slot);
}

static Eigen::Vector3d normalOf(const BendModel &model, int tag) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const BendTags &tags = *model.influence.tags;
    for (std::size_t i = 0; i < tags.size(); ++i)
        if (tags[i] == tag)
            sum += model.ground.normalAt(i);
    const Eigen::Vector3d turned =
        (motionAt(model, tag) * model.ground.world).linear().inverse().transpose() * sum; // as planes are turned
    return turned.norm() > 0 ? Eigen::Vector3d(turned.normalized()) : Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d BendModel::rest(int tag) const { return ground.world * influence.center.at(tag); }

Eigen::Affine3d motionAt(const BendModel &model, int tag) { return motionBy(model, tag, motionOf(model.state, tag)); }

Eigen::Affine3d motionBy(const BendModel &model, int tag, const std::vector<MotionStep> &steps) {
    if (steps.empty())
        return Eigen::Affine3d::Identity();
    const Eigen::Vector3d place = model.rest(tag);
    return Eigen::Affine3d(vcg::fcd::ToMotion(steps, place).At(model.options.pose, place));
}

Eigen::Vector3d centerOf(const BendModel &model, int tag) { return motionAt(model, tag) * model.rest(tag); }

Eigen::Vector3d dotOf(const BendModel &model, int tag) { return motionAt(model, tag) * handlePlace(model, tag); }

std::optional<Eigen::Vector3d> jointOf(const BendModel &model, int tag) {
    const auto &extent = valueOr(model.influence.extents, tag);
    if (!isGrip(model.state, tag) || !extent || !extent->joint)
        return {};
    return model.ground.world * *extent->joint;
}

Eigen::Vector3d pivotOf(const BendModel &model, int tag) {
    if (const auto &pivot = handleOf(model.state, tag).pivot)
        return motionAt(model, tag) * *pivot;
    const auto joint = jointOf(model, tag);
    return joint ? motionAt(model, tag) * *joint : dotOf(model, tag);
}

Eigen::Matrix3d axesOf(const BendModel &model, int tag) {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    if (model.options.axes == BendAxes::Layer) {
        for (int k = 0; k < 3; ++k)
            axes.col(k) = model.ground.world.linear().col(k).normalized();
    } else if (model.options.axes == BendAxes::Surface) {
        axes.col(2) = normalOf(model, tag);
        int least = 0;
        axes.col(2).cwiseAbs().minCoeff(&least);
        axes.col(0) = axes.col(2).cross(Eigen::Vector3d::Unit(least)).normalized();
        axes.col(1) = axes.col(2).cross(axes.col(0));
    }
    return axes;
}

Eigen::Affine3d mirrorOf(const BendModel &model) {
    Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
    if (const int axis = model.options.mirror; axis >= 0) {
        mirror.linear()(axis, axis) = -1;
        mirror.translation()[axis] = 2 * model.ground.middle[axis];
    }
    return model.ground.world * mirror * model.ground.world.inverse();
}

int mirrored(const BendModel &model, int tag) {
    if (model.options.mirror < 0 || !model.influence.isHandle(tag))
        return 0;
    const Eigen::Vector3d own = handlePlace(model, tag), there = mirrorOf(model) * own;
    int found = tag; // on the mirror plane, it is its own twin
    double least = std::min(farthestTwin * model.ground.diagonal, (own - there).norm());
    for (const int other : model.influence.handles()) {
        const double distance = (handlePlace(model, other) - there).norm();
        if (other != tag && distance < least) {
            least = distance;
            found = other;
        }
    }
    return found == tag ? 0 : found;
}

bool lacksTwin(const BendModel &model, int tag) {
    if (model.options.mirror < 0 || !model.influence.isHandle(tag) || mirrored(model, tag))
        return false;
    const Eigen::Vector3d own = handlePlace(model, tag);
    return (mirrorOf(model) * own - own).norm() > farthestTwin * model.ground.diagonal;
}

bool isTwin(const BendModel &model, std::size_t slot, std::size_t other) {
    const BendGround &ground = model.ground;
    const Eigen::Vector3d there = mirrorOf(model) * (ground.world * ground.at(slot));
    return (ground.at(other) - ground.at(slot)).norm() > 1e-3 * ground.diagonal &&
           (ground.world * ground.at(other) - there).norm() < farthestTwin * ground.diagonal;
}

std::vector<int> carriedBy(const BendModel &model, int tag) {
    std::vector<int> carried;
    for (const int other : valueOr(model.influence.beyond, tag))
        if (!handleOf(model.state, other).isLocked && other != mirrored(model, tag))
            carried.push_back(other);
    return carried;
}

bool isKeptApart(const BendModel &model, int tag) { return model.influence.apart.count(rankOf(model.state, tag)) > 0; }

bool turnsLimb(const BendModel &model, int tag) { return jointOf(model, tag).has_value(); }

// Least length of each of two bones, over the other. A finger or a foot is shorter than that, and turns alone.
const double shortestBone = 0.4;

int jointBefore(const BendModel &model, int tag, const Eigen::Vector3d &held) {
    int found = 0;
    std::size_t least = 0;
    if (!turnsLimb(model, tag))
        return found;
    for (const auto &[other, extent] : model.influence.extents) {
        const std::vector<int> with = carriedBy(model, other);
        if (other == tag || !turnsLimb(model, other) || handleOf(model.state, other).isLocked ||
            std::find(with.begin(), with.end(), tag) == with.end())
            continue;
        if (!found || extent->beyond.size() < least) {
            found = other;
            least = extent->beyond.size();
        }
    }
    if (!found)
        return found;
    const Eigen::Vector3d middle = pivotOf(model, tag);
    const double first = (middle - pivotOf(model, found)).norm(), second = (held - middle).norm();
    return second > shortestBone * first && first > shortestBone * second ? found : 0;
}

bool isAlong(const BendModel &model, std::size_t slot) {
    const int tag = (*model.influence.tags)[slot];
    if (!isGrip(model.state, tag))
        return false;
    const std::vector<std::size_t> &beyond = model.influence.extents.at(tag)->beyond;
    return std::binary_search(beyond.begin(), beyond.end(), slot);
}

bool canBecomePoint(const BendModel &model, std::size_t slot) {
    return isFree(model.state, slot) && ((*model.influence.tags)[slot] < 2 || isAlong(model, slot));
}

double radiusOf(const BendModel &model, int tag) { return radiusOf(model.state, tag, model.ground.diagonal); }

std::map<vcg::fcd::Index, vcg::fcd::Motion> motionsOf(const BendModel &model) {
    std::map<vcg::fcd::Index, vcg::fcd::Motion> motions;
    for (const auto &[tag, steps] : model.state.motion)
        if (model.influence.isHandle(tag))
            motions[tag] = vcg::fcd::ToMotion(steps, model.rest(tag));
    return motions;
}

bool isMoved(const BendModel &model) {
    const auto motions = motionsOf(model);
    return model.options.pose != 0 && std::any_of(motions.begin(), motions.end(), [](const auto &each) {
               return !each.second.matrix.isIdentity(0) || !each.second.turn.isZero(0);
           });
}

void setMotion(BendModel &model, const BendMotions &steps) {
    auto &motion = motionByHand(model.state);
    for (const auto &[tag, here] : steps) {
        if (const int other = mirrored(model, tag);
            other && steps.count(other) == 0 && !handleOf(model.state, other).isLocked) {
            std::vector<MotionStep> there;
            there.reserve(here.size());
            for (const MotionStep &step : here)
                there.push_back(mirroredStep(step, mirrorOf(model)));
            motion[other] = there;
        }
        motion[tag] = here;
    }
}

void setMotionText(BendModel &model, int tag, const std::string &text) {
    auto motion = vcg::fcd::ReadMotionText(std::to_string(tag) + ": " + text, "The motion");
    vcg::fcd::ToMotion(motion[tag], model.rest(tag)); // throws if it is wrong
    setMotion(model, motion);
}

void setMotions(BendModel &model, const std::string &text) {
    auto motion = vcg::fcd::ReadMotionText(text, "The motions");
    for (const auto &[tag, steps] : motion) {
        if (!model.influence.isHandle(tag))
            throw vcg::fcd::Error("The motions move handle " + std::to_string(tag) + ", but no vertex has that tag.");
        vcg::fcd::ToMotion(steps, model.rest(tag)); // throws if it is wrong
    }
    motionByHand(model.state) = std::move(motion);
}

void setPose(BendModel &model, double percent) {
    if (percent != model.state.pose)
        model.state.weights.clear(); // part of a blend is no blend
    model.options.pose = model.state.pose = percent;
}

void setPivot(BendModel &model, int tag, const std::optional<Eigen::Vector3d> &place) {
    std::optional<Eigen::Vector3d> atRest;
    if (place)
        atRest = motionAt(model, tag).inverse() * *place;
    const auto set = [&](int each, const std::optional<Eigen::Vector3d> &pivot) {
        BendHandle changed = handleOf(model.state, each);
        changed.pivot = pivot;
        setHandle(model.state, each, std::move(changed));
    };
    const int other = mirrored(model, tag);
    set(tag, atRest);
    if (other)
        set(other, atRest ? std::optional<Eigen::Vector3d>(mirrorOf(model) * *atRest) : atRest);
}

void forgetGone(BendModel &model) {
    BendState &now = model.state;
    const auto isGone = [&](const auto &each) { return !model.influence.isHandle(each.first); };
    const auto forget = [&](auto &of) {
        for (auto each = of.begin(); each != of.end();)
            each = isGone(*each) ? of.erase(each) : std::next(each);
    };
    if (std::any_of(now.motion.begin(), now.motion.end(), isGone))
        forget(motionByHand(now));
    forget(now.handles);
    forget(now.rank);
}

bool keepPlaces(const BendModel &model, const std::map<vcg::fcd::Index, Eigen::Vector3d> &before, BendMotions &motion) {
    bool isPlaced = false;
    for (auto &[tag, steps] : motion)
        if (const auto was = before.find(tag);
            was != before.end() && model.influence.isHandle(tag) && was->second != model.influence.center.at(tag))
            isPlaced = setPlaces(steps, model.ground.world * was->second) || isPlaced;
    return isPlaced;
}
