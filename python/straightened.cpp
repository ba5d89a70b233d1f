// SPDX-License-Identifier: GPL-3.0-or-later
#include "straightened.h"

#include <vcg_ext/straighten.h>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

namespace {

Eigen::Matrix3Xd pointsOf(const nb::handle &rows) {
    const auto given = nb::cast<Rows>(rows);
    return Eigen::Map<const Eigen::Matrix3Xd>(given.data(), 3, Eigen::Index(given.shape(0)));
}

vcg::fcd::LineGoal goalOf(const nb::dict &given) {
    vcg::fcd::LineGoal goal;
    goal.line = pointsOf(given["line"]);
    if (!given["target"].is_none())
        goal.target = pointsOf(given["target"]);
    goal.arc.degrees = nb::cast<double>(given["degrees"]);
    goal.arc.direction = pointsOf(given["direction"]);
    goal.arc.towards = pointsOf(given["towards"]);
    goal.length = nb::cast<double>(given["length"]);
    goal.smoothing = nb::cast<double>(given["smoothing"]);
    goal.middle = nb::cast<bool>(given["middle"]);
    goal.untwist = nb::cast<bool>(given["untwist"]);
    return goal;
}

} // namespace

nb::tuple straighten(const std::shared_ptr<Prepared> &prepared, const nb::dict &goal, const nb::object &report) {
    const vcg::fcd::LineGoal wanted = goalOf(goal);
    vcg::fcd::StraightenReport found;
    vcg::fcd::SurfacePose pose;
    const vcg::fcd::Stopwatch watch;
    Listener::Run(report, prepared->threads, [&](const vcg::fcd::Progress &progress) {
        const Eigen::Affine3d world = Eigen::Affine3d::Identity();
        const vcg::fcd::LineMotion motion =
            vcg::fcd::MotionTo(wanted, *prepared->deformer, world, found, progress.Slice(0, 0.4));
        pose = vcg::fcd::Straighten(*prepared->deformer, world, motion, prepared->param, found, progress.Slice(0.4, 1));
    });
    nb::dict all;
    all["length"] = found.length;
    all["new_length"] = found.newLength;
    all["jitter"] = found.jitter;
    all["is_middle"] = found.isMiddle;
    all["left_middle"] = found.leftMiddle;
    all["lengthening"] = found.lengthening;
    all["is_beside"] = found.isBeside;
    all["twist"] = found.twist;
    all["following"] = found.following;
    all["released"] = found.released;
    all["released_at"] = nb::cast(found.releasedAt);
    all["rms"] = found.rms;
    all["largest"] = found.largest;
    return nb::make_tuple(std::make_unique<Posed>(prepared, std::move(pose), watch.Seconds()), all, found.Warnings(),
                          found.Remedy());
}
