// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/onion_skin.h"

#include "edit_fcd/bend/model/named_poses.h"
#include "edit_fcd/view/trace.h"

#include <utility>

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
