// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <limits>

// Where a limb begins.

namespace {

// Times as much around as where it is pulled: a limb gets thicker by less than that from one joint to the next, and
// where it meets what it hangs on, the whole of that is met at once.
const float thicker = 1.75;

// Of a limb's area, with what it hangs on: as BendReach has it for tips, which are at most half as large as the rest.
const float largestLimb = 1.f / 3;

const int binsOfThickness = 2; // so many cross-sections of a limb, each as long as that part of its thickness

} // namespace

std::optional<std::size_t> BendReach::rootOfLimb(std::size_t slot, double usual, double hair) {
    wait();
    const vcg::fcd::Index own = surface->nodeOf[slot];
    if (own < 0)
        return {};
    const double radius = radiusAt(slot, usual);
    const auto grip = whole({slot}, radius, hair);
    if (!grip->joint)
        return {};
    const vcg::fcd::Graph &graph = surface->graph;
    const double all = std::numeric_limits<double>::infinity();
    std::vector<char> isBeyond(std::size_t(graph.Size()), 0);
    for (const std::size_t i : grip->beyond)
        if (surface->nodeOf[i] >= 0)
            isBeyond[std::size_t(surface->nodeOf[i])] = 1;
    const std::vector<vcg::fcd::Index> fromHere = vcg::fcd::NodesWithin(graph, {own}, all);
    const auto tip = std::find_if(fromHere.rbegin(), fromHere.rend(),
                                  [&](vcg::fcd::Index u) { return isBeyond[std::size_t(u)] != 0; });
    if (tip == fromHere.rend())
        return {};
    // Cross-sections are what is equally far from the tip.
    std::vector<double> distances;
    const std::vector<vcg::fcd::Index> fromTip = vcg::fcd::NodesWithin(graph, {*tip}, all, &distances);
    const double bin = radius / surface->frame.scale / (2 * binsOfThickness); // the radius is twice the thickness
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
    while (root + 1 < area.size() && area[root + 1] <= thicker * area[start] &&
           before + area[root + 1] <= largestLimb * total)
        before += area[++root];
    // A handle on a limb turns about a joint that is about its thickness away.
    const std::size_t at = root > start + binsOfThickness ? root - binsOfThickness : start;
    if (at == start)
        return slot;
    const auto there = std::find_if(fromHere.begin(), fromHere.end(),
                                    [&](vcg::fcd::Index u) { return section[std::size_t(u)] == at; });
    const auto found = std::find(surface->nodeOf.begin(), surface->nodeOf.end(), *there);
    return std::size_t(found - surface->nodeOf.begin());
}
