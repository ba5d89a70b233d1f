// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <limits>

// Where a limb begins, and where it bends along a stroke.

// At the root of a limb, where it meets the body, the surface around a cross-section grows by this factor within the
// limb's thickness. A thigh or a tail, which widens all along, grows less in that: a cone of up to 40 degrees.
const float thicker = 1.75;

// Largest area of a limb, over that of all: as for tips, which are at most half as large as the rest.
const float largestLimb = 1.f / 3;

// Near the end of a limb, tries vertices towards the body: the first at the usual radius / nearestPart, each next one
// wayOff times as far. A finger of a figure is five times as long as the first distance.
const double nearestPart = 16, wayOff = 1.3;

// From the fraction quickPart on, tries take time. They are made only if the ring with them is not flat: if its area is
// less than leastFlat of a flat ring's. Around the end of a limb, at twice the limb's thickness, it has a third.
const double quickPart = 6, leastFlat = 0.8;

// Distance of the farthest one, over the radius of the ball that closes around the limb at the vertex. A limb that is
// much thinner has no vertex beyond.
const double farOfCut = 0.75;

// The largest radius for one limb, over that at another place: a hand is wider than its wrist, but hardly twice as
// wide.
const double widest = 2;

const float leastShare = 0.5; // of a vertex that turns with its limb, and does not rather stay

// Between the powers of the distance with which an area grows: 1 along a limb, 2 on a plane.
const double betweenLineAndPlane = 1.5;

const double ringsOfRadius = 4; // that growth is measured over one of them, the outermost

const int binsOfThickness = 2; // cross-sections for each thickness of a limb

// Of a limb, at least: its end is round, so that the first ones are small.
const std::size_t leastSections = 2 * std::size_t(binsOfThickness);

// A vertex is pointed if the area within the usual radius is less than this share of a flat disc's. The corner of a
// cube has 0.75 of it, the tip of a cone with an angle of 80 degrees 0.64.
const double leastFlatEnd = 0.65;

// Least distance of its joint from the surface, over the radius: it is 0 at the corner of a sheet, and 0.25 in a limb
// half as thick as the radius is long.
const double leastInside = 0.125;

const double nearestEnd = 4; // an end is farther from the center than all within that fraction of the usual radius

std::optional<std::size_t> BendReach::rootOfLimb(std::size_t slot, double usual, double hair, std::size_t nearer) {
    wait();
    if (surface->nodeOf[slot] < 0)
        return {};
    // Near the end of a limb, nothing lies beyond the vertex. Then it may lie beyond another one, towards the body.
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> ball = nodesWithin({slot}, usual, &distances);
    const auto placeOf = [&](vcg::fcd::Index u) { return surface->graph.position.col(u); };
    const auto isNearer = [&](vcg::fcd::Index u, vcg::fcd::Index v) {
        return (placeOf(u) - placeOf(ball.back())).squaredNorm() < (placeOf(v) - placeOf(ball.back())).squaredNorm();
    };
    const Pointed pointed{slot, usual, hair, nearer};
    const auto rootBeyond = [&](std::size_t before, double radius) {
        const bool isBeyond = whole({before}, radius, hair)->shareOf(slot) == 1;
        return isBeyond ? rootBefore(before, radius, pointed) : std::nullopt;
    };
    const double cut = closingRadius(slot, usual), most = cut > 0 ? farOfCut * cut : usual / 4;
    double next = usual / nearestPart;
    const auto rootTowardsBody = [&](double upTo) -> std::optional<std::size_t> {
        while (next < upTo) {
            const double far = next;
            next *= wayOff;
            const auto first = [&](double distance) {
                const auto found =
                    std::lower_bound(distances.begin(), distances.end(), distance / surface->frame.scale);
                return ball.begin() + (found - distances.begin());
            };
            const auto nearest = first(far), farthest = first(wayOff * far);
            const auto isFlat = [&] {
                double area = 0;
                for (auto u = nearest; u != farthest; ++u)
                    area += surface->nodeArea[std::size_t(*u)];
                const double unit = far / surface->frame.scale;
                return area > leastFlat * EIGEN_PI * (wayOff * wayOff - 1) * unit * unit;
            };
            if (nearest == farthest || (far > usual / quickPart && isFlat()))
                continue;
            const std::size_t before = slotOf(*std::min_element(nearest, farthest, isNearer));
            if (const double closing = closingRadius(before, 2 * far); closing > 0)
                if (const auto root = rootBeyond(before, radiusOfClosing * closing))
                    return root;
        }
        return {};
    };
    if (const auto root = rootTowardsBody(most))
        return root;
    if (const auto root = rootBefore(slot, cut > 0 ? radiusOfClosing * cut : usual, pointed))
        return root;
    const std::size_t last = slotOf(ball.back());
    const double closing = closingRadius(last, usual);
    if (const auto root = rootBeyond(last, closing > 0 ? radiusOfClosing * closing : usual))
        return root;
    if (const auto root = rootTowardsBody(usual)) // a head is thicker than its neck
        return root;
    return endOfShortLimb(pointed);
}

/// Twice the thickness of a limb at its end, where a ball of the usual radius reaches around it; world units. 0: the
/// vertex is at no such end.
double BendReach::radiusAtEnd(std::size_t slot, double usual) const {
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> ball = nodesWithin({slot}, usual, &distances);
    const double unit = usual / surface->frame.scale, ring = unit / ringsOfRadius;
    double all = 0, outer = 0;
    for (std::size_t k = 0; k < ball.size(); ++k) {
        for (const vcg::fcd::Index v : surface->graph.adjacency[ball[k]])
            if (double((surface->graph.position.col(v) - surface->graph.position.col(ball[k])).norm()) > ring)
                return 0; // the areas of nodes tell nothing here
        const double area = surface->nodeArea[std::size_t(ball[k])];
        all += area;
        outer += distances[k] > unit - ring ? area : 0;
    }
    const double girth = outer / ring; // the area grows by girth * unit / all as power of the distance
    return girth * unit < betweenLineAndPlane * all ? 2 * girth / double(EIGEN_PI) * surface->frame.scale : 0;
}

/// Tells whether a vertex is the end of something like a thumb or a short tail: pointed, and with its joint inside.
bool BendReach::isRoundEnd(std::size_t slot, const Pointed &at) {
    const std::vector<vcg::fcd::Index> ball = nodesWithin({slot}, at.usual);
    const double unit = at.usual / surface->frame.scale;
    double area = 0;
    for (const vcg::fcd::Index u : ball)
        area += surface->nodeArea[std::size_t(u)];
    if (area > leastFlatEnd * EIGEN_PI * unit * unit)
        return false;
    const auto joint = whole({slot}, at.usual, at.hair)->joint;
    const Eigen::Vector3d inside = surface->frame.ToFrame(joint.value_or(Eigen::Vector3d::Zero()));
    return joint && std::all_of(ball.begin(), ball.end(), [&](vcg::fcd::Index u) {
               return (surface->graph.position.col(u).cast<double>() - inside).norm() > leastInside * unit;
           });
}

/// The end of a limb that is too short to have anything beyond a handle, if the vertex turns with it: the vertex around
/// that is farthest from the center of the body, or else one of its own part.
std::optional<std::size_t> BendReach::endOfShortLimb(const Pointed &at) {
    const vcg::fcd::Graph &graph = surface->graph;
    const auto farthest = [&](std::size_t from, double radius) {
        const std::vector<vcg::fcd::Index> ball = nodesWithin({from}, radius);
        return slotOf(*std::max_element(ball.begin(), ball.end(), [&](vcg::fcd::Index u, vcg::fcd::Index v) {
            return (graph.position.col(u) - middleOfAll).squaredNorm() <
                   (graph.position.col(v) - middleOfAll).squaredNorm();
        }));
    };
    const auto isEnd = [&](std::size_t slot) {
        if ((radiusAtEnd(slot, at.usual) < at.usual && !isRoundEnd(slot, at)) || !turnsOneLimb(slot, at))
            return false;
        float turned = 0;
        for (const vcg::fcd::Index u : nodesWithin({slot}, radiusAt(slot, at.usual)))
            turned += surface->nodeArea[std::size_t(u)];
        return turned < largestLimb * areaOfAll;
    };
    const std::size_t end = farthest(at.slot, 2 * at.usual);
    if (isEnd(end))
        return end;
    const double step = at.usual / nearestEnd;
    std::size_t near = at.slot, next = farthest(near, step);
    while (next != near)
        next = farthest(near = next, step);
    return near != end && isEnd(near) ? std::optional(near) : std::nullopt;
}

/// Tells whether a handle turns the limb of a vertex about a joint, and no other limb with it.
bool BendReach::turnsOneLimb(std::size_t root, const Pointed &at) {
    const auto turned = whole({root}, radiusAt(root, at.usual), at.hair);
    return turned->joint && turned->isOneLimb && turned->shareOf(at.slot) > leastShare;
}

/// The means of three values each: a section of a coarse surface may have a third less than the next.
static std::vector<float> smoothed(const std::vector<float> &area) {
    std::vector<float> mean = area;
    for (std::size_t k = 1; k + 1 < area.size(); ++k)
        mean[k] = (area[k - 1] + area[k] + area[k + 1]) / 3;
    return mean;
}

/// The same for a vertex of the limb, if something of it lies beyond. \param pointed the vertex that is to turn
std::optional<std::size_t> BendReach::rootBefore(std::size_t slot, double radius, const Pointed &pointed) {
    const vcg::fcd::Index own = surface->nodeOf[slot];
    const auto grip = whole({slot}, radius, pointed.hair);
    if (!grip->joint)
        return {};
    const vcg::fcd::Graph &graph = surface->graph;
    const double all = std::numeric_limits<double>::infinity();
    std::vector<char> isBeyond(std::size_t(graph.Size()), 0);
    for (const std::size_t i : grip->beyond)
        if (surface->nodeOf[i] >= 0)
            isBeyond[std::size_t(surface->nodeOf[i])] = 1;
    const std::vector<vcg::fcd::Index> fromHere = vcg::fcd::NodesWithin(graph, {own}, all, vcg::fcd::Ways::Surface);
    const auto tip = std::find_if(fromHere.rbegin(), fromHere.rend(),
                                  [&](vcg::fcd::Index u) { return isBeyond[std::size_t(u)] != 0; });
    if (tip == fromHere.rend())
        return {};
    // A cross-section is at one distance from the tip.
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> fromTip =
        vcg::fcd::NodesWithin(graph, {*tip}, all, vcg::fcd::Ways::Surface, &distances);
    const double bin = radius / surface->frame.scale / (2 * binsOfThickness); // the radius is two thicknesses
    std::vector<std::size_t> section(isBeyond.size(), 0);
    std::vector<float> area(1, 0);
    float total = 0;
    for (std::size_t k = 0; k < fromTip.size(); ++k) {
        const auto u = std::size_t(fromTip[k]);
        section[u] = std::size_t(distances[k] / bin);
        area.resize(std::max(area.size(), section[u] + 1), 0);
        area[section[u]] += surface->nodeArea[u];
        total += surface->nodeArea[u];
    }
    const std::size_t start = section[std::size_t(own)];
    float before = 0;
    for (std::size_t k = 0; k <= start; ++k)
        before += area[k];
    std::size_t root = start;
    const std::vector<float> smooth = smoothed(area);
    const auto isThick = [&](std::size_t k) {
        return k > leastSections && smooth[k] > thicker * smooth[k - binsOfThickness];
    };
    while (root + 1 < area.size() && !isThick(root + 1) && before + area[root + 1] <= largestLimb * total)
        before += area[++root];
    // The joint of a handle is about the limb's thickness away from it. If that turns more than the limb, such as a
    // leg with the tail, another one is tried, towards the end.
    const std::size_t first = root - std::min<std::size_t>(root, binsOfThickness * (1 + pointed.nearer));
    for (std::size_t at = first + 1; at-- > std::min(start, first);) {
        const auto there = std::find_if(fromHere.begin(), fromHere.end(),
                                        [&](vcg::fcd::Index u) { return section[std::size_t(u)] == at; });
        if (there != fromHere.end() && // faces may be longer than a section
            radiusAt(slotOf(*there), pointed.usual) <= widest * radius && turnsOneLimb(slotOf(*there), pointed))
            return slotOf(*there);
    }
    return turnsOneLimb(slot, pointed) ? std::optional(slot) : std::nullopt;
}

// First guess of a joint's distance from its handle, over the radius: the middle between the radius and the core. On a
// limb, the other side is nearer; rounds correct that.
const double toJoint = 0.75;

// Factor from one radius to the next, if one does not reach around the limb beyond the joint.
const double wider = 1.2;

const int roundsToJoint = 3; // then the joint is off by a tenth of the thickness

/// The node at distance \p ahead from another one, on the way to an end, or beyond that. \param left distance of each
/// node from the end \return -1: the surface ends before
vcg::fcd::Index BendReach::along(vcg::fcd::Index from, double ahead, const std::vector<double> &left) const {
    const vcg::fcd::Graph &graph = surface->graph;
    const std::vector<vcg::fcd::Index> ball = vcg::fcd::NodesWithin(graph, {from}, ahead, vcg::fcd::Ways::Surface);
    std::vector<char> isIn(left.size(), 0);
    for (const vcg::fcd::Index u : ball)
        isIn[std::size_t(u)] = 1;
    vcg::fcd::Index found = -1;
    for (const vcg::fcd::Index u : ball) {
        const auto near = graph.adjacency[u];
        const bool isEdge =
            std::any_of(near.begin(), near.end(), [&](vcg::fcd::Index v) { return !isIn[std::size_t(v)]; });
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
    const vcg::fcd::Index first = surface->nodeOf[from], last = surface->nodeOf[to];
    const double scale = surface->frame.scale, none = std::numeric_limits<double>::infinity();
    std::vector<double> left(std::size_t(surface->graph.Size()), none), distances;
    if (first < 0 || last < 0)
        return {};
    const std::vector<vcg::fcd::Index> fromEnd =
        vcg::fcd::NodesWithin(surface->graph, {last}, none, vcg::fcd::Ways::Surface, &distances);
    for (std::size_t k = 0; k < fromEnd.size(); ++k)
        left[std::size_t(fromEnd[k])] = distances[k];
    const double length = scale * left[std::size_t(first)], least = radiusAt(from, usual);
    if (length == 0 || length == none)
        return {};
    const bool isLimb = closingRadius(from, usual) > 0; // then the radius is twice its thickness
    const auto placeOf = [&](vcg::fcd::Index u) { return surface->graph.position.col(u).cast<double>(); };
    std::shared_ptr<const BendExtent> found;
    double radius = isLimb ? least : none;
    while (!found && radius <= widest * least) {
        double ahead = toJoint * radius / scale;
        for (int k = 0; k < roundsToJoint; ++k) {
            const vcg::fcd::Index node = along(first, ahead, left);
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
