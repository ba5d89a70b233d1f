// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <set>

using vcg::fcd::Index;

// Nodes of the coarse surface: an extent takes about 2 ms, and a limb of 10 % of the diagonal is seven cells thick.
const Index glanceNodes = 8000;

// Nodes of the surface that the coarse one is made of: a finger of a figure is about three cells thick.
const Index middleNodes = 60000;

// Radius of the part that keeps its nodes, over the diagonal: a figure's hand is so long.
const float nearPlace = 0.075f;

bool BendReach::begin() {
    if (surface || pending.valid())
        return isRead();
    const auto [arrays, metric] = source();
    pending = std::async(std::launch::async, [arrays = arrays, metric = metric] {
        auto read =
            std::make_unique<vcg::fcd::SurfaceGraph>(vcg::fcd::BuildSurfaceGraph(arrays->View(), nullptr, {}, metric));
        auto middle = coarseOf(*read, middleNodes);
        return Surfaces{std::move(read), std::move(middle), std::make_unique<VertexFaces>(arrays)};
    });
    return isRead();
}

bool BendReach::isRead() const {
    return surface || (pending.valid() && pending.wait_for(std::chrono::seconds(0)) == std::future_status::ready);
}

const VertexFaces *BendReach::faces() {
    if (isRead())
        wait();
    return facesOfVertices.get();
}

void BendReach::lookAt(std::size_t slot) {
    wait();
    const Index own = surface->nodeOf[slot];
    if (graph().Size() <= glanceNodes || own < 0)
        return;
    const Eigen::Vector3f at = graph().position.col(own);
    if (coarse && (at - detail.middle).norm() < detail.radius / 2)
        return;
    if (!coarse)
        detail.radius =
            nearPlace * (graph().position.rowwise().maxCoeff() - graph().position.rowwise().minCoeff()).norm();
    detail.middle = at;
    auto made = coarseOf(middle ? *middle : *surface, glanceNodes, detail);
    coarse.reset();
    if (!made) // a line, say
        return;
    coarse = std::make_unique<BendReach>(source);
    coarse->take(std::move(made));
    coarse->mostExtents = 4; // with two radii, and twins
}

BendReach &BendReach::glance() {
    wait();
    return coarse ? *coarse : *this;
}

/// The slots of nodes, ascending.
std::vector<std::size_t> BendReach::slotsOf(const std::vector<char> &isNodeIn) const {
    if (std::find(isNodeIn.begin(), isNodeIn.end(), 1) == isNodeIn.end())
        return {};
    const std::size_t all = surface->nodeOf.size();
    std::uint64_t eight = 0; // tests eight flags at a time: mostly, few are set
    std::vector<char> isIn(all + sizeof(eight), 0);
    std::size_t count = 0;
    for (std::size_t u = 0; u < isNodeIn.size(); ++u)
        for (std::uint32_t k = beginOf[u]; isNodeIn[u] && k < beginOf[u + 1]; ++k, ++count)
            isIn[slotBy[k]] = 1;
    std::vector<std::size_t> found;
    found.reserve(count);
    for (std::size_t i = 0; i < all; i += sizeof(eight)) {
        std::memcpy(&eight, &isIn[i], sizeof(eight));
        for (std::size_t k = i; eight != 0 && k < i + sizeof(eight); ++k)
            if (isIn[k])
                found.push_back(k);
    }
    return found;
}

/// One of the vertices of a node.
std::size_t BendReach::slotOf(Index node) const { return slotBy[beginOf[std::size_t(node)]]; }

/// All nodes connected with one, nearest first, as long as goesOn(node, distance).
std::vector<Index> BendReach::walk(Index from, const std::function<bool(Index, double)> &goesOn) const {
    const double all = std::numeric_limits<double>::infinity();
    return vcg::fcd::NodesWithin(graph(), {from}, all, vcg::fcd::Ways::Surface, nullptr, goesOn);
}

/// Flags of nodes.
std::vector<char> BendReach::isAmong(const std::vector<Index> &nodes) const {
    std::vector<char> isNodeIn(std::size_t(graph().Size()), 0);
    for (const Index u : nodes)
        isNodeIn[std::size_t(u)] = 1;
    return isNodeIn;
}

/// Flags of nodes with one of the vertices.
std::vector<char> BendReach::nodesOf(const std::vector<char> &isIn) const {
    std::vector<char> isNodeIn(std::size_t(graph().Size()), 0);
    for (std::size_t i = 0; i < isIn.size(); ++i)
        if (isIn[i] && surface->nodeOf[i] >= 0)
            isNodeIn[std::size_t(surface->nodeOf[i])] = 1;
    return isNodeIn;
}

std::vector<Index> BendReach::nodesWithin(const std::vector<std::size_t> &vertices, double radius,
                                          std::vector<double> *distances) {
    Ball sought{{}, radius / surface->frame.scale, {}, {}};
    for (const std::size_t slot : vertices)
        if (surface->nodeOf[slot] >= 0)
            sought.middle.push_back(surface->nodeOf[slot]);
    auto found = std::find_if(balls.begin(), balls.end(), [&](const Ball &each) {
        return each.radius >= sought.radius && each.middle == sought.middle;
    });
    if (found == balls.end()) {
        sought.nodes =
            vcg::fcd::NodesWithin(graph(), sought.middle, sought.radius, vcg::fcd::Ways::Surface, &sought.distances);
        if (balls.size() >= mostBalls)
            balls.pop_back();
        found = balls.insert(balls.end(), std::move(sought));
    }
    balls.splice(balls.begin(), balls, found);
    const auto &far = found->distances; // a smaller ball has the first nodes of a larger one
    const auto end = std::upper_bound(far.begin(), far.end(), radius / surface->frame.scale) - far.begin();
    if (distances)
        distances->assign(far.begin(), far.begin() + end);
    return {found->nodes.begin(), found->nodes.begin() + end};
}

const std::vector<std::size_t> &BendReach::of(const std::vector<std::size_t> &vertices, double radius) {
    if (from == vertices && within == radius)
        return reached;
    wait();
    reached = slotsOf(isAmong(nodesWithin(vertices, radius)));
    from = vertices;
    within = radius;
    return reached;
}

/// Gives another label to a node, and to all nodes connected with it by nodes of the same label. \return these
static std::vector<Index> relabel(const vcg::fcd::Graph &graph, Index begin, int to, std::vector<int> &label) {
    const int before = label[std::size_t(begin)];
    label[std::size_t(begin)] = to;
    std::vector<Index> all, next = {begin};
    while (!next.empty()) {
        all.push_back(next.back());
        next.pop_back();
        for (const Index v : graph.adjacency[all.back()])
            if (label[std::size_t(v)] == before) {
                label[std::size_t(v)] = to;
                next.push_back(v);
            }
    }
    return all;
}

// Largest area of a tip, over that of the largest piece: a limb is much smaller than its body, halves of a bar are not.
const float largestTip = 0.5;

std::vector<std::size_t> BendReach::piece(std::size_t slot, const std::vector<char> &isIn) {
    wait();
    const Index first = surface->nodeOf[slot];
    if (first < 0)
        return {slot};
    const std::vector<char> isNodeIn = nodesOf(isIn);
    const int met = 2;
    std::vector<int> label(isNodeIn.begin(), isNodeIn.end());
    relabel(graph(), first, met, label);
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < isIn.size(); ++i)
        if (isIn[i] && surface->nodeOf[i] >= 0 && label[std::size_t(surface->nodeOf[i])] == met)
            all.push_back(i);
    return all;
}

void BendReach::wait() {
    begin();
    if (surface)
        return;
    Surfaces read = pending.get();
    take(std::move(read.fine));
    facesOfVertices = std::move(read.faces);
    middle = std::move(read.middle);
}

void BendReach::take(std::unique_ptr<vcg::fcd::SurfaceGraph> read) {
    surface = std::move(read);
    const int unknown = -1;
    beginOf.assign(std::size_t(graph().Size()) + 1, 0);
    for (const Index u : surface->nodeOf)
        if (u >= 0)
            ++beginOf[std::size_t(u) + 1];
    std::partial_sum(beginOf.begin(), beginOf.end(), beginOf.begin());
    slotBy.resize(beginOf.back());
    std::vector<std::uint32_t> next(beginOf.begin(), beginOf.end() - 1);
    for (std::size_t i = 0; i < surface->nodeOf.size(); ++i)
        if (surface->nodeOf[i] >= 0)
            slotBy[next[std::size_t(surface->nodeOf[i])]++] = std::uint32_t(i);
    partOf.assign(std::size_t(graph().Size()), unknown);
    partArea.clear();
    for (Index u = 0; u < graph().Size(); ++u)
        if (partOf[std::size_t(u)] == unknown)
            partArea.push_back(areaOf<float>(relabel(graph(), u, int(partArea.size()), partOf)));
    areaOfAll = std::accumulate(partArea.begin(), partArea.end(), 0.f);
    middleOfAll.setZero();
    for (Index u = 0; u < graph().Size(); ++u)
        middleOfAll += surface->nodeArea[std::size_t(u)] * graph().position.col(u) / areaOfAll;
}

std::size_t BendReach::carrierOf(std::size_t slot, double hair) {
    wait();
    const Index own = surface->nodeOf[slot];
    if (own < 0)
        return slot;
    const auto part = [&](Index u) { return std::size_t(partOf[std::size_t(u)]); };
    const double most = hair / surface->frame.scale;
    double least = most;
    Index nearest = -1;
    for (Index u = 0; u < graph().Size(); ++u) {
        const double distance = double((graph().position.col(u) - graph().position.col(own)).norm());
        if (distance > 2 * most && part(u) == part(own))
            return slot;
        if (distance < least && partArea[part(own)] < largestTip * partArea[part(u)]) {
            least = distance;
            nearest = u;
        }
    }
    return nearest < 0 ? slot : slotOf(nearest);
}

std::vector<std::size_t> BendReach::looseAmong(const std::vector<char> &isIn, double hair) {
    wait();
    return slotsOf(looseNodes(nodesOf(isIn), hair));
}

/// looseAmong() for nodes. \param isNodeIn flags of the set
std::vector<char> BendReach::looseNodes(const std::vector<char> &isNodeIn, double hair) const {
    const auto cell = float(hair / surface->frame.scale);
    using Cell = std::array<int, 3>;
    const auto cellOf = [&](Index u) {
        const Eigen::Vector3i at = (graph().position.col(u) / cell).array().floor().cast<int>();
        return Cell{at[0], at[1], at[2]};
    };
    std::vector<char> all(isNodeIn.size(), 0);
    Eigen::AlignedBox3f box;
    std::set<Cell> met, near; // cells of the set; the same and their neighbours
    Cell last{};
    float areaIn = 0;
    std::vector<char> isConnected(partArea.size(), 0);
    for (Index u = 0; u < graph().Size(); ++u) {
        if (!isNodeIn[std::size_t(u)])
            continue;
        isConnected[std::size_t(partOf[std::size_t(u)])] = 1;
        areaIn += surface->nodeArea[std::size_t(u)];
        box.extend(Eigen::Vector3f(graph().position.col(u)));
        if (!met.empty() && cellOf(u) == last)
            continue;
        last = cellOf(u);
        if (!met.insert(last).second)
            continue;
        for (int i = 0; i < 27; ++i)
            near.insert({last[0] + i % 3 - 1, last[1] + i / 3 % 3 - 1, last[2] + i / 9 - 1});
    }
    if (near.empty() || partArea.size() == 1)
        return all;
    box = {box.min() - Eigen::Vector3f::Constant(cell), box.max() + Eigen::Vector3f::Constant(cell)};
    std::vector<char> isWithin(partArea.size(), 1), isNear(partArea.size(), 0);
    for (Index u = 0; u < graph().Size(); ++u) {
        const auto part = std::size_t(partOf[std::size_t(u)]);
        if (isConnected[part] || !isWithin[part])
            continue;
        isWithin[part] = box.contains(Eigen::Vector3f(graph().position.col(u)));
        isNear[part] = isNear[part] || (isWithin[part] && near.count(cellOf(u)) > 0);
    }
    for (std::size_t u = 0; u < all.size(); ++u) {
        const auto part = std::size_t(partOf[u]);
        all[u] = !isConnected[part] && isWithin[part] && isNear[part] && partArea[part] < largestTip * areaIn;
    }
    return all;
}

bool BendReach::Pieces::isTip(std::size_t piece) const { return area[piece] < largestTip * area[largest]; }

/// The pieces beside a set of nodes.
BendReach::Pieces BendReach::piecesBeside(const std::vector<char> &isIn) const {
    const int unknown = -1, cut = -2;
    Pieces pieces;
    pieces.of.assign(isIn.size(), unknown);
    for (std::size_t u = 0; u < isIn.size(); ++u)
        if (isIn[u])
            pieces.of[u] = cut;
    for (std::size_t u = 0; u < isIn.size(); ++u) {
        if (!isIn[u])
            continue;
        for (const Index first : graph().adjacency[Index(u)]) {
            if (pieces.of[std::size_t(first)] != unknown)
                continue;
            const int which = int(pieces.area.size());
            pieces.area.push_back(areaOf<float>(relabel(graph(), first, which, pieces.of)));
        }
    }
    pieces.largest = std::size_t(std::max_element(pieces.area.begin(), pieces.area.end()) - pieces.area.begin());
    return pieces;
}

std::vector<std::size_t> BendReach::tips(const std::vector<char> &isIn) {
    wait();
    return slotsOf(tipNodes(nodesOf(isIn)));
}

/// tips() for nodes.
std::vector<char> BendReach::tipNodes(std::vector<char> isNodeIn) const {
    const Pieces pieces = piecesBeside(isNodeIn);
    for (std::size_t u = 0; u < isNodeIn.size(); ++u)
        isNodeIn[u] = pieces.of[u] >= 0 && pieces.isTip(std::size_t(pieces.of[u]));
    return isNodeIn;
}
