// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <limits>
#include <numeric>

// How thick the limb is that a vertex is on.

namespace {

// A ball that has just closed around its limb reaches half around it, so the girth is twice the ball's radius. That of
// another limb which the ball cuts off is less: a finger's, seen from the palm. The bound is between the two.
const double leastGirth = 5. / 3;

// The girth is measured where the ball cuts the tip off: from there on, so long a part of the ball's radius.
const double lengthOfGirth = 1. / 3;

// Of the square of the ball's radius: the least area of a tip, which is then as long as half of its thickness. What is
// smaller is a spike of a scan.
const double leastArea = 0.5;

// Of the ball's radius: so far does the tip reach, at least. Then something lies beyond a handle there, whose radius is
// radiusOfCut times as large.
const double leastReach = 4 / EIGEN_PI;

/// A connected part of what lies outside of a ball.
struct Part {
    double reach = std::numeric_limits<double>::infinity(); ///< of its remotest node; infinite: beyond the largest ball
    double area = 0;
    bool isRest = false; ///< it is no tip
};

} // namespace

double BendReach::cutAt(std::size_t slot, double usual) {
    wait();
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
    std::vector<Part> part(pieces + ball.size()); // the pieces, then one for each node of the ball
    std::vector<std::size_t> parent(part.size());
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    for (std::size_t p = 0; p < pieces; ++p)
        part[p] = {part[p].reach, double(beside.area[p]), !beside.isTip(p)};
    const auto rootOf = [&](std::size_t a) {
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        return a;
    };
    const auto isLimb = [&](std::size_t which, std::size_t k) {
        const double radius = distances[k];
        if (part[which].isRest || part[which].area < leastArea * radius * radius ||
            part[which].reach < leastReach * radius)
            return false;
        double area = 0;
        for (std::size_t i = k; i < ball.size() && distances[i] <= (1 + lengthOfGirth) * radius; ++i)
            if (rootOf(pieces + i) == which)
                area += surface->nodeArea[std::size_t(ball[i])];
        return area >= leastGirth * radius * lengthOfGirth * radius;
    };
    // The ball shrinks and gives its nodes back. When two parts meet, smaller balls do not cut the one off that reaches
    // less far.
    const double most = usual / surface->frame.scale;
    double cut = 0;
    for (std::size_t k = ball.size(); k-- > 0;) {
        std::size_t own = pieces + k;
        part[own] = {distances[k], surface->nodeArea[std::size_t(ball[k])], false};
        for (const vcg::fcd::Index v : graph.adjacency[ball[k]]) {
            const int piece = beside.of[std::size_t(v)];
            const std::size_t place = placeOf[std::size_t(v)];
            if (piece < 0 && (place == none || place < k))
                continue; // it is in the smaller ball
            std::size_t other = rootOf(piece < 0 ? pieces + place : std::size_t(piece));
            if (other == own)
                continue;
            const auto rank = [&](std::size_t p) { return std::pair(part[p].isRest, part[p].reach); };
            if (rank(other) < rank(own))
                std::swap(own, other);
            if (distances[k] > 0 && distances[k] <= most && isLimb(own, k))
                cut = distances[k];
            parent[own] = other;
            part[other].area += part[own].area;
            own = other;
        }
    }
    return cut * surface->frame.scale;
}
