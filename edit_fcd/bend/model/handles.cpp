// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

// What belongs to one handle: its name, whether it is seen and can be moved, its pivot, its axes.

using vcg::fcd::Error;
using vcg::fcd::MotionStep;

const BendHandle &BendSession::handle(int tag) const {
    static const BendHandle usual;
    const auto found = now.handles.find(tag);
    return found == now.handles.end() ? usual : found->second;
}

std::string BendSession::nameOf(int tag) const {
    const std::string &name = handle(tag).name;
    return name.empty() ? "Handle " + std::to_string(tag) : name;
}

void BendSession::setHandle(int tag, BendHandle handle) {
    if (handle == BendHandle())
        now.handles.erase(tag);
    else
        now.handles[tag] = std::move(handle);
}

void BendSession::removeHandle(int tag) {
    now.points.erase(tag);
    if (now.marks && std::count(now.marks->begin(), now.marks->end(), tag) > 0) {
        auto marks = std::make_shared<BendTags>(*now.marks);
        std::replace(marks->begin(), marks->end(), tag, 1);
        const bool isAny = std::any_of(marks->begin(), marks->end(), [](int each) { return each != 1; });
        now.marks = isAny ? std::move(marks) : nullptr;
    }
    changeTags();
    writeMarks();
}

void BendSession::setMotionText(int tag, const std::string &text) {
    auto motion = vcg::fcd::ReadMotionText(std::to_string(tag) + ": " + text, "The motion");
    vcg::fcd::ToMotion(motion[tag], rest.world() * center.at(tag)); // to say what is wrong with it
    setMotion(motion);
}

const std::vector<MotionStep> &BendSession::motionOf(int tag) const {
    static const std::vector<MotionStep> none;
    const auto found = now.motion.find(tag);
    return found == now.motion.end() ? none : found->second;
}

std::string BendSession::motionTextOf(int tag) const {
    if (motionOf(tag).empty())
        return {};
    const std::string text = vcg::fcd::WriteMotionText({{tag, motionOf(tag)}});
    return text.substr(text.find(':') + 2);
}

Eigen::Affine3d BendSession::motionAt(int tag) const {
    if (motionOf(tag).empty())
        return Eigen::Affine3d::Identity();
    const Eigen::Vector3d place = rest.world() * center.at(tag);
    return Eigen::Affine3d(vcg::fcd::ToMotion(motionOf(tag), place).At(options.pose, place));
}

Eigen::Vector3d BendSession::centerOf(int tag) const { return motionAt(tag) * (rest.world() * center.at(tag)); }

/// Where a handle is at rest, layer units: the vertex of a point, else its middle.
Eigen::Vector3d BendSession::placeOf(int tag) const {
    const auto point = now.points.find(tag);
    return point == now.points.end() ? center.at(tag) : rest.at(point->second.slot);
}

Eigen::Vector3d BendSession::dotOf(int tag) const { return motionAt(tag) * (rest.world() * placeOf(tag)); }

Eigen::Vector3d BendSession::pivotOf(int tag) const {
    const auto &pivot = handle(tag).pivot;
    const auto point = now.points.find(tag);
    return pivot                                                ? motionAt(tag) * *pivot
           : point != now.points.end() && !point->second.isGrip ? dotOf(tag)
                                                                : centerOf(tag);
}

void BendSession::setPivot(int tag, const std::optional<Eigen::Vector3d> &place) {
    BendHandle changed = handle(tag);
    changed.pivot.reset();
    if (place)
        changed.pivot = motionAt(tag).inverse() * *place;
    setHandle(tag, std::move(changed));
}

void BendSession::makeGrip(int tag) {
    const auto point = now.points.find(tag);
    if (point == now.points.end() || point->second.isGrip)
        return;
    const int other = mirrored(tag);
    point->second.isGrip = true;
    if (BendHandle changed = handle(tag); !changed.pivot) {
        changed.pivot = rest.world() * rest.at(point->second.slot);
        setHandle(tag, std::move(changed));
    }
    changeTagsOf(tag);
    if (other)
        makeGrip(other);
}

/// changeTags() for a point that is new, or holds more: it stays where the layer, and the poses that have names, show
/// it.
void BendSession::changeTagsOf(int tag) {
    const auto tagsBefore = effective;
    const auto centerBefore = center;
    changeTags();
    keepPlace(tag);
    keepPlaceInPoses(tag, tagsBefore, centerBefore);
}

/// A handle has the motion that leaves it where the layer shows it.
void BendSession::keepPlace(int tag) {
    if (!rest.isPosed() || now.pose != 100)
        return;
    std::vector<MotionStep> steps = stepsSeen(tag);
    if (steps.empty())
        return;
    if (now.points.count(tag) > 0) // whose middle is another one when it becomes a grip, or another handle lies beyond
        setPlaces(steps, rest.world() * center.at(tag));
    motionByHand()[tag] = std::move(steps);
}

/// What a rigid motion can tell of where the layer shows a handle; none where that is at rest.
std::vector<MotionStep> BendSession::stepsSeen(int tag) const {
    std::vector<std::size_t> held;
    for (std::size_t i = 0; i < effective->size(); ++i)
        if ((*effective)[i] == tag)
            held.push_back(i);
    const Eigen::Vector3d middle = rest.world() * center.at(tag);
    Eigen::Matrix3Xd before(3, Eigen::Index(held.size())), after = before;
    for (std::size_t i = 0; i < held.size(); ++i) {
        before.col(Eigen::Index(i)) = rest.world() * rest.at(held[i]) - middle;
        after.col(Eigen::Index(i)) = positionOf(held[i]) - middle;
    }
    if ((after - before).colwise().norm().maxCoeff() < 1e-6 * rest.diagonal())
        return {};
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.translation() = after.rowwise().mean();
    const Eigen::Vector3d extent = // squared, ascending
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(before * before.transpose()).eigenvalues();
    if (extent[1] > 1e-12 * extent[2]) // else it has no direction
        motion = Eigen::Affine3d(Eigen::umeyama(before, after, false));
    std::vector<MotionStep> steps = stepsOf(
        vcg::fcd::Motion((Eigen::Translation3d(middle) * motion * Eigen::Translation3d(-middle)).matrix()), middle);
    for (MotionStep &step : steps) {
        step.vector = inFewDigits(step.vector);
        step.degrees = inFewDigits(step.degrees);
    }
    return steps;
}

Eigen::Vector3d BendSession::normalOf(int tag) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < effective->size(); ++i)
        if ((*effective)[i] == tag)
            sum += toVector(rest.normals()[i]);
    const Eigen::Vector3d turned =
        (motionAt(tag) * rest.world()).linear().inverse().transpose() * sum; // as planes are turned
    return turned.norm() > 0 ? Eigen::Vector3d(turned.normalized()) : Eigen::Vector3d::UnitZ();
}

Eigen::Matrix3d BendSession::axesOf(int tag) const {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    if (options.axes == BendAxes::Layer) {
        for (int k = 0; k < 3; ++k)
            axes.col(k) = rest.world().linear().col(k).normalized();
    } else if (options.axes == BendAxes::Surface) {
        axes.col(2) = normalOf(tag);
        int least = 0;
        axes.col(2).cwiseAbs().minCoeff(&least);
        axes.col(0) = axes.col(2).cross(Eigen::Vector3d::Unit(least)).normalized();
        axes.col(1) = axes.col(2).cross(axes.col(0));
    }
    return axes;
}
