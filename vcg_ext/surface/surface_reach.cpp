// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/surface_reach.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

/// The distance of v from a source, in the plane of the triangle. The source lies on the other side of the edge u w, \p
/// du from u and \p dw from w. Infinity if the straight path does not cross the edge.
double AcrossEdge(const Eigen::Vector3d &u, const Eigen::Vector3d &w, const Eigen::Vector3d &v, double du, double dw) {
    const double unknown = std::numeric_limits<double>::infinity(), square = (w - u).squaredNorm();
    // All of these are times the length of the edge.
    const double along = (du * du - dw * dw + square) / 2, behindSquare = du * du * square - along * along;
    if (!(square > 0 && behindSquare >= 0))
        return unknown;
    const double x = (v - u).dot(w - u), behind = std::sqrt(behindSquare);
    const double y = std::sqrt(std::max(0.0, (v - u).squaredNorm() * square - x * x));
    const double crossing = along * y + x * behind; // times behind + y
    if (!(crossing >= 0 && crossing <= square * (behind + y)))
        return unknown;
    return std::sqrt(((x - along) * (x - along) + (y + behind) * (y + behind)) / square);
}

/// Nodes with their distances: a heap, with the nearest one first; of equally near ones, that of the smaller index. A
/// search with it takes a sixth less time than with std::priority_queue, where a node waits once for each shorter path.
class NearestFirst {
  public:
    using Item = std::pair<double, Index>;
    explicit NearestFirst(Index nodes) : placeOf(std::size_t(nodes), none) {}

    bool IsEmpty() const { return heap.empty(); }

    /// Adds a node, or brings it nearer.
    void Set(Index u, double distance) {
        std::size_t place = placeOf[u];
        if (place == none) {
            place = heap.size();
            heap.emplace_back();
        }
        for (const Item item(distance, u); place > 0 && item < heap[(place - 1) / 2]; place = (place - 1) / 2)
            Put(heap[(place - 1) / 2], place);
        Put({distance, u}, place);
    }

    Item Take() {
        const Item first = heap.front(), last = heap.back();
        heap.pop_back();
        std::size_t place = 0;
        for (std::size_t next = 1; next < heap.size(); next = 2 * place + 1) {
            next += next + 1 < heap.size() && heap[next + 1] < heap[next];
            if (!(heap[next] < last))
                break;
            Put(heap[next], place);
            place = next;
        }
        if (!heap.empty())
            Put(last, place);
        return first;
    }

  private:
    void Put(const Item &item, std::size_t place) {
        heap[place] = item;
        placeOf[item.second] = place;
    }

    static constexpr std::size_t none = std::size_t(-1);
    std::vector<Item> heap;
    std::vector<std::size_t> placeOf; ///< of each node
};

} // namespace

std::vector<Index> NodesWithin(const Graph &graph, const std::vector<Index> &seeds, double radius, Ways ways,
                               std::vector<double> *distances, const std::function<bool(Index, double)> &goesOn) {
    NearestFirst queue(graph.Size());
    const double unknown = std::numeric_limits<double>::infinity();
    std::vector<double> distanceOf(std::size_t(graph.Size()), unknown);
    std::vector<char> isDone(std::size_t(graph.Size()), 0);
    std::vector<Index> found, doneBeside(distanceOf.size(), -1); // doneBeside[w] == u: w is done, and beside u
    if (distances)
        distances->clear();
    for (const Index seed : seeds) {
        if (distanceOf[seed] == unknown)
            queue.Set(seed, 0);
        distanceOf[seed] = 0;
    }
    const auto placeOf = [&](Index u) { return Eigen::Vector3d(graph.position.col(u).cast<double>()); };
    const auto acrossBeside = [&](Index u, Index v) { // the way to v across triangles with u, from nodes that are done
        double least = unknown;
        for (const Index w : graph.adjacency[v])
            if (doneBeside[std::size_t(w)] == u)
                least = std::min(least, AcrossEdge(placeOf(u), placeOf(w), placeOf(v), distanceOf[u], distanceOf[w]));
        return least;
    };
    while (!queue.IsEmpty()) {
        const auto [d, u] = queue.Take();
        found.push_back(u);
        if (distances)
            distances->push_back(d);
        if (goesOn && !goesOn(u, d))
            break;
        isDone[std::size_t(u)] = 1;
        for (const Index w : graph.adjacency[u])
            if (isDone[std::size_t(w)])
                doneBeside[std::size_t(w)] = u;
        for (Index v : graph.adjacency[u]) {
            if (isDone[std::size_t(v)])
                continue;
            double there = d + double((graph.position.col(v) - graph.position.col(u)).norm());
            if (ways == Ways::Surface)
                there = std::min(there, std::max(d, acrossBeside(u, v)));
            if (there <= radius && there < distanceOf[v]) {
                distanceOf[v] = there;
                queue.Set(v, there);
            }
        }
    }
    return found;
}

} // namespace vcg::fcd
