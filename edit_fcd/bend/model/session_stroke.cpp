// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/handles.h"
#include "edit_fcd/bend/model/session.h"

#include <algorithm>

// A stroke along a limb tells where it bends, and what turns.

Eigen::Vector3d BendSession::seenAt(const Eigen::Vector3d &place, std::size_t slot) const {
    const int holder = tags()[slot];
    return holder >= 2 ? Eigen::Vector3d(motionAt(data, holder) * place)
                       : Eigen::Vector3d(place + positionOf(slot) - rest.world() * rest.at(slot));
}

BendSession::Turned BendSession::turnedBy(BendReach &from, const BendStroke &stroke, double usual) const {
    const auto [extent, isLimb] = from.beyond(stroke.from, stroke.to, usual, usualGap(rest.diagonal()));
    const std::size_t slot = extent ? extent->vertices.front() : 0;
    const bool isNew = extent && canBecomePoint(data, slot);
    const int tag = isNew ? 0 : tags()[slot];
    if (!extent || (!isNew && tag < 2) || handleOf(state(), tag).isLocked)
        return {};
    return {tag, extent, isLimb && extent->bends ? seenAt(rest.world() * *extent->bends, stroke.from) : stroke.through};
}

BendSession::Turned BendSession::glimpseStroke(const BendStroke &stroke, double usual) {
    reach.begin();
    if (!reach.isRead())
        return {};
    reach.lookAt(stroke.from);
    return turnedBy(reach.glance(), stroke, usual);
}

int BendSession::strokeAt(const BendStroke &stroke, double usual) {
    const Turned found = turnedBy(reach, stroke, usual);
    if (!found.extent)
        throw vcg::fcd::Error("Beyond this stroke lies no limb that is free to turn: draw it from a joint towards the "
                              "end of the limb.");
    const double radius = std::max(found.extent->radius, leastRadius * rest.diagonal());
    const int tag = found.tag ? found.tag : addAt(found.extent->vertices.front(), radius);
    makeGrip(tag);
    setPivot(data, tag, found.pivot);
    return tag;
}
