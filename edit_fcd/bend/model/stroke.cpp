// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <limits>

using vcg::fcd::Index;

// Where a limb bends along a stroke.

// First guess of a joint's distance from its handle, over the radius: the middle between the radius and the core. On a
// limb, the other side is nearer; rounds correct that.
const double toJoint = 0.75;

// Factor from one radius to the next, if one does not reach around the limb beyond the joint.
const double wider = 1.2;

const int roundsToJoint = 3; // then the joint is off by a tenth of the thickness

/// The node at distance \p ahead from another one, on the way to an end, or beyond that. \param left distance of each
/// node from the end \return -1: the surface ends before
Index BendReach::along(Index from, double ahead, const std::vector<double> &left) const {
    const std::vector<Index> ball = vcg::fcd::NodesWithin(graph(), {from}, ahead, vcg::fcd::Ways::Surface);
    const std::vector<char> isIn = isAmong(ball);
    Index found = -1;
    for (const Index u : ball) {
        const auto near = graph().adjacency[u];
        const bool isEdge = std::any_of(near.begin(), near.end(), [&](Index v) { return !isIn[std::size_t(v)]; });
        if (isEdge && (found < 0 || left[std::size_t(u)] < left[std::size_t(found)]))
            found = u;
    }
    // A node on the other side would be farther from the end by that distance.
    return found >= 0 && left[std::size_t(found)] < std::max(ahead, left[std::size_t(from)]) ? found : -1;
}

std::pair<std::shared_ptr<const BendExtent>, bool> BendReach::beyond(std::size_t from, std::size_t to, double usual,
                                                                     double hair) {
    wait();
    from = carrierOf(from, hair);
    to = carrierOf(to, hair);
    const Index first = surface->nodeOf[from], last = surface->nodeOf[to];
    const double scale = surface->frame.scale, none = std::numeric_limits<double>::infinity();
    std::vector<double> left(std::size_t(graph().Size()), none), distances;
    if (first < 0 || last < 0)
        return {};
    const std::vector<Index> fromEnd =
        vcg::fcd::NodesWithin(graph(), {last}, none, vcg::fcd::Ways::Surface, &distances);
    for (std::size_t k = 0; k < fromEnd.size(); ++k)
        left[std::size_t(fromEnd[k])] = distances[k];
    const double length = scale * left[std::size_t(first)], least = radiusAt(from, usual);
    if (length == 0 || length == none)
        return {};
    const bool isLimb = closingRadius(from, usual) > 0; // then the radius is twice its thickness
    const auto placeOf = [&](Index u) { return graph().position.col(u).cast<double>(); };
    std::shared_ptr<const BendExtent> found;
    double radius = isLimb ? least : none;
    while (!found && radius <= widest * least) {
        double ahead = toJoint * radius / scale;
        for (int k = 0; k < roundsToJoint; ++k) {
            const Index node = along(first, ahead, left);
            const auto made = node < 0 ? nullptr : whole({slotOf(node)}, radius, hair);
            if (!made || !made->bends || made->shareOf(to) == 0)
                break; // the ball does not reach around the limb
            const Eigen::Vector3d offset = placeOf(node) - placeOf(first),
                                  off = surface->frame.ToFrame(*made->bends) - placeOf(first);
            if (off.dot(offset) >= offset.squaredNorm())
                break; // the handle would hold the other side
            found = made;
            // A stroke may also run around the limb: what counts is the way along it.
            const Eigen::Vector3d towards = offset.normalized(), &axis = made->axis;
            const double advance = axis.dot(towards);
            ahead -= advance > 0.5 * axis.norm() ? off.dot(axis) / advance : off.dot(towards);
        }
        radius *= wider;
    }
    if (found || (isLimb && length > least)) // else the end is near: all that lies beyond
        return {found, true};
    found = whole({to}, length / toJoint, hair);
    return {found->shareOf(from) < 1 ? found : nullptr, false};
}
