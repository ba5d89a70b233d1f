// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/mark_colors.h"

#include "edit_fcd/bend/model/handles.h"

#include <layer_fcd/tagging.h>

namespace {

const unsigned char opacity = 150;     // of marks, and of stretch, of 255: the surface is still seen
const unsigned char alongOpacity = 60; // of what only goes along, and can be pulled by itself

} // namespace

bool MarkColors::isStretch(const BendSession &session) const {
    return session.model().options.stretch && !session.marksBeingMade() && layer.cm.fn > 0;
}

std::vector<vcg::Color4b> MarkColors::of(const BendSession &session) {
    if (isStretch(session)) {
        if (!stretch)
            stretch = std::make_unique<StretchColors>(layer);
        const RestGuard &rest = session.restShape();
        std::vector<vcg::Color4b> color = stretch->of(rest.positions(), rest.world().linear(), opacity);
        const vcg::Color4b inContact(200, 0, 200, 255);
        const std::vector<float> &depth = session.contact().depth;
        for (std::size_t i = 0; i < depth.size(); ++i)
            if (depth[i] > 0)
                color[i] = inContact;
        return color;
    }
    const BendState &state = session.state();
    const BendTags *making = session.marksBeingMade(), *marks = making ? making : state.marks.get();
    const BendTags &held = making ? *making : session.tags();
    std::set<int> grips, hidden;
    for (const auto &[tag, point] : state.points)
        if (point.isGrip)
            grips.insert(tag);
    for (const auto &[tag, each] : state.handles)
        if (each.isHidden)
            hidden.insert(tag);
    std::vector<vcg::Color4b> color;
    const bool isPreview = previewed && !making;
    if (!marks && grips.empty() && !isPreview)
        return color;
    color.assign(held.size(), vcg::Color4b(0, 0, 0, 0));
    vcg::fcd::ParallelFor(0, held.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (held[i] != 1 && ((marks && (*marks)[i] != 1) || grips.count(held[i])) && !hidden.count(held[i])) {
                color[i] = colorOfTag(held[i]);
                color[i][3] = !making && isAlong(session.model(), i) ? alongOpacity : opacity;
            }
    });
    if (isPreview)
        addPreview(session, color);
    return color;
}

bool MarkColors::preview(std::shared_ptr<const BendExtent> extent) {
    const bool isOther = extent != previewed;
    previewed = std::move(extent);
    return isOther;
}

void MarkColors::addPreview(const BendSession &session, std::vector<vcg::Color4b> &color) const {
    const BendTags &tags = session.tags();
    const auto *marks = session.state().marks.get();
    const auto set = [&](std::size_t i, double share) {
        if (marks && (*marks)[i] != 1)
            return; // it stays, or moves by itself
        color[i] = vcg::Color4b(250, 190, 40, (unsigned char)(share * opacity));
    };
    for (const std::size_t i : previewed->beyond)
        set(i, 1);
    for (std::size_t k = 0; k < previewed->around.size(); ++k) {
        const std::size_t i = previewed->around[k];
        if (tags[i] < 2 || isAlong(session.model(), i))
            set(i, previewed->share[k]);
    }
}
