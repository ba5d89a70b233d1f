// SPDX-License-Identifier: GPL-3.0-or-later
#include "posed.h"
#include "pose_state.h"

#include <vcg_ext/field/field_sampling.h>
#include <vcg_ext/handles/motion_text.h>

using vcg::fcd::Index;
using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;
using vcg::fcd::Stopwatch;

Posed::Posed(std::shared_ptr<const Prepared> given, const PoseParam &param, const Posed *start,
             const nb::object &report)
    : prepared(std::move(given)) {
    Listener::Run(report, prepared->threads, [&](const Progress &progress) { solve(param, start, progress); });
}

Posed::Posed(std::shared_ptr<const Prepared> given, vcg::fcd::SurfacePose found, double seconds)
    : prepared(std::move(given)), anyMoves(found.Moves()), pose(std::move(found)),
      carrier(std::make_unique<const vcg::fcd::Carrier>(*prepared->deformer, pose, prepared->threads)),
      secondsSolve(seconds) {}

Posed::Posed(std::shared_ptr<const Prepared> given, const nb::bytes &state) : prepared(std::move(given)) {
    StateReader reader(poseState, std::string(state.c_str(), state.size()));
    reader(pose, reached, anyMoves, secondsSolve, secondsMap);
    reader.ExpectEnd();
    const auto &regions = prepared->deformer->regions;
    bool isOfIt = pose.region.size() == regions.size();
    for (std::size_t r = 0; isOfIt && r < regions.size(); ++r) {
        const vcg::fcd::RegionPose &posed = pose.region[r];
        const auto k = std::size_t(regions[r]->graph.Size());
        for (const vcg::fcd::GraphPose *each : {&posed.solved, &posed.graph})
            isOfIt = isOfIt && std::size_t(each->position.cols()) == k && each->linear.size() == k &&
                     (each->rests.empty() || each->rests.size() == k) && posed.nodeMotion.size() == k;
    }
    if (!isOfIt)
        throw vcg::fcd::BadInput("The pose is one of another surface, or of another version of this package: pose "
                                 "the surface anew.");
    const nb::gil_scoped_release release;
    carrier = std::make_unique<const vcg::fcd::Carrier>(*prepared->deformer, pose, prepared->threads);
}

nb::bytes Posed::state() const {
    StateWriter writer(poseState);
    writer(pose, reached, anyMoves, secondsSolve, secondsMap);
    const std::string all = std::move(writer).Sealed();
    return nb::bytes(all.data(), all.size());
}

vcg::fcd::Handles Posed::handlesOf(const PoseParam &param) const {
    vcg::fcd::Handles handles;
    handles.point = prepared->handles.point;
    for (const auto &[tag, text] : param.motions) {
        const auto steps = vcg::fcd::ReadMotionText(std::to_string(tag) + ": " + text, "the motion");
        handles.motion[tag] = vcg::fcd::ToMotion(steps.at(tag), prepared->deformer->center.at(tag));
    }
    for (std::size_t k = 0; k < handles.point.size(); ++k)
        handles.point[k].target = param.targets ? Eigen::Vector3d(rowOf(param.targets->data(), k))
                                                : Eigen::Vector3d(prepared->view.At(handles.point[k].vertex));
    return handles;
}

vcg::fcd::Handles Posed::between(const Posed &start, const vcg::fcd::Handles &end, double percent, double share) const {
    vcg::fcd::Handles handles;
    handles.point = end.point;
    for (const auto &[tag, middle] : prepared->deformer->center) {
        const vcg::fcd::HeldMotions &given = start.pose.given;
        const auto turn = given.turn.find(tag);
        const vcg::fcd::Motion from(given.motion.at(tag),
                                    turn == given.turn.end() ? Eigen::Vector3d::Zero() : turn->second, middle);
        const auto to = end.motion.find(tag);
        handles.motion[tag] = vcg::fcd::Blend(
            {{from, 100 * (1 - share)}, {to == end.motion.end() ? vcg::fcd::Motion() : to->second, percent * share}},
            middle);
    }
    for (std::size_t k = 0; k < handles.point.size(); ++k)
        handles.point[k].target = (1 - share) * start.reached[k] + share * reached[k];
    return handles;
}

void Posed::solve(const PoseParam &param, const Posed *start, const Progress &progress) {
    const Stopwatch watch;
    if (start && start->prepared != prepared)
        throw vcg::fcd::BadInput("start is a pose of another surface than this one.");
    vcg::fcd::DeformationParam how = prepared->param;
    how.pose = param.percent;
    how.steps = param.steps;
    how.Validate();
    const vcg::fcd::Deformer &deformer = *prepared->deformer;
    const vcg::fcd::Handles handles = handlesOf(param);
    for (const auto &[tag, motion] : handles.motion)
        anyMoves |= !motion.matrix.isIdentity(0) || !motion.turn.isZero(0);
    for (const vcg::fcd::PointHandle &point : handles.point) {
        const Eigen::Vector3d rest = prepared->view.At(point.vertex);
        anyMoves |= point.target != rest;
        reached.push_back(rest + how.pose / 100 * (point.target - rest));
    }
    const vcg::fcd::HeldMotions end = deformer.MotionsOf(handles, how.pose);
    const auto way = [&](int step, int steps) {
        return step == steps ? end : deformer.MotionsOf(between(*start, handles, how.pose, double(step) / steps), 100);
    };
    // To rest and from rest, a pose is solved without the start: rest has the same bits from anywhere.
    const bool isFromRest = !start || !start->pose.Moves() || !end.Moves() || start->reached.size() != reached.size();
    pose = isFromRest ? deformer.Solve(handles, how, progress) : deformer.SolveAlong(way, how, &start->pose, progress);
    carrier = std::make_unique<const vcg::fcd::Carrier>(deformer, pose, prepared->threads);
    secondsSolve = watch.Seconds();
}

void Posed::write(const Written &vertices, const std::optional<Rows> &normals, const std::optional<Written> &turned,
                  const nb::object &report) {
    const std::size_t n = prepared->view.vertexSlots;
    expectRows(vertices, n);
    if (normals)
        expectRows(*normals, n);
    if (turned)
        expectRows(*turned, n);
    const double *rest = prepared->vertices.data(), *before = normals ? normals->data() : nullptr;
    double *to = vertices.data(), *after = turned ? turned->data() : nullptr;
    const std::vector<std::uint32_t> &still = prepared->still;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        const Stopwatch watch;
        ParallelForEach(progress.Slice(0, 0.1), "Mapping to the mesh", still.size(), 1 << 16, [&](std::size_t s) {
            rowOf(to, still[s]) = rowOf(rest, still[s]);
            if (after)
                rowOf(after, still[s]) = rowOf(before, still[s]);
        });
        const auto at = [&](std::size_t i) { return Eigen::Vector3d(rowOf(rest, i)); };
        const auto ahead = [](std::size_t) {};
        if (after)
            carrier->ApplyWithNormals(
                at, [&](std::size_t i) { return Eigen::Vector3d(rowOf(before, i)); },
                [&] {
                    return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Vector3d &normal) {
                        rowOf(to, i) = p;
                        rowOf(after, i) = normal;
                    };
                },
                progress.Slice(0.1, 1), ahead);
        else
            carrier->Apply(
                at,
                [&] {
                    return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Matrix3f &) { rowOf(to, i) = p; };
                },
                false, progress.Slice(0.1, 1), ahead);
        secondsMap = watch.Seconds();
    });
}

namespace {

Eigen::Map<const Eigen::Matrix3Xd> columnsOf(const Rows &rows) {
    return Eigen::Map<const Eigen::Matrix3Xd>(rows.data(), 3, Eigen::Index(rows.shape(0)));
}

} // namespace

nb::dict Posed::check(const Rows &vertices, const nb::object &report) const {
    expectRows(vertices, prepared->view.vertexSlots);
    vcg::fcd::DeformationCheck found;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        found = vcg::fcd::CheckPose(prepared->view, prepared->handles, *prepared->deformer, pose, columnsOf(vertices),
                                    progress);
    });
    nb::dict all;
    all["rigid"] = found.rigid;
    all["overruled"] = found.overruled;
    all["strained"] = found.strained;
    all["longest"] = found.longest;
    all["folded"] = found.flipped;
    all["volume_off"] = found.volumeOff > found.volumeIsSeen ? found.volumeOff : 0;
    return all;
}

nb::tuple Posed::contact(const Rows &vertices, const nb::object &report) const {
    expectRows(vertices, prepared->view.vertexSlots);
    vcg::fcd::SurfaceContact found;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        found =
            vcg::fcd::ContactOf(prepared->view, *prepared->deformer, columnsOf(vertices), prepared->param, progress);
    });
    return nb::make_tuple(arrayOf<std::int64_t>(found.face), found.pairs, found.largest,
                          found.depth.empty() ? nb::none() : arrayOf<double>(found.depth));
}

nb::object Posed::stretch(const Rows &vertices, const nb::object &report) const {
    expectRows(vertices, prepared->view.vertexSlots);
    vcg::fcd::SurfaceMeasure measure;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        measure = vcg::fcd::MeasurePose(*prepared->deformer, pose, *carrier, columnsOf(vertices), progress);
    });
    return arrayOf<float>(measure.stretch);
}

nb::tuple Posed::map(const Rows &points, const std::optional<Rows> &normals, const nb::object &report) const {
    const std::size_t n = points.shape(0);
    double *moved, *turned = nullptr;
    const nb::object positions = newArray({n, 3}, moved);
    const nb::object others = normals ? newArray({n, 3}, turned) : nb::none();
    const double *from = points.data(), *direction = normals ? normals->data() : nullptr;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        const vcg::fcd::NearestPlace &places = prepared->places(progress.Slice(0, 0.3));
        forRangesInSpace(from, n, prepared->box, progress.Slice(0.3, 1), "Mapping points",
                         [&](const std::vector<std::size_t> &numbers, vcg::fcd::NearestPlace::Hint &hint) {
                             std::vector<vcg::fcd::SurfacePlace> place(numbers.size());
                             std::vector<Eigen::Vector3d> p, displacement;
                             std::vector<Eigen::Matrix3f> linear;
                             for (std::size_t k = 0; k < numbers.size(); ++k) {
                                 p.push_back(rowOf(from, numbers[k]));
                                 if (p[k].cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e100) // as in DeformationField
                                     place[k] = places(p[k], hint);
                             }
                             carrier->Displacements(place, p, displacement, linear);
                             for (std::size_t k = 0; k < numbers.size(); ++k) {
                                 const bool isPlace = place[k].count > 0;
                                 rowOf(moved, numbers[k]) = isPlace ? Eigen::Vector3d(p[k] + displacement[k]) : p[k];
                                 if (direction)
                                     rowOf(turned, numbers[k]) = turnedNormal(
                                         isPlace ? linear[k] : Eigen::Matrix3f(Eigen::Matrix3f::Identity()),
                                         rowOf(direction, numbers[k]));
                             }
                         });
    });
    return nb::make_tuple(positions, others);
}

nb::tuple Posed::field(bool inverse, double accuracy, const nb::object &report) const {
    const vcg::fcd::Stopwatch watch;
    vcg::fcd::FieldParam param;
    param.accuracy = accuracy;
    vcg::fcd::SampledField sampled;
    std::unique_ptr<Field> made;
    Index folded = 0;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        Eigen::Matrix3Xd rest = prepared->view.Copy(prepared->threads);
        Eigen::Matrix3Xd deformed = rest;
        std::vector<Eigen::Matrix3f> linear;
        carrier->Apply(deformed, &linear, progress.Slice(0, 0.1));
        if (inverse) {
            rest.swap(deformed);
            folded = vcg::fcd::Invert(linear);
        }
        sampled = vcg::fcd::SampleField(prepared->view, rest, deformed, linear, param, progress.Slice(0.1, 1),
                                        Eigen::Matrix3d::Identity(), prepared->deformer->FreeIn());
        made = std::make_unique<Field>(std::move(sampled.samples), progress.Slice(1, 1));
    });
    nb::dict all;
    all["warning"] = sampled.Warning();
    all["folds"] = vcg::fcd::FoldsWarning(folded);
    all["seconds"] = watch.Seconds();
    return nb::make_tuple(std::move(made), all);
}

nb::tuple Posed::nodes() const {
    const auto k = std::size_t(prepared->deformer->Nodes());
    double *position, *linear;
    nb::object positions = newArray({k, 3}, position), maps = newArray({k, 3, 3}, linear);
    std::size_t j = 0;
    for (std::size_t r = 0; r < pose.region.size(); ++r) {
        const vcg::fcd::GraphPose &graph = pose.region[r].graph;
        const vcg::fcd::Frame &frame = prepared->deformer->regions[r]->surface.frame;
        for (Eigen::Index own = 0; own < graph.position.cols(); ++own, ++j) {
            rowOf(position, j) = frame.FromFrame(Eigen::Vector3d(graph.position.col(own)));
            Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(linear + 9 * j) = graph.linear[std::size_t(own)];
        }
    }
    return nb::make_tuple(positions, maps);
}

nb::dict Posed::info() const {
    nb::dict all;
    all["nodes"] = prepared->deformer->Nodes();
    all["iterations"] = pose.iterations;
    all["converged"] = pose.converged;
    all["energy"] = pose.energy;
    all["moves"] = anyMoves;
    all["seconds_solve"] = secondsSolve;
    all["seconds_map"] = secondsMap;
    return all;
}

double Posed::discretisationError(const nb::object &report) const {
    double error = 0;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        error = prepared->deformer->DiscretisationError(pose, prepared->param, progress);
    });
    return error;
}
