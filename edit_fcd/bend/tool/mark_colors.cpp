// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/mark_colors.h"

#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/view/colors.h"

#include <layer_fcd/tagging.h>

#include <algorithm>
#include <array>

const unsigned char opacity = 150;     // of marks and stretch, of 255: the surface shows through
const unsigned char alongOpacity = 60; // of vertices that only move along, and can be pulled

// Largest share of vertices for tint(): with more, finding the faces of each takes as long as testing all faces.
const double mostColored = 0.125;

bool MarkColors::isStretch(const BendSession &session) const {
    return session.model().options.stretch && !session.marksBeingMade() && layer.cm.fn > 0;
}

std::vector<vcg::Color4b> MarkColors::of(const BendSession &session) {
    if (isStretch(session)) {
        const RestGuard &rest = session.restShape();
        std::vector<vcg::Color4b> color = colorsOfStretch(layer.cm, rest.positions(), rest.world().linear(), opacity);
        const vcg::Color4b inContact(200, 0, 200, 255);
        const std::vector<double> &depth = session.contact().depth;
        for (std::size_t i = 0; i < depth.size(); ++i)
            if (depth[i] > 0)
                color[i] = inContact;
        return color;
    }
    std::vector<vcg::Color4b> color = ofMarks(session);
    if (previewed.empty() || session.marksBeingMade())
        return color;
    color.resize(session.tags().size(), vcg::Color4b(0, 0, 0, 0));
    forPreview(session, [&](std::size_t i, const vcg::Color4b &own) { color[i] = own; });
    return color;
}

static std::set<int> hiddenIn(const BendState &state) {
    std::set<int> hidden;
    for (const auto &[tag, each] : state.handles)
        if (each.isHidden)
            hidden.insert(tag);
    return hidden;
}

/// One colour per vertex slot; empty if nothing is marked or turned.
std::vector<vcg::Color4b> MarkColors::ofMarks(const BendSession &session) {
    const BendState &state = session.state();
    const BendTags *making = session.marksBeingMade(), *marks = making ? making : state.marks.get();
    const BendTags &held = making ? *making : session.tags();
    std::set<int> grips;
    for (const auto &[tag, point] : state.points)
        if (point.isGrip)
            grips.insert(tag);
    std::vector<vcg::Color4b> color;
    if (!marks && grips.empty())
        return color;
    const std::set<int> hidden = hiddenIn(state);
    color.assign(held.size(), vcg::Color4b(0, 0, 0, 0));
    forEach(held.size(), [&](std::size_t i) {
        if (held[i] != 1 && ((marks && (*marks)[i] != 1) || grips.count(held[i])) && !hidden.count(held[i])) {
            color[i] = colorOfTag(held[i]);
            color[i][3] = !making && isAlong(session.model(), i) ? alongOpacity : opacity;
        }
    });
    return color;
}

/// Sets colored and colorOf, unless they are known.
void MarkColors::findColored(const BendSession &session) {
    const BendState &state = session.state();
    Marked now = {state.marks, session.model().influence.tags, state.points, hiddenIn(state)};
    if (marked == now)
        return;
    colored.clear();
    colorOf.clear();
    const std::vector<vcg::Color4b> color = ofMarks(session);
    for (std::size_t i = 0; i < color.size(); ++i)
        if (color[i][3]) {
            colored.push_back(std::uint32_t(i));
            colorOf.push_back(color[i]);
        }
    marked = std::move(now);
}

std::optional<MarkColors::Tint> MarkColors::tint(BendSession &session) {
    if (previewed.empty() || session.marksBeingMade() || isStretch(session) || layer.cm.fn == 0)
        return {};
    const VertexFaces *faces = session.faces();
    if (!faces)
        return {};
    findColored(session);
    if (double(colored.size()) > mostColored * double(faces->vertexSlots()))
        return {};
    if (!room)
        room = std::make_unique<DrawnVertices>(faces->vertexSlots());
    DrawnVertices &placeOf = *room;
    Tint tint;
    const auto set = [&](std::size_t i, const vcg::Color4b &own) {
        const std::size_t at = placeOf(i);
        tint.color.resize(placeOf.slot.size());
        tint.color[at] = own;
    };
    for (std::size_t k = 0; k < colored.size(); ++k)
        set(colored[k], colorOf[k]);
    forPreview(session, set);
    const std::size_t known = tint.color.size();
    const auto isSeen = [&](std::uint32_t at) { return at < known && tint.color[at][3] > 0; };
    tint.element.reserve(6 * known); // about two triangles for each vertex
    for (std::size_t j = 0; j < known; ++j)
        if (tint.color[j][3] > 0)
            faces->forEach(placeOf.slot[j], [&](const std::uint32_t *corner) {
                const std::array<std::uint32_t, 3> at = {placeOf(corner[0]), placeOf(corner[1]), placeOf(corner[2])};
                if (*std::find_if(at.begin(), at.end(), isSeen) == j) // else another vertex lists this face
                    tint.element.insert(tint.element.end(), at.begin(), at.end());
            });
    tint.color.resize(placeOf.slot.size(), vcg::Color4b(0, 0, 0, 0));
    if (!tint.element.empty()) // without triangles, points would be drawn
        tint.slot = placeOf.slot;
    placeOf.clear();
    return tint;
}

bool MarkColors::preview(Extents extents) {
    extents.erase(std::remove(extents.begin(), extents.end(), nullptr), extents.end());
    const bool isOther = extents != previewed;
    previewed = std::move(extents);
    return isOther;
}

/// Calls set(slot, color) for the vertices of the preview.
template <class Set>
void MarkColors::forPreview(const BendSession &session, const Set &set) const {
    const BendTags &tags = session.tags();
    const auto *marks = session.state().marks.get();
    const auto mix = [&](std::size_t i, double share) {
        if (!marks || (*marks)[i] == 1) // marked vertices stay, or have a motion of their own
            set(i, vcg::Color4b(250, 190, 40, (unsigned char)(share * opacity)));
    };
    for (const auto &each : previewed) {
        const auto isMore = [&](std::size_t i, float share) { // than with another handle
            return std::all_of(previewed.begin(), previewed.end(),
                               [&](const auto &other) { return other == each || other->shareOf(i) <= share; });
        };
        for (const std::size_t i : each->beyond)
            mix(i, 1);
        for (std::size_t k = 0; k < each->around.size(); ++k) {
            const std::size_t i = each->around[k];
            if ((tags[i] < 2 || isAlong(session.model(), i)) && isMore(i, each->share[k]))
                mix(i, each->share[k]);
        }
    }
}
