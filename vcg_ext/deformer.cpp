// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/deformer.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>

namespace vcg::fcd {

namespace {

/// The box of the nodes of a region, world units.
Eigen::AlignedBox3d BoxOf(const MovingRegion &region) {
    const Frame &frame = region.surface.frame;
    const Eigen::Matrix3Xf &at = region.graph.graph.position;
    Eigen::AlignedBox3d box;
    if (at.cols() > 0)
        for (const Eigen::Vector3f &corner : {at.rowwise().minCoeff().eval(), at.rowwise().maxCoeff().eval()})
            box.extend(Eigen::Vector3d(corner.cast<double>() * frame.scale + frame.origin));
    return box;
}

} // namespace

HeldMotions Deformer::MotionsOf(const Handles &handles, double percent) const {
    assert(handles.point.size() == point.size());
    HeldMotions m;
    m.motion[0].setIdentity();
    m.turn[0].setZero();
    for (const auto &[tag, middle] : center) {
        const auto given = handles.motion.find(tag);
        const Motion motion = given == handles.motion.end() ? Motion() : given->second;
        m.motion[tag] = handles.ToMesh(motion.At(percent, handles.world * middle));
        detail::ExpectNear(frame, m.motion[tag], "Handle " + std::to_string(tag));
        m.rotates[tag] = motion.Turns();
        m.turn[tag] = motion.Rotation() * (percent / 100);
    }
    for (std::size_t i = 0; i < point.size(); ++i) {
        const std::string name = "Point handle " + std::to_string(i + 1);
        if (!handles.point[i].target.allFinite())
            throw BadInput(name + " has a target that is not finite.");
        Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
        motion.topRightCorner<3, 1>() = (handles.point[i].target - pointRest[i]) * (percent / 100);
        detail::ExpectNear(frame, motion, name);
        m.pointMotion[point[i]] = motion;
    }
    return m;
}

void Deformer::ForRegions(const Progress &progress, const char *stage,
                          const std::function<void(std::size_t, const Progress &)> &body) const {
    if (regions.size() == 1)
        body(0, progress);
    else
        ParallelTasks(progress, stage, regions.size(), body);
}

SurfacePose Deformer::SumOf(HeldMotions given, std::vector<RegionPose> poses) const {
    Pose pose;
    pose.given = std::move(given);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const RegionPose &each = poses[i];
        const double scale = regions[i]->surface.frame.scale;
        pose.iterations = std::max(pose.iterations, each.iterations);
        pose.converged = pose.converged && each.graph.converged;
        pose.energy += each.graph.energy * scale * scale;
        pose.path.steps = std::max(pose.path.steps, each.path.steps);
        pose.path.jumps = pose.path.jumps || each.path.jumps;
        pose.path.unstable = pose.path.unstable || each.path.unstable;
    }
    pose.region = std::move(poses);
    return pose;
}

SurfacePose Deformer::SolveRegions(HeldMotions motions, const Pose *last, const RegionSolver &solve,
                                   const Progress &progress) const {
    const LoopHelpers helpers;
    std::vector<RegionPose> poses(regions.size());
    ForRegions(progress, "Deforming the graph", [&](std::size_t i, const Progress &part) {
        const HeldMotions own = Region(i).OwnOf(motions);
        const RegionPose *before = last ? &last->region[i] : nullptr;
        const bool isSame = before && before->graph.converged && before->given == own; // the pose would not change
        poses[i] = isSame ? *before : solve(Region(i), own, before, part);
    });
    return SumOf(std::move(motions), std::move(poses));
}

SurfacePose Deformer::Solve(HeldMotions motions, const SolverParam &solver, const Pose *last,
                            const Progress &progress) const {
    const auto solve = [&](const RegionDeformer &region, HeldMotions own, const RegionPose *before,
                           const Progress &part) {
        const auto kept = before ? nullptr : region.Kept(own);
        return kept ? *kept : region.Solve(std::move(own), solver, before, part);
    };
    return SolveRegions(std::move(motions), last, solve, progress);
}

SurfacePose Deformer::Solve(const Handles &handles, const DeformationParam &param, const Progress &progress) const {
    const auto path = [&](int step, int steps) {
        return MotionsOf(handles, step == steps ? param.pose : param.pose * step / steps);
    };
    return SolveAlong(path, param, nullptr, progress);
}

SurfacePose Deformer::SolveAlong(const Path &path, const DeformationParam &param, const Pose *begin,
                                 const Progress &progress) const {
    HeldMotions end = path(1, 1);
    std::mutex lock;                                      // of motionsAt
    std::map<std::pair<int, int>, HeldMotions> motionsAt; // by step and steps
    const auto motionsOf = [&](int step, int steps) -> const HeldMotions & {
        if (step == steps)
            return end;
        const std::lock_guard<std::mutex> guard(lock);
        const auto found = motionsAt.find({step, steps});
        return found != motionsAt.end() ? found->second : motionsAt[{step, steps}] = path(step, steps);
    };
    const auto solve = [&](const RegionDeformer &region, const HeldMotions &, const RegionPose *before,
                           const Progress &part) {
        return region.SolveAlong([&](int step, int steps) { return region.OwnOf(motionsOf(step, steps)); }, param,
                                 param.steps, before, part);
    };
    return SolveRegions(end, begin, solve, progress);
}

int Deformer::StepsTo(const HeldMotions &motions, const HeldMotions *begin) const {
    int steps = 1;
    for (std::size_t i = 0; i < regions.size(); ++i)
        steps = std::max(steps, Region(i).StepsTo(motions, begin));
    return steps;
}

double Deformer::DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress) const {
    std::vector<double> error(regions.size()); // frame units
    ForRegions(progress, "Estimating the error", [&](std::size_t i, const Progress &part) {
        error[i] = Region(i).DiscretisationError(pose.region[i], solver, part);
    });
    double squares = 0, areas = 0; // in a unit near the size
    Eigen::AlignedBox3d box;
    const double unit = detail::UnitOf(frame.scale);
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const SurfaceGraph &surface = regions[i]->surface;
        const double scale = surface.frame.scale / unit, square = scale * scale, area = surface.area * square;
        squares += area * error[i] * error[i] * square;
        areas += area;
        box.extend(BoxOf(*regions[i]));
    }
    return squares == 0 ? 0 : std::sqrt(squares / areas) / (box.diagonal() / unit).norm();
}

bool HasNodes(const Deformer &deformer, const Eigen::Matrix3Xd &nodes) {
    if (nodes.cols() != deformer.Nodes())
        return false;
    Eigen::Index first = 0;
    for (const auto &region : deformer.regions) {
        const SurfaceGraph &surface = region->surface;
        for (Index j = 0; j < region->graph.Size(); ++j) {
            const Eigen::Vector3d own = surface.graph.position.col(region->patches.center[j]).cast<double>();
            const Eigen::Vector3d p = nodes.col(first + j);
            if (!((surface.frame.ToFrame(p) - own).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= defaultWeldDistance))
                return false;
        }
        first += region->graph.Size();
    }
    return true;
}

TagCount CountHandles(const Handles &handles, std::size_t slots, const char *deleted) {
    ExpectTags(handles.tag, slots);
    TagCount tags = CountTags(handles.tag, deleted);
    tags.handle += Index(handles.point.size());
    tags.free -= Index(handles.point.size());
    if (tags.handle == 0)
        throw BadInput("There is no handle: no vertex has a tag of 2 or more. Mark the part to move with tag 2.");
    if (tags.free <= 0)
        throw BadInput("There is nothing to deform: no vertex is free. Mark the part that may bend with tag 1.");
    return tags;
}

} // namespace vcg::fcd
