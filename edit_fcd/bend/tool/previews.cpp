// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/named_poses.h"
#include "edit_fcd/bend/tool/previews.h"
#include "edit_fcd/view/trace.h"

#include <utility>

using vcg::fcd::LineGoal;
using vcg::fcd::Progress;

/// The answer for points of the line that is used.
static BendLinePreview::Found previewOf(const Eigen::Matrix3Xd &points, double smoothing) {
    BendLinePreview::Found found;
    found.points = points;
    const vcg::fcd::FramedLine line(points, smoothing);
    found.length = line.Length();
    const int parts = 200;
    found.path.resize(3, parts + 1);
    for (int i = 0; i <= parts; ++i)
        found.path.col(i) = line.At(line.Length() * i / parts).point;
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
            found = previewOf(goal.line, goal.smoothing);
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
            search->found = previewOf(vcg::fcd::LineOf(search->goal, *search->surface->prepared->deformer,
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

// Each takes some hundred kilobytes.
const std::size_t mostKnown = 32;

/// The work in the background, and its result.
struct BendOnionSkin::Search {
    std::shared_ptr<BlendShapes> shapes;
    std::shared_ptr<const GhostParts> parts;
    std::map<std::vector<double>, Shape> found; ///< null: not yet
};

void BendOnionSkin::look(BendSession &session, double time, bool isShown) {
    wanted = ghostFrames(keyFrames(session.state()), time, isShown);
    if (wanted.before.empty() && wanted.after.empty()) {
        hide();
        return;
    }
    if (BendSession::BlendSource now = session.blendSource(); !(now == source)) {
        known.clear();
        pause();
        shapes = session.blendShapes();
        parts.reset();
        source = session.blendSource(); // blendShapes() may have read the surface
    }
    if (!shapes) {
        hide();
        return;
    }
    showWanted();
    begin();
}

/// Shows the wanted ghosts if they are known; otherwise the last ones stay.
void BendOnionSkin::showWanted() {
    show(before, wanted.before);
    show(after, wanted.after);
}

void BendOnionSkin::show(LayerGhost &ghost, const std::vector<double> &weight) {
    const auto found = known.find(weight);
    if (weight.empty() || (found != known.end() && !found->second))
        ghost.hide();
    else if (found != known.end())
        ghost.show(parts, found->second);
}

/// Begins to compute the wanted shapes that are not known.
void BendOnionSkin::begin() {
    if (work)
        return;
    auto begun = std::make_shared<Search>();
    for (const std::vector<double> &each : {wanted.before, wanted.after})
        if (!each.empty() && known.count(each) == 0)
            begun->found[each] = nullptr;
    if (begun->found.empty())
        return;
    begun->shapes = shapes;
    begun->parts = parts;
    search = std::move(begun);
    const auto find = [search = search](const vcg::fcd::Progress &progress) {
        if (!search->parts)
            search->parts = std::make_shared<const GhostParts>(
                GhostParts::of(search->shapes->surface->View(), *search->shapes->tags));
        for (auto &[weight, shape] : search->found)
            shape =
                std::make_shared<const std::vector<float>>(search->shapes->of(weight, search->parts->slot, progress));
    };
    work.begin(find, [this](const std::exception_ptr &thrown) { ended(thrown); });
}

void BendOnionSkin::ended(const std::exception_ptr &thrown) {
    const std::shared_ptr<Search> done = std::move(search);
    bool isStopped = done->shapes != shapes;
    try {
        if (thrown)
            std::rethrow_exception(thrown);
    } catch (const vcg::fcd::Cancelled &) {
        isStopped = true;
    } catch (const std::exception &e) { // a pose that cannot be solved; the user is told when posing it
        trace("ghosts: none: %s", e.what());
    }
    if (!isStopped) {
        parts = done->parts;
        if (known.size() > mostKnown)
            known.clear();
        for (auto &each : done->found)
            known.insert(each);
        showWanted();
        trace("ghosts: %d, of %d vertices, as %s", int(before.isShown()) + int(after.isShown()),
              parts ? int(parts->slot.size()) : 0, parts && parts->element.empty() ? "points" : "faces");
    }
    changed();
}

void BendOnionSkin::hide() {
    wanted = {};
    pause();
    showWanted();
}

void BendOnionSkin::pause() {
    if (work)
        work.cancel();
}

void BendOnionSkin::draw(const CMeshO &mesh) {
    before.draw(mesh);
    after.draw(mesh);
}
