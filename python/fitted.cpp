// SPDX-License-Identifier: GPL-3.0-or-later
#include "fitted.h"

#include <vcg_ext/handles/motion_text.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>

using vcg::fcd::CurvePair;
using vcg::fcd::FitGoal;
using vcg::fcd::FitParam;
using vcg::fcd::FitReport;
using vcg::fcd::Fitter;
using vcg::fcd::Handles;
using vcg::fcd::Landmark;
using vcg::fcd::NormalOf;
using vcg::fcd::Progress;

namespace {

/// \param given parameters by name; others have the filter's defaults
FitParam fitParamOf(const nb::dict &given) {
    FitParam param;
    param.start = vcg::fcd::FitStart(nb::cast<int>(given["start"]));
    param.stiffness = nb::cast<double>(given["stiffness"]);
    param.fitRigidity = nb::cast<double>(given["rigidity"]);
    param.largestDistance = nb::cast<double>(given["largest_distance"]);
    if (param.largestDistance == 0)
        param.largestDistance = std::numeric_limits<double>::infinity();
    param.largestAngle = nb::cast<double>(given["largest_angle"]);
    param.bothWays = nb::cast<bool>(given["both_ways"]);
    param.landmarkTolerance = nb::cast<double>(given["landmark_tolerance"]);
    param.graph.initialPatches = nb::cast<int>(given["patches"]);
    param.graph.randomSeed = nb::cast<unsigned>(given["seed"]);
    param.smoothness = nb::cast<double>(given["smoothness"]);
    param.samples = nb::cast<int>(given["samples"]);
    param.fitSteps = nb::cast<int>(given["steps"]);
    return nb::cast<bool>(given["landmarks_only"]) ? param.LandmarksAlone() : param;
}

std::vector<Eigen::Vector3d> pointsOf(const Rows &rows) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(rows.shape(0));
    for (std::size_t k = 0; k < rows.shape(0); ++k)
        points.emplace_back(rowOf(rows.data(), k));
    return points;
}

nb::object rowsOf(const std::vector<Eigen::Vector3d> &points) {
    double *data;
    nb::object rows = newArray({points.size(), 3}, data);
    for (std::size_t k = 0; k < points.size(); ++k)
        rowOf(data, k) = points[k];
    return rows;
}

std::vector<Landmark> landmarksOf(const Fitting::Pairs &pairs) {
    const auto &[points, places, offsets] = pairs;
    std::vector<Landmark> landmarks;
    for (std::size_t k = 0; k < points.shape(0); ++k)
        landmarks.push_back({std::size_t(points.data()[k]), rowOf(places.data(), k), rowOf(offsets.data(), k)});
    return landmarks;
}

} // namespace

vcg::fcd::WeightOf weightsOf(const std::optional<Fitting::Weights> &weights) {
    if (!weights)
        return {};
    return [data = weights->data()](std::size_t i) { return data[i]; };
}

NormalOf normalsOf(const std::optional<Rows> &rows) {
    if (!rows)
        return {};
    return [data = rows->data()](std::size_t i) { return Eigen::Vector3d(rowOf(data, i)); };
}

Fitting::Fitting(const Rows &vertices, const std::optional<Corners> &faces,
                 const Given<std::int32_t, nb::ndim<1>> &tags, const std::vector<std::pair<int, std::string>> &motions,
                 const std::optional<Rows> &normals, const nb::dict &given, unsigned threads,
                 const nb::object &report) {
    const FitParam param = fitParamOf(given);
    const std::optional<Weights> weights = nb::cast<std::optional<Weights>>(given["weights"]);
    const auto make = [&](const Prepared &read, const Progress &progress) {
        Handles handles = read.handles;
        const auto center = vcg::fcd::HandleCenters(handles.tag, [&](std::size_t i) { return read.view.At(i); });
        for (const auto &[tag, text] : motions) {
            const auto steps = vcg::fcd::ReadMotionText(std::to_string(tag) + ": " + text, "the motion");
            handles.motion[tag] = vcg::fcd::ToMotion(steps.at(tag), center.at(tag));
        }
        fitter =
            std::make_shared<const Fitter>(read.view, normalsOf(normals), handles, param, progress, weightsOf(weights));
        return std::shared_ptr<const vcg::fcd::Deformer>(fitter, &fitter->Surface()); // shares the fitter's ownership
    };
    prepared = std::make_shared<Prepared>(vertices, faces, tags, param, threads, report, make);
}

nb::list readCurves(const nb::bytes &content, const std::string &name) {
    const std::vector<CurvePair> curves = [text = std::string(content.c_str(), content.size()), &name] {
        const nb::gil_scoped_release release;
        return vcg::fcd::ReadCurveText(text, name);
    }();
    nb::list all;
    for (const CurvePair &curve : curves)
        all.append(nb::make_tuple(nb::bytes(curve.name.data(), curve.name.size()), nb::cast(curve.sourceLine),
                                  rowsOf(curve.source), rowsOf(curve.target)));
    return all;
}

nb::list Fitting::along(const std::vector<FileCurve> &curves, const nb::object &report) const {
    std::vector<CurvePair> pairs;
    pairs.reserve(curves.size());
    for (const auto &[name, file, line, source, target] : curves)
        pairs.push_back({{name.c_str(), name.size()}, pointsOf(source), pointsOf(target), line, file});
    vcg::fcd::CurveLead lead;
    Listener::Run(report, prepared->threads,
                  [&](const Progress &progress) { lead = fitter->LeadAlong(pairs, "the surface", progress); });
    nb::list all;
    for (const vcg::fcd::Curve &curve : lead.curve)
        all.append(nb::make_tuple(arrayOf<std::int64_t>(curve.vertex), rowsOf(curve.offset)));
    return all;
}

nb::tuple Fitting::fit(const nb::dict &given, const Pairs &pairs, bool leaveOneOut, const nb::object &report) const {
    const bool isAlone = given.empty();
    std::optional<Rows> vertices, normals;
    std::optional<Corners> faces;
    std::optional<Weights> weights;
    FitGoal goal;
    if (!isAlone) {
        vertices = nb::cast<Rows>(given["vertices"]);
        faces = nb::cast<std::optional<Corners>>(given["faces"]);
        normals = nb::cast<std::optional<Rows>>(given["normals"]);
        goal.surface = viewOf(*vertices, faces);
        goal.normal = normalsOf(normals);
        weights = nb::cast<std::optional<Weights>>(given["weights"]);
        goal.weight = weightsOf(weights);
        for (const auto &[points, corners, offsets] :
             nb::cast<std::vector<std::tuple<Numbers, Rows, Rows>>>(given["curves"])) {
            const std::vector<std::size_t> vertex(points.data(), points.data() + points.shape(0));
            goal.curves.push_back({vertex, pointsOf(corners), pointsOf(offsets)});
        }
    }
    FitReport found;
    std::vector<double> leftOut;
    vcg::fcd::SurfacePose pose;
    const vcg::fcd::Stopwatch watch;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        const std::vector<Landmark> landmarks = landmarksOf(pairs);
        if (!isAlone)
            goal.surface.Validate(progress.Slice(0, 0.02));
        const auto target = isAlone ? fitter->TargetOf(landmarks) : fitter->Prepare(goal, progress.Slice(0.02, 0.3));
        const double first = leaveOneOut ? 0.4 : 1; // the rest is for the fits without one landmark
        pose = fitter->Solve(*target, landmarks, found, progress.Slice(0.3, first));
        if (leaveOneOut)
            leftOut = fitter->LeaveOneOut(*target, landmarks, progress.Slice(first, 1));
    });
    pose.iterations = found.steps;
    nb::dict all;
    all["rms"] = found.rms;
    all["median"] = found.median;
    all["percentile_95"] = found.percentile95;
    all["matched"] = found.matched;
    all["moved"] = found.moved;
    all["moved_most"] = found.movedMost;
    all["guessed"] = found.guessed;
    all["guess_error"] = found.guessError;
    all["leave_one_out"] = nb::tuple(nb::cast(leftOut));
    all["counted"] = found.counted;
    all["carried"] = found.carried;
    all["landmarks"] = std::get<0>(pairs).shape(0);
    all["landmark_residual"] = found.landmarks;
    all["curve_residual"] = found.curves;
    all["landmark_pull"] = found.pull;
    all["both_ways"] = found.bothWays;
    all["inside_out"] = found.insideOut;
    nb::list contradicted;
    for (std::size_t each : found.contradicted)
        contradicted.append(each);
    all["contradicted"] = nb::tuple(contradicted);
    all["target_not_finite"] = found.notFinite;
    all["from_afar"] = found.fromAfar;
    all["landmark_remarks"] = found.LandmarkRemarks();
    all["target_remarks"] = found.TargetRemarks();
    all["is_misplaced"] = found.IsMisplaced();
    all["steps"] = found.steps;
    all["beyond"] = found.beyond;
    all["diagonal"] = prepared->deformer->frame.scale;
    return nb::make_tuple(std::make_unique<Posed>(prepared, std::move(pose), watch.Seconds()), all);
}

void Fitting::put(const Pairs &landmarks, const Written &vertices) const {
    expectRows(vertices, prepared->view.vertexSlots);
    const nb::gil_scoped_release release;
    fitter->PutLandmarks(landmarksOf(landmarks),
                         Eigen::Map<Eigen::Matrix3Xd>(vertices.data(), 3, Eigen::Index(vertices.shape(0))));
}

std::vector<double> Fitting::residuals(const Posed &posed, const Pairs &checks, const Rows &vertices) const {
    expectRows(vertices, prepared->view.vertexSlots);
    const nb::gil_scoped_release release;
    const Eigen::Map<const Eigen::Matrix3Xd> position(vertices.data(), 3, Eigen::Index(vertices.shape(0)));
    return fitter->Residuals(landmarksOf(checks), posed.solved(), position);
}
