// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <limits>

// How thick the limb is that a vertex is on.

namespace {

// Girth of a limb, over the radius of the ball around a vertex that just closes around it. It is 2 for the vertex's own
// limb, since the ball reaches half around it. It is less for another limb, like a finger from the palm.
const double leastGirth = 5. / 3;

// Length of the part of the limb that the girth is measured on, behind the ball, over the ball's radius.
const double lengthOfGirth = 1. / 3;

// Least area of the tip behind the ball, over the square of the ball's radius: as of a tip half as long as it is thick.
// Anything smaller is a spike of a scan.
const double leastArea = 0.5;

const std::size_t mostClosing = 10000; // that are kept, of one surface

/// A connected part of the surface outside of a ball.
struct Part {
    double reach = std::numeric_limits<double>::infinity(); ///< distance of its remotest node, if that was in the ball
    double area = 0;
    bool isRest = false; ///< it is too large for a tip
};

} // namespace

double BendReach::closingRadius(std::size_t slot, double usual) {
    wait();
    if (const auto known = closings.find({slot, usual}); known != closings.end())
        return known->second;
    if (closings.size() >= mostClosing)
        closings.clear();
    return closings[{slot, usual}] = findClosingRadius(slot, usual);
}

double BendReach::findClosingRadius(std::size_t slot, double usual) const {
    const vcg::fcd::Graph &graph = surface->graph;
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> ball = nodesWithin({slot}, (1 + lengthOfGirth) * usual, &distances);
    const Pieces beside = piecesBeside(isAmong(ball));
    const std::size_t pieces = beside.area.size(), none = ball.size();
    if (pieces == 0)
        return 0;
    std::vector<std::size_t> placeOf(beside.of.size(), none);
    for (std::size_t k = 0; k < ball.size(); ++k)
        placeOf[std::size_t(ball[k])] = k;
    std::vector<Part> part(pieces + ball.size()); // the pieces beside, then a part for each node of the ball
    vcg::fcd::DisjointSets joined{vcg::fcd::Index(part.size())}; // a joined part has the data of its root
    for (std::size_t p = 0; p < pieces; ++p)
        part[p] = {part[p].reach, double(beside.area[p]), !beside.isTip(p)};
    const auto rootOf = [&](std::size_t a) { return std::size_t(joined.Root(vcg::fcd::Index(a))); };
    const auto isLimb = [&](std::size_t which, std::size_t k) {
        const double radius = distances[k];
        if (part[which].isRest || part[which].area < leastArea * radius * radius ||
            part[which].reach < radiusOfClosing * radius) // nothing would lie beyond a handle here
            return false;
        double area = 0;
        for (std::size_t i = k; i < ball.size() && distances[i] <= (1 + lengthOfGirth) * radius; ++i)
            if (rootOf(pieces + i) == which)
                area += surface->nodeArea[std::size_t(ball[i])];
        return area >= leastGirth * radius * lengthOfGirth * radius;
    };
    // Shrinks the ball: its nodes join the parts outside. Once two parts meet, a smaller ball does not cut off the one
    // of less reach.
    const double most = usual / surface->frame.scale;
    double cut = 0;
    for (std::size_t k = ball.size(); k-- > 0;) {
        std::size_t own = pieces + k;
        part[own] = {distances[k], surface->nodeArea[std::size_t(ball[k])], false};
        for (const vcg::fcd::Index v : graph.adjacency[ball[k]]) {
            const int number = beside.of[std::size_t(v)];
            const std::size_t place = placeOf[std::size_t(v)];
            if (number < 0 && (place == none || place < k))
                continue; // still in the ball
            std::size_t other = rootOf(number < 0 ? pieces + place : std::size_t(number));
            if (other == own)
                continue;
            const auto rank = [&](std::size_t p) { return std::pair(part[p].isRest, part[p].reach); };
            if (rank(other) < rank(own))
                std::swap(own, other);
            if (distances[k] > 0 && distances[k] <= most && isLimb(own, k))
                cut = distances[k];
            part[other].area += part[own].area;
            const Part both = part[other];
            joined.Join(vcg::fcd::Index(own), vcg::fcd::Index(other));
            own = rootOf(own);
            part[own] = both;
        }
    }
    return cut * surface->frame.scale;
}
