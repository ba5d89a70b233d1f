// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <cmath>
#include <limits>

using vcg::fcd::Index;

// Where a limb begins.

// At the root of a limb, where it meets the body, the surface around a cross-section grows by this factor within the
// limb's thickness. A thigh or a tail, which widens all along, grows less in that: a cone of up to 40 degrees.
const float thicker = 1.75;

// The same of a root that widens slowly, like a neck between sloping shoulders, at least. Sections of an even limb seem
// to grow by this: one of three in a mean may have a third less.
const float slowlyThicker = 1.25;

// Largest area of a limb, over that of all: as for tips, which are at most half as large as the rest.
const float largestLimb = 1.f / 3;

// Near the end of a limb, tries vertices towards the body: the first at the usual radius / nearestPart, each next one
// wayOff times as far. A finger of a figure is five times as long as the first distance.
const double nearestPart = 16, wayOff = 1.3;

// From the fraction quickPart on, tries take time. They are made only if the ring with them is not flat: if its area is
// less than leastFlat of a flat ring's. Around the end of a limb, at twice the limb's thickness, it has a third.
const double quickPart = 6, leastFlat = 0.8;

// Distance of the farthest one, over the radius of the ball that closes around the limb. Much thinner limbs have none.
const double farOfCut = 0.75;

// Between the powers of the distance with which an area grows: 1 along a limb, 2 on a plane.
const double betweenLineAndPlane = 1.5;

const double ringsOfRadius = 4; // that growth is measured over one of them, the outermost

const int binsOfThickness = 2; // cross-sections for each thickness of a limb

// Of a limb, at least: its end is round, so that the first ones are small.
const std::size_t leastSections = 2 * std::size_t(binsOfThickness);

// A limb has a joint where the line through the middles of its sections turns by this many degrees from one thickness
// to the next, and by less than restOfBend of that a thickness before and behind. A straight limb seems to turn by up
// to 9; a tail that is bent all along, by up to 20, but as much beside. An elbow shows two thirds of its bend. Within
// two thicknesses from the tip it must be footBend: the rim of a tube that is cut off seems to turn by 27, a foot
// by 43.
const double leastBend = 18, restOfBend = 0.7, footBend = 35;

// Where a straight limb with a hand or a foot bends: at this share of it, from its tip, along the middles of its
// sections (around a hand, the surface is longer). It is .577 for human arms and .54 for legs down to the sole (segment
// lengths of Drillis and Contini 1966). Each part has at least so many thicknesses: room for a handle, whose radius is
// two, and for half of the strip that bends. An arm has eight in all, a leg seven. A bend is a wrist or an ankle if it
// is before the middle of the part that turns: there they are at .43 and .31 of it (the same source).
const double elbowAt = 4. / 7, leastPart = 2.5, wristBefore = 0.5;

// A limb has a hand if its sections narrow by this on the way from its tip: less than a hand, which is 1.23 times as
// large around as its wrist (means of Gordon et al. 1989), and more than what an even limb that is cut off seems to do,
// 1.19.
const float handOverWrist = 1.2f;

// A vertex is pointed if the area within the usual radius is less than this share of a flat disc's. The corner of a
// cube has 0.75 of it, the tip of a cone with an angle of 80 degrees 0.64.
const double leastFlatEnd = 0.65;

// Least distance of its joint from the surface, over the radius: 0 at a sheet's corner, 0.25 in a limb half as thick.
const double leastInside = 0.125;

const double nearestEnd = 4; // an end is farther from the center than all within that fraction of the usual radius

std::optional<std::size_t> BendReach::rootOfLimb(std::size_t slot, double usual, double hair, int nearer) {
    wait();
    if (surface->nodeOf[slot] < 0)
        return {};
    const double cut = closingRadius(slot, usual), most = cut > 0 ? farOfCut * cut : usual / 4;
    // Near the end of a limb, nothing lies beyond the vertex. Then it may lie beyond another one, towards the body.
    std::vector<double> distances;
    const std::vector<Index> ball = nodesWithin({slot}, usual, &distances);
    const auto placeOf = [&](Index u) { return graph().position.col(u); };
    const auto isNearer = [&](Index u, Index v) {
        return (placeOf(u) - placeOf(ball.back())).squaredNorm() < (placeOf(v) - placeOf(ball.back())).squaredNorm();
    };
    const Pointed pointed{slot, usual, hair, nearer};
    const auto rootBeyond = [&](std::size_t before, double radius) {
        const bool isBeyond = whole({before}, radius, hair)->shareOf(slot) == 1;
        return isBeyond ? rootBefore(before, radius, pointed) : std::nullopt;
    };
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

/// Twice the thickness of a limb at its end, which a ball of the usual radius reaches around, world units; else 0.
double BendReach::radiusAtEnd(std::size_t slot, double usual) {
    std::vector<double> distances;
    const std::vector<Index> ball = nodesWithin({slot}, usual, &distances);
    const double unit = usual / surface->frame.scale, ring = unit / ringsOfRadius;
    double all = 0, outer = 0;
    for (std::size_t k = 0; k < ball.size(); ++k) {
        for (const Index v : graph().adjacency[ball[k]])
            if (double((graph().position.col(v) - graph().position.col(ball[k])).norm()) > ring)
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
    const std::vector<Index> ball = nodesWithin({slot}, at.usual);
    const double unit = at.usual / surface->frame.scale;
    if (areaOf<double>(ball) > leastFlatEnd * EIGEN_PI * unit * unit)
        return false;
    const auto joint = whole({slot}, at.usual, at.hair)->joint;
    const Eigen::Vector3d inside = surface->frame.ToFrame(joint.value_or(Eigen::Vector3d::Zero()));
    return joint && std::all_of(ball.begin(), ball.end(), [&](Index u) {
               return (graph().position.col(u).cast<double>() - inside).norm() > leastInside * unit;
           });
}

/// The end of a limb that is too short to have anything beyond a handle, if the vertex turns with it: the vertex around
/// that is farthest from the center of the body, or else one of its own part.
std::optional<std::size_t> BendReach::endOfShortLimb(const Pointed &at) {
    const auto farthest = [&](std::size_t from, double radius) {
        const std::vector<Index> ball = nodesWithin({from}, radius);
        return slotOf(*std::max_element(ball.begin(), ball.end(), [&](Index u, Index v) {
            return (graph().position.col(u) - middleOfAll).squaredNorm() <
                   (graph().position.col(v) - middleOfAll).squaredNorm();
        }));
    };
    const auto isEnd = [&](std::size_t slot) {
        if ((radiusAtEnd(slot, at.usual) < at.usual && !isRoundEnd(slot, at)) || !turnsOneLimb(slot, at))
            return false;
        return areaOf<float>(nodesWithin({slot}, radiusAt(slot, at.usual))) < largestLimb * areaOfAll;
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
    return turned->joint && turned->isOneLimb && turned->shareOf(at.slot) > turned->shareAtJoint();
}

/// The means of three values each: a section of a coarse surface may have a third less than the next.
static std::vector<float> smoothed(const std::vector<float> &area) {
    std::vector<float> mean = area;
    for (std::size_t k = 1; k + 1 < area.size(); ++k)
        mean[k] = (area[k - 1] + area[k] + area[k + 1]) / 3;
    return mean;
}

/// The last section of a limb. \param area of sections, from its tip on \param smooth the same, smoothed \param start
/// that of a vertex of the limb \param most largest area of a limb
static std::size_t lastSection(const std::vector<float> &area, const std::vector<float> &smooth, std::size_t start,
                               float most) {
    float before = std::accumulate(area.begin(), area.begin() + std::ptrdiff_t(start) + 1, 0.f);
    const auto growthAt = [&](std::size_t k) {
        return k > leastSections ? smooth[k] / smooth[k - binsOfThickness] : 0;
    };
    std::size_t end = start;
    std::optional<std::size_t> slowEnd; // before the fastest growth
    float growth = slowlyThicker;
    const auto isThick = [&](std::size_t k) { return k < area.size() && growthAt(k) > thicker; };
    while (end + 1 < area.size() && !isThick(end + 1) && before + area[end + 1] <= most) {
        before += area[++end];
        if (growthAt(end) > growth) {
            growth = growthAt(end);
            slowEnd = std::max(start, end - binsOfThickness);
        }
    }
    return slowEnd && !isThick(end + 1) ? *slowEnd : end;
}

/// Tells whether a limb narrows on the way from its tip to a section, as beyond a hand. \param smooth areas of sections
static bool narrows(const std::vector<float> &smooth, std::size_t upTo) {
    float most = 0;
    for (std::size_t k = 0; k < upTo; ++k) {
        most = std::max(most, smooth[k]);
        if (most > handOverWrist * smooth[k])
            return true;
    }
    return false;
}

/// The section at which a limb turns, for one of its sections: the next one that is bent, or the last one, or before it
/// an elbow. \param end the last section of the limb \param smooth areas of sections \param sum as of Sections
static std::size_t jointBeyond(std::size_t start, std::size_t end, const std::vector<float> &smooth,
                               const std::vector<Eigen::Vector4d> &sum) {
    const std::size_t away = binsOfThickness;
    const auto least = std::size_t(leastPart * binsOfThickness);
    std::vector<Eigen::Vector3d> middle;
    middle.reserve(sum.size());
    for (std::size_t k = 0; k < sum.size(); ++k)
        middle.emplace_back((sum[k - (k > 0)] + sum[k] + sum[std::min(k + 1, sum.size() - 1)]).hnormalized());
    const auto bendAt = [&](std::size_t k) {
        if (k < away)
            return 0.;
        const Eigen::Vector3d to = middle[k] - middle[k - away], from = middle[k + away] - middle[k];
        return std::atan2(to.cross(from).norm(), to.dot(from)) * 180 / double(EIGEN_PI);
    };
    const auto isBent = [&](std::size_t k) {
        const double own = bendAt(k), rest = restOfBend * own;
        return own >= std::max({k < 2 * away ? footBend : leastBend, bendAt(k - 1), bendAt(k + 1)}) &&
               bendAt(k - away) < rest && bendAt(k + away) < rest;
    };
    std::size_t before = 0, last = end;
    for (std::size_t k = away; k + 1 < end && k + 2 * away < sum.size() && last == end; ++k)
        if (isBent(k))
            (k <= start ? before : last) = k;
    std::vector<double> far(last + 1, 0); // along the middles
    for (std::size_t k = 1; k <= last; ++k)
        far[k] = far[k - 1] + (middle[k] - middle[k - 1]).norm();
    const auto elbow = std::size_t(std::lower_bound(far.begin(), far.end(), elbowAt * far.back()) - far.begin());
    const bool hasRoom =
        start < elbow && double(before) < wristBefore * double(elbow) && last - elbow >= least && end - last < least;
    return hasRoom && (before > 0 || narrows(smooth, elbow)) ? elbow : last;
}

/// The nodes of a part, nearest to one of them first, up to the last that lies beyond a handle; none if nothing does.
std::vector<Index> BendReach::upToTip(Index from, const BendExtent &grip) const {
    std::vector<char> isBeyond(std::size_t(graph().Size()), 0);
    for (const std::size_t i : grip.beyond)
        if (const Index u = surface->nodeOf[i]; u >= 0 && partOf[std::size_t(u)] == partOf[std::size_t(from)])
            isBeyond[std::size_t(u)] = 1;
    auto left = std::count(isBeyond.begin(), isBeyond.end(), 1);
    return left == 0 ? std::vector<Index>() : walk(from, [&](Index u, double) {
        left -= isBeyond[std::size_t(u)];
        return left > 0;
    });
}

/// Cross-sections of a limb, from its tip: each at one distance from it.
struct BendReach::Sections {
    std::vector<std::size_t> of; ///< of each node, if it was met: the number of its section
    std::vector<float> area;
    std::vector<Eigen::Vector4d> sum; ///< of area times place, and of area
};

/// The cross-sections from the tip up to that of a node, and on to the first that is too large for a limb.
/// \param length of each \param most area of a limb
BendReach::Sections BendReach::sectionsFrom(Index tip, Index upTo, double length, float most) const {
    const std::size_t none = std::numeric_limits<std::size_t>::max();
    Sections sections{std::vector<std::size_t>(std::size_t(graph().Size()), none), {}, {}};
    float met = 0;
    std::size_t last = none;
    walk(tip, [&](Index u, double far) {
        const std::size_t at = sections.of[std::size_t(u)] = std::size_t(far / length);
        const float area = surface->nodeArea[std::size_t(u)];
        sections.area.resize(std::max(sections.area.size(), at + 1), 0);
        sections.area[at] += area;
        sections.sum.resize(sections.area.size(), Eigen::Vector4d::Zero());
        sections.sum[at] += double(area) * graph().position.col(u).cast<double>().homogeneous();
        met += area;
        if (met > most && sections.of[std::size_t(upTo)] != none)
            last = std::min(last, at + 1); // the next one is for the mean
        return at <= last;
    });
    return sections;
}

/// The vertex of a limb at which it turns, for one of its vertices; none if nothing of the limb lies beyond, or more
/// than a limb would turn. \param pointed the vertex that is to turn
std::optional<std::size_t> BendReach::rootBefore(std::size_t slot, double radius, const Pointed &pointed) {
    const Index own = surface->nodeOf[slot];
    const auto grip = whole({slot}, radius, pointed.hair);
    const std::vector<Index> fromHere = grip->joint ? upToTip(own, *grip) : std::vector<Index>();
    if (fromHere.empty())
        return {};
    const double thickness = radius / surface->frame.scale / 2;
    const float most = largestLimb * partArea[std::size_t(partOf[std::size_t(own)])];
    const Sections sections = sectionsFrom(fromHere.back(), own, thickness / binsOfThickness, most);
    const std::size_t start = sections.of[std::size_t(own)];
    const std::vector<float> smooth = smoothed(sections.area);
    std::size_t root = lastSection(sections.area, smooth, start, most);
    if (pointed.nearer != wholeLimb) // the vertex itself may be nearer to the tip
        root = jointBeyond(std::min(start, sections.of[std::size_t(surface->nodeOf[pointed.slot])]), root, smooth,
                           sections.sum);
    // The joint of a handle is about the limb's thickness away from it. If that turns more than the limb, such as a
    // leg with the tail, another one is tried, towards the end.
    const std::size_t away = binsOfThickness * std::size_t(1 + std::max(0, pointed.nearer));
    const std::size_t first = root - std::min(root, away), low = std::min(start, first);
    std::vector<Index> nearest(first + 1 - low, -1); // of each section
    std::size_t left = nearest.size();
    const auto isMissing = [&](Index u, double = 0) {
        const std::size_t at = sections.of[std::size_t(u)];
        if (low <= at && at <= first && nearest[at - low] < 0) {
            nearest[at - low] = u;
            --left;
        }
        return left > 0;
    };
    if (std::all_of(fromHere.begin(), fromHere.end(), isMissing))
        walk(own, isMissing);
    for (auto there = nearest.rbegin(); there != nearest.rend(); ++there)
        if (*there >= 0 && // faces may be longer than a section
            radiusAt(slotOf(*there), pointed.usual) <= widest * radius && turnsOneLimb(slotOf(*there), pointed))
            return slotOf(*there);
    return turnsOneLimb(slot, pointed) ? std::optional(slot) : std::nullopt;
}
