// SPDX-License-Identifier: GPL-3.0-or-later
#include "compensated.h"
#include "fitted.h"
#include "listener.h"
#include "pose_state.h"

#include <algorithm>
#include <limits>

Compensating::Compensating(const Rows &vertices, const std::optional<Corners> &faces, const Rows &scan,
                           const std::optional<Corners> &scanFaces, const std::optional<Rows> &scanNormals,
                           const nb::dict &given, unsigned threads, const nb::object &report)
    : threads(threads) {
    vcg::fcd::CompensateParam param;
    param.degree = nb::cast<int>(given["degree"]);
    param.samples = nb::cast<int>(given["samples"]);
    param.largestDistance = nb::cast<double>(given["largest_distance"]);
    if (param.largestDistance == 0)
        param.largestDistance = std::numeric_limits<double>::infinity();
    const vcg::fcd::NormalOf normal = normalsOf(scanNormals);
    Listener::Run(report, threads, [&](const vcg::fcd::Progress &progress) {
        const vcg::fcd::SurfaceView nominal = viewOf(vertices, faces), target = viewOf(scan, scanFaces);
        nominal.Validate();
        target.Validate();
        compensation = std::make_unique<const vcg::fcd::Compensation>(nominal, target, normal, param, progress);
    });
}

Compensating::Compensating(const nb::bytes &state) {
    StateReader reader(compensationState, std::string(state.c_str(), state.size()));
    auto read = std::make_unique<vcg::fcd::Compensation>();
    reader(threads, *read);
    reader.ExpectEnd();
    compensation = std::move(read);
}

nb::bytes Compensating::state() const {
    StateWriter writer(compensationState);
    writer(threads, *compensation);
    const std::string all = std::move(writer).Sealed();
    return nb::bytes(all.data(), all.size());
}

nb::dict Compensating::told() const {
    const vcg::fcd::CompensateReport &found = compensation->report;
    nb::dict all;
    all["before"] = found.before;
    all["left"] = found.left;
    all["scanned"] = found.scanned;
    all["change"] = found.change;
    all["change_most"] = found.changeMost;
    all["missed"] = found.missed;
    return all;
}

nb::object Compensating::made() const {
    double *to;
    nb::object rows = newArray({std::size_t(compensation->position.cols()), 3}, to);
    std::copy_n(compensation->position.data(), compensation->position.size(), to);
    return rows;
}

nb::object Compensating::apply(const Rows &points, bool predicted, const nb::object &report) const {
    double *to;
    nb::object made = newArray({points.shape(0), 3}, to);
    Listener::Run(report, threads, [&](const vcg::fcd::Progress &progress) {
        ParallelForEach(progress, "Compensating", points.shape(0), 1 << 10, [&](std::size_t i) {
            const Eigen::Vector3d p = rowOf(points.data(), i);
            rowOf(to, i) = predicted ? compensation->Predicted(p) : (*compensation)(p);
        });
    });
    return made;
}
