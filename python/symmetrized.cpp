// SPDX-License-Identifier: GPL-3.0-or-later
#include "fitted.h"

#include <vcg_ext/symmetrize.h>

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

using vcg::fcd::Progress;
using vcg::fcd::SymmetryGoal;
using vcg::fcd::SymmetryReport;

namespace {

SymmetryGoal symmetryGoalOf(const nb::dict &given) {
    SymmetryGoal goal;
    const auto vertex = nb::cast<Fitting::Numbers>(given["vertex"]); // ends of the pairs, then the midline
    const auto place = nb::cast<Rows>(given["place"]);
    const auto pairs = nb::cast<std::size_t>(given["pairs"]);
    const auto mark = [&](std::size_t l) {
        return vcg::fcd::SymmetryMark{std::size_t(vertex.data()[l]), rowOf(place.data(), l)};
    };
    for (std::size_t k = 0; k < pairs; ++k)
        goal.pairs.push_back({mark(2 * k), mark(2 * k + 1)});
    for (std::size_t l = 2 * pairs; l < vertex.shape(0); ++l)
        goal.midline.push_back(mark(l));
    if (!given["plane"].is_none()) {
        const auto plane = nb::cast<Rows>(given["plane"]);
        goal.plane = vcg::fcd::MirrorPlane{rowOf(plane.data(), 0), rowOf(plane.data(), 1)};
    }
    return goal;
}

std::array<double, 3> told(const Eigen::Vector3d &v) { return {v[0], v[1], v[2]}; }

} // namespace

nb::tuple Fitting::symmetrize(const nb::dict &given, const std::optional<Rows> &normals,
                              const std::optional<Weights> &weights, const nb::object &report) const {
    using vcg::fcd::PositionsRef;
    const SymmetryGoal goal = symmetryGoalOf(given);
    const vcg::fcd::NormalOf normal = normalsOf(normals);
    const vcg::fcd::WeightOf weight = weightsOf(weights);
    const vcg::fcd::SurfaceView &view = prepared->view;
    const vcg::fcd::Deformer &deformer = *prepared->deformer;
    const Eigen::Affine3d world = Eigen::Affine3d::Identity();
    const std::size_t n = view.vertexSlots;
    double *half, *mirror;
    bool *matched;
    nb::object halfRows = newArray({n, 3}, half), mirrorRows = newArray({n, 3}, mirror), flags = newArray({n}, matched);
    SymmetryReport found;
    vcg::fcd::SymmetricPose made;
    double before = 0, after = 0;
    const vcg::fcd::Stopwatch watch;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        made = vcg::fcd::Symmetrize(*fitter, view, normal, world, goal, found, progress.Slice(0, 0.7), weight);
        const auto carried = [&](const vcg::fcd::SurfacePose &pose, const Progress &part) {
            Eigen::Matrix3Xd position = view.Copy();
            vcg::fcd::Carrier(deformer, pose, part.threads).Apply(position, nullptr, part);
            return position;
        };
        std::vector<float> distance;
        std::vector<char> liesOn;
        const auto apart = [&](const PositionsRef &position, const Progress &part) {
            return vcg::fcd::DistanceFromMirror(*fitter, view, normal, world, found.plane, liesOn, position, part,
                                                weight);
        };
        fitter->Compare(*made.target, found.fit, carried(made.fitted, progress.Slice(0.7, 0.75)), distance, liesOn,
                        progress.Slice(0.75, 0.8));
        made.target = nullptr;
        std::copy(liesOn.begin(), liesOn.end(), matched);
        Eigen::Map<Eigen::Matrix3Xd>(mirror, 3, Eigen::Index(n)) = carried(made.mirror, progress.Slice(0.8, 0.85));
        Eigen::Map<Eigen::Matrix3Xd> at(half, 3, Eigen::Index(n));
        at = carried(made.half, progress.Slice(0.85, 0.9));
        vcg::fcd::PutPartners(*fitter, view, world, goal, found, at);
        before = apart(view.Positions(), progress.Slice(0.9, 0.95));
        after = apart(at, progress.Slice(0.95, 1));
    });
    nb::dict all;
    all["plane"] =
        nb::make_tuple(nb::tuple(nb::cast(told(found.plane.point))), nb::tuple(nb::cast(told(found.plane.normal))));
    all["plane_from"] = found.isGiven ? "given" : found.isOfLandmarks ? "landmarks" : "surface";
    all["is_sure"] = found.isSure;
    all["before"] = before;
    all["after"] = after;
    all["asymmetry"] = found.asymmetry;
    all["asymmetry_most"] = found.asymmetryMost;
    all["moved"] = found.moved;
    all["moved_most"] = found.movedMost;
    all["matched"] = found.fit.matched;
    all["guessed"] = found.fit.guessed;
    all["guess_error"] = found.fit.guessError;
    all["contradiction"] = found.Contradiction(goal.pairs.size());
    all["contradicted"] = nb::tuple(nb::cast(found.contradicted));
    all["pairs"] = goal.pairs.size();
    all["midline"] = goal.midline.size();
    all["converged"] = found.fit.converged;
    all["diagonal"] = deformer.frame.scale;
    return nb::make_tuple(std::make_unique<Posed>(prepared, std::move(made.half), watch.Seconds()), halfRows,
                          mirrorRows, flags, all);
}
