// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <algorithm>
#include <limits>
#include <numeric>

// What belongs to a handle: what is around it, and the tips of the limb that it is on.

namespace {

// Of the smallest ball around a handle that cuts off a tip: larger ones cut off what hangs on the same place, as the
// fingers do on a hand, and then, at twice that or more, what does not: the head, seen from a shoulder.
const double largestBall = 1.5;

const double coreSize = 0.5; // of the radius: so much turns with a handle, and the other half is left to bend

} // namespace

/// Which of the pieces that a ball leaves are tips of the limb that its middle is on. A ball of half the radius
/// cuts those off, or one that is hardly larger than the smallest one that cuts off any. \param ball nodes, nearest
/// first \param distances of these
std::vector<char> BendReach::tipsOfLimb(const Pieces &pieces, const std::vector<vcg::fcd::Index> &ball,
                                        const std::vector<double> &distances) const {
    std::vector<char> isOfLimb(pieces.area.size(), 0);
    const std::size_t none = ball.size();
    std::vector<std::size_t> placeOf(pieces.of.size(), none);
    for (std::size_t k = 0; k < ball.size(); ++k)
        placeOf[std::size_t(ball[k])] = k;
    // The ball shrinks, and gives its nodes back to the pieces: when one of these meets the largest, a smaller ball
    // does not cut it off.
    std::vector<std::size_t> parent(pieces.area.size() + ball.size()); // pieces, then nodes of the ball
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    const auto rootOf = [&](std::size_t a) {
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        return a;
    };
    std::vector<double> cutAt(pieces.area.size(), 0);
    std::vector<std::size_t> left;
    for (std::size_t which = 0; which < pieces.area.size(); ++which)
        if (pieces.isTip(which))
            left.push_back(which);
    for (std::size_t k = ball.size(); k-- > 0 && !left.empty();) {
        const std::size_t own = pieces.area.size() + k;
        for (const vcg::fcd::Index v : surface->graph.adjacency[ball[k]]) {
            const auto beside = std::size_t(v);
            if (pieces.of[beside] >= 0)
                parent[rootOf(std::size_t(pieces.of[beside]))] = rootOf(own);
            else if (placeOf[beside] != none && placeOf[beside] > k)
                parent[rootOf(pieces.area.size() + placeOf[beside])] = rootOf(own);
        }
        const auto meets = [&](std::size_t which) {
            if (rootOf(which) != rootOf(pieces.largest))
                return false;
            cutAt[which] = distances[k];
            return true;
        };
        if (rootOf(own) == rootOf(pieces.largest))
            left.erase(std::remove_if(left.begin(), left.end(), meets), left.end());
    }
    double most = distances.empty() ? 0 : coreSize * distances.back(), least = std::numeric_limits<double>::infinity();
    for (std::size_t which = 0; which < pieces.area.size(); ++which)
        if (pieces.isTip(which))
            least = std::min(least, cutAt[which]);
    most = std::max(most, largestBall * least);
    for (std::size_t which = 0; which < pieces.area.size(); ++which)
        isOfLimb[which] = pieces.isTip(which) && cutAt[which] <= most;
    return isOfLimb;
}

/// The extent of a handle, which is the last one from then on.
std::shared_ptr<BendExtent> BendReach::kept(const std::vector<std::size_t> &vertices, double radius) {
    wait();
    const auto found = std::find_if(extents.begin(), extents.end(), [&](const auto &each) {
        return each->radius == radius && each->vertices == vertices;
    });
    if (found != extents.end()) {
        extents.splice(extents.begin(), extents, found);
        return extents.front();
    }
    const std::size_t most = 24; // as many handles as a person has; of a large layer each is some megabytes
    if (extents.size() >= most)
        extents.pop_back();
    extents.push_front(std::make_shared<BendExtent>());
    BendExtent &made = *extents.front();
    made.vertices = vertices;
    made.radius = radius;
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> ball = nodesWithin(vertices, radius, &distances);
    std::vector<char> isInside(std::size_t(surface->graph.Size()), 0);
    for (const vcg::fcd::Index u : ball)
        isInside[std::size_t(u)] = 1;
    made.around = slotsOf(isInside);
    const Pieces beside = piecesBeside(isInside);
    const std::vector<char> isOfLimb = tipsOfLimb(beside, ball, distances);
    const auto tipsThat = [&](bool ofLimb) {
        std::vector<char> isIn(isInside.size());
        for (std::size_t u = 0; u < isIn.size(); ++u)
            isIn[u] = beside.of[u] >= 0 && beside.isTip(std::size_t(beside.of[u])) &&
                      (isOfLimb[std::size_t(beside.of[u])] != 0) == ofLimb;
        return slotsOf(isIn);
    };
    made.tips = tipsThat(true);
    made.aside = tipsThat(false);
    return extents.front();
}

std::shared_ptr<const BendExtent> BendReach::extent(const std::vector<std::size_t> &vertices, double radius) {
    return kept(vertices, radius);
}

std::shared_ptr<const BendExtent> BendReach::whole(const std::vector<std::size_t> &vertices, double radius,
                                                   double hair) {
    const std::shared_ptr<BendExtent> found = kept(vertices, radius);
    BendExtent &made = *found;
    if (made.isWhole)
        return found;
    std::vector<char> isInside(surface->nodeOf.size(), 0);
    made.core = of(vertices, coreSize * radius);
    for (const std::size_t i : made.core)
        isInside[i] = 1;
    std::vector<char> isBeyond(isInside.size(), 0);
    for (const std::size_t i : made.tips)
        isBeyond[i] = 1;
    for (const std::size_t i : tips(isInside))
        isBeyond[i] = 1;
    for (const std::size_t i : looseAmong(isBeyond, hair))
        isBeyond[i] = 1;
    for (std::size_t i = 0; i < isBeyond.size(); ++i)
        if (isBeyond[i])
            made.beyond.push_back(i);
    made.isWhole = true;
    return found;
}
