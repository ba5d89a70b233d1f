// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h> // before Qt

#include "edit_fcd/bend/model/reach.h"

#include <algorithm>
#include <limits>

using vcg::fcd::Index;

// Extents of handles: the surface around, and the tips of the limb.

// The largest ball that finds tips, over the smallest one that cuts off a tip. Somewhat larger balls cut off other tips
// of the same limb, like the fingers of a hand; balls of twice the size cut off others, like the head from a shoulder.
const double largestBall = 1.5;

// A tip is another limb if it has at least this share of the area of the largest tip, or of the core: a third as long
// and as thick. Anything smaller, like an ear, goes along.
const float otherLimb = 0.1f;

const double coreSize = 0.5; // share of the radius that moves with a handle; the other half bends

// The same on a limb with something beyond, where the radius is twice its thickness: it bends from half a thickness
// before its joint to one behind it. Where a limb turns by an angle a, the ends of a strip w thicknesses wide meet
// inside if w = tan(a / 2): at 90 degrees for 1, at 113 for 1.5. The surface folds a third earlier.
const double coreOfLimb = 0.25;

// Least distance of a joint from its handle, over the radius. Between fixed surface all around, the middle of the
// bending strip is at the handle. If it lies at one side, as on a limb, that middle is half a radius away or more.
const double nearestJoint = 0.25;

// The same at the end of a limb: around a vertex of a ball, the strip is less than half a radius away, for any radius.
const double nearestJointOfEnd = 0.5;

/// Tells which pieces beside a ball are tips of the limb at its middle. These are the pieces that a ball of half the
/// radius cuts off, or a ball up to largestBall times the smallest one that cuts off any piece. \param ball nodes,
/// nearest first \param distances of these, frame units \return also whether these tips are of one limb: as the ball
/// shrinks, they meet each other before the rest
std::pair<std::vector<char>, bool> BendReach::tipsOfLimb(const Pieces &pieces, const std::vector<Index> &ball,
                                                         const std::vector<double> &distances) const {
    std::vector<char> isOfLimb(pieces.area.size(), 0);
    const std::size_t none = ball.size();
    std::vector<std::size_t> placeOf(pieces.of.size(), none);
    for (std::size_t k = 0; k < ball.size(); ++k)
        placeOf[std::size_t(ball[k])] = k;
    // Shrinks the ball: its nodes join the pieces. Once a piece meets the largest, no smaller ball cuts it off.
    vcg::fcd::DisjointSets joined{Index(pieces.area.size() + ball.size())}; // pieces, then nodes of the ball
    const auto areOne = [&](std::size_t a, std::size_t b) { return joined.Root(Index(a)) == joined.Root(Index(b)); };
    std::vector<std::size_t> met(pieces.area.size(), 0); // by which node of the ball
    std::vector<std::size_t> small;
    for (std::size_t which = 0; which < pieces.area.size(); ++which)
        if (pieces.isTip(which))
            small.push_back(which);
    std::vector<std::size_t> left = small;
    for (std::size_t k = ball.size(); k-- > 0 && !left.empty();) {
        const std::size_t own = pieces.area.size() + k;
        for (const Index v : graph().adjacency[ball[k]]) {
            const auto beside = std::size_t(v);
            if (pieces.of[beside] >= 0)
                joined.Join(pieces.of[beside], Index(own));
            else if (placeOf[beside] != none && placeOf[beside] > k)
                joined.Join(Index(pieces.area.size() + placeOf[beside]), Index(own));
        }
        const auto meets = [&](std::size_t which) {
            if (!areOne(which, pieces.largest))
                return false;
            met[which] = k;
            return true;
        };
        if (areOne(own, pieces.largest))
            left.erase(std::remove_if(left.begin(), left.end(), meets), left.end());
    }
    const double core = distances.empty() ? 0 : coreSize * distances.back();
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t which : small)
        least = std::min(least, distances[met[which]]);
    std::map<std::size_t, float> area; // of the tips that meet the rest together
    for (const std::size_t which : small)
        if (distances[met[which]] <= std::max(core, largestBall * least)) {
            isOfLimb[which] = 1;
            area[met[which]] += pieces.area[which];
        }
    float largest = 0;
    for (std::size_t k = 0; k < ball.size() && distances[k] <= core; ++k)
        largest += surface->nodeArea[std::size_t(ball[k])];
    for (const auto &[node, each] : area)
        largest = std::max(largest, each);
    const auto limbs =
        std::count_if(area.begin(), area.end(), [&](const auto &each) { return each.second > otherLimb * largest; });
    return {std::move(isOfLimb), limbs < 2};
}

/// The extent of a handle, from the cache or new.
std::shared_ptr<BendExtent> BendReach::kept(const std::vector<std::size_t> &vertices, double radius) {
    wait();
    const auto found = std::find_if(extents.begin(), extents.end(), [&](const auto &each) {
        return each->radius == radius && each->vertices == vertices;
    });
    if (found != extents.end()) {
        extents.splice(extents.begin(), extents, found);
        return extents.front();
    }
    if (extents.size() >= mostExtents)
        extents.pop_back();
    extents.push_front(std::make_shared<BendExtent>());
    BendExtent &made = *extents.front();
    made.vertices = vertices;
    made.radius = radius;
    std::vector<double> distances;
    const std::vector<Index> ball = nodesWithin(vertices, radius, &distances);
    const std::vector<char> isInside = isAmong(ball);
    made.around = slotsOf(isInside);
    const Pieces beside = piecesBeside(isInside);
    const auto [isOfLimb, isOneLimb] = tipsOfLimb(beside, ball, distances);
    made.isOneLimb = isOneLimb;
    const auto tipsThat = [&, &isOfLimb = isOfLimb](bool ofLimb) {
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
    const std::vector<char> isCore = isAmong(nodesWithin(vertices, coreSize * radius));
    std::vector<char> isBeyond(isCore.size(), 0);
    for (const std::size_t i : made.tips)
        isBeyond[std::size_t(surface->nodeOf[i])] = 1;
    const auto add = [&](const std::vector<char> &more) {
        for (std::size_t u = 0; u < more.size(); ++u)
            isBeyond[u] = char(isBeyond[u] || more[u]);
    };
    add(tipNodes(isCore));
    add(looseNodes(isBeyond, hair));
    made.beyond = slotsOf(isBeyond);
    findShares(made);
    made.core = slotsOf(made.bendsFar() ? isAmong(nodesWithin(vertices, coreOfLimb * radius)) : isCore);
    made.isWhole = true;
    return found;
}

double BendReach::radiusAt(std::size_t slot, double usual) {
    if (const double cut = closingRadius(slot, usual); cut > 0)
        return radiusOfClosing * cut;
    return std::max(usual, radiusAtEnd(slot, usual));
}

/// Sets shares, bends, axis and joint.
void BendReach::findShares(BendExtent &made) const {
    enum Part : char { Stays, Around, Beyond };
    std::vector<char> part(std::size_t(graph().Size()), Stays);
    for (const auto &[vertices, which] : {std::pair{&made.beyond, Beyond}, {&made.around, Around}})
        for (const std::size_t i : *vertices)
            if (surface->nodeOf[i] >= 0)
                part[std::size_t(surface->nodeOf[i])] = which;
    std::vector<Index> edge; // nodes that stay, beside nodes around the handle
    for (Index u = 0; u < graph().Size(); ++u)
        if (part[std::size_t(u)] == Stays) {
            const auto near = graph().adjacency[u];
            if (std::any_of(near.begin(), near.end(), [&](Index v) { return part[std::size_t(v)] == Around; }))
                edge.push_back(u);
        }
    const double radius = made.radius / surface->frame.scale, strip = (1 - coreSize) * radius,
                 farthest = (1 - coreOfLimb) * radius;
    std::vector<float> share(part.size(), 1);
    std::vector<double> distances;
    const std::vector<Index> near = vcg::fcd::NodesWithin(graph(), edge, farthest, vcg::fcd::Ways::Surface, &distances);
    Eigen::Vector4d outer = Eigen::Vector4d::Zero(), inner = outer; // sum of area times place, and of area
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < near.size() && distances[k] <= strip; ++k)
        if (part[std::size_t(near[k])] == Around)
            (distances[k] < strip / 2 ? outer : inner) += double(surface->nodeArea[std::size_t(near[k])]) *
                                                          graph().position.col(near[k]).cast<double>().homogeneous();
    for (const std::size_t i : made.vertices)
        if (surface->nodeOf[i] >= 0)
            place += graph().position.col(surface->nodeOf[i]).cast<double>() / double(made.vertices.size());
    if (const Eigen::Vector4d all = outer + inner; all[3] > 0) {
        const Eigen::Vector3d center = all.hnormalized();
        made.bends = surface->frame.FromFrame(center);
        if (outer[3] > 0 && inner[3] > 0)
            made.axis = inner.hnormalized() - outer.hnormalized();
        if ((center - place).norm() > (made.beyond.empty() ? nearestJointOfEnd : nearestJoint) * radius)
            made.joint = made.bends;
    }
    const double width = made.bendsFar() ? farthest : strip;
    for (std::size_t k = 0; k < near.size(); ++k)
        if (const auto u = std::size_t(near[k]); part[u] == Around)
            share[u] = std::min(1.f, float(distances[k] / width));
    made.share.clear();
    for (const std::size_t i : made.around)
        made.share.push_back(share[std::size_t(surface->nodeOf[i])]);
}

float BendExtent::shareAtJoint() const {
    return float((1 - coreSize) / 2 / (1 - (bendsFar() ? coreOfLimb : coreSize)));
}

float BendExtent::shareOf(std::size_t slot) const {
    const auto found = std::lower_bound(around.begin(), around.end(), slot);
    if (found != around.end() && *found == slot)
        return share[std::size_t(found - around.begin())];
    return std::binary_search(beyond.begin(), beyond.end(), slot) ? 1.f : 0.f;
}

// --- how thick the limb is that a vertex is on ---

namespace {

// Girth of a limb, over the radius of the ball around a vertex that just closes around it. It is 2 for the vertex's own
// limb, since the ball reaches half around it. It is less for another limb, like a finger from the palm.
const double leastGirth = 5. / 3;

// Length of the part of the limb that the girth is measured on, behind the ball, over the ball's radius.
const double lengthOfGirth = 1. / 3;

// Least area of the tip behind the ball, over the square of its radius: a tip half as long as thick. Less is a spike.
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

double BendReach::findClosingRadius(std::size_t slot, double usual) {
    std::vector<double> distances;
    const std::vector<Index> ball = nodesWithin({slot}, (1 + lengthOfGirth) * usual, &distances);
    const Pieces beside = piecesBeside(isAmong(ball));
    const std::size_t pieces = beside.area.size(), none = ball.size();
    if (pieces == 0)
        return 0;
    std::vector<std::size_t> placeOf(beside.of.size(), none);
    for (std::size_t k = 0; k < ball.size(); ++k)
        placeOf[std::size_t(ball[k])] = k;
    std::vector<Part> part(pieces + ball.size());      // the pieces beside, then a part for each node of the ball
    vcg::fcd::DisjointSets joined{Index(part.size())}; // a joined part has the data of its root
    for (std::size_t p = 0; p < pieces; ++p)
        part[p] = {part[p].reach, double(beside.area[p]), !beside.isTip(p)};
    const auto rootOf = [&](std::size_t a) { return std::size_t(joined.Root(Index(a))); };
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
    // Shrinks the ball: its nodes join the parts outside. Once two meet, no smaller ball cuts off
    // the one of less reach.
    const double most = usual / surface->frame.scale;
    double cut = 0;
    for (std::size_t k = ball.size(); k-- > 0;) {
        std::size_t own = pieces + k;
        part[own] = {distances[k], surface->nodeArea[std::size_t(ball[k])], false};
        for (const Index v : graph().adjacency[ball[k]]) {
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
            joined.Join(Index(own), Index(other));
            own = rootOf(own);
            part[own] = both;
        }
    }
    return cut * surface->frame.scale;
}
