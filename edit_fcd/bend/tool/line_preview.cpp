// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/line_preview.h"

#include <utility>

using vcg::fcd::LineGoal;
using vcg::fcd::Progress;

/// The answer for points of the line that is used.
static BendLinePreview::Found through(const Eigen::Matrix3Xd &points, double smoothing) {
    BendLinePreview::Found found;
    found.points = points;
    const vcg::fcd::FramedLine line(points, smoothing);
    found.length = line.Length();
    const int parts = 200;
    found.way.resize(3, parts + 1);
    for (int i = 0; i <= parts; ++i)
        found.way.col(i) = line.At(line.Length() * i / parts).point;
    return found;
}

static bool isSameLine(const LineGoal &a, const LineGoal &b) {
    return a.middle == b.middle && a.smoothing == b.smoothing && a.line.cols() == b.line.cols() && a.line == b.line;
}

void BendLinePreview::look(const MeshModel &layer, std::uint64_t shape, const LineGoal &goal,
                           const vcg::fcd::StraightenParam &param) {
    const bool isOther = surface && shape != shapeOfSurface;
    if (isOther) {
        surface.reset();
        if (work)
            work.cancel();
    } else if (isSameLine(goal, asked) && (isLast || work))
        return;
    asked = goal;
    bend = param;
    isLast = false;
    if (!goal.middle) {
        try {
            found = through(goal.line, goal.smoothing);
        } catch (const vcg::fcd::Error &e) {
            found = {};
            found.error = e.what();
        }
        isLast = true;
        return;
    }
    if (!surface) {
        surface = std::make_shared<LineSurface>(layer);
        shapeOfSurface = shape;
    }
    if (!work)
        begin();
}

void BendLinePreview::begin() {
    search = std::make_shared<Search>();
    search->goal = asked;
    search->surface = surface;
    const auto find = [search = search, param = bend](const Progress &progress) {
        if (!search->surface->prepared)
            search->surface->prepare(param, progress.Slice(0, 0.7));
        if (search->goal.line.cols() > 1) {
            vcg::fcd::StraightenReport report;
            search->found = through(vcg::fcd::LineOf(search->goal, *search->surface->prepared->deformer,
                                                     search->surface->world, progress.Slice(0.7, 1), &report),
                                    search->goal.smoothing);
            search->found.report = std::move(report);
        }
    };
    work.begin(find, [this](const std::exception_ptr &thrown) { ended(thrown); });
}

void BendLinePreview::ended(const std::exception_ptr &thrown) {
    bool isWhole = true;
    try {
        if (thrown)
            std::rethrow_exception(thrown);
    } catch (const vcg::fcd::Cancelled &) {
        isWhole = false;
    } catch (const std::exception &e) {
        search->found = {};
        search->found.error = e.what();
    }
    took = 1000 * search->watch.Seconds();
    if (isWhole && search->surface == surface) {
        found = std::move(search->found);
        isLast = isSameLine(search->goal, asked);
    }
    if (!isLast && asked.middle)
        try {
            begin();
        } catch (const std::exception &e) {
            found = {};
            found.error = e.what();
            isLast = true;
        }
    changed();
}

KnownLine BendLinePreview::stop(const LineGoal &goal) {
    KnownLine known;
    work.stop(); // waits for it
    if (surface && surface->prepared)
        known.surface = surface;
    if (isLast && goal.middle && isSameLine(goal, asked)) {
        known.middle = found.points;
        known.report = found.report;
    }
    asked.line.resize(3, 0); // forces the next look()
    isLast = false;
    return known;
}
