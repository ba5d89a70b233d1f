// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_H
#define VCG_FCD_GRAPH_H

#include <vcg_ext/base/error.h>
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/progress.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Index of a vertex, node or patch; -1 means none.
using Index = std::int32_t;

/// A list of lists: row i holds item[begin[i]] ... item[begin[i + 1] - 1].
struct Csr {
    std::vector<std::uint32_t> begin{0}; ///< n + 1 offsets, begin[0] == 0
    std::vector<Index> item;             ///< begin[n] items

    struct Row {
        const Index *first, *last;
        const Index *begin() const { return first; }
        const Index *end() const { return last; }
        std::size_t size() const { return std::size_t(last - first); }
        Index operator[](std::size_t i) const { return first[i]; }
    };

    Index Size() const { return Index(begin.size()) - 1; }
    Row operator[](Index i) const { return {item.data() + begin[i], item.data() + begin[i + 1]}; }
};

/// An undirected graph with a position per node: the vertices of a mesh, or the deformation graph over it.
struct Graph {
    Csr adjacency;             ///< neighbours of each node, ascending, without the node itself
    Eigen::Matrix3Xf position; ///< 3 x n, frame units
    bool isCloud = false;      ///< neighbours are the nearest points, not corners of triangles

    Index Size() const { return adjacency.Size(); }
};

/// Calls collect(u, list) for u in [0, n), in parallel. \return what it added to the lists, in the order of u
template <class Item = Index, class Collect>
std::vector<Item> CollectInOrder(const Progress &progress, const char *stage, std::size_t n, const Collect &collect) {
    const std::size_t grain = 1 << 16;
    std::vector<std::vector<Item>> lists((n + grain - 1) / grain);
    ParallelFor(progress, stage, n, grain, [&](std::size_t first, std::size_t last) {
        std::vector<Item> list;
        for (std::size_t u = first; u < last; ++u)
            collect(u, list);
        lists[first / grain] = std::move(list);
    });
    return Together(lists);
}

/// The numbers u in [0, n) with is(u), ascending; in parallel.
template <class Item = Index, class Is>
std::vector<Item> NumbersThat(const Progress &progress, const char *stage, std::size_t n, const Is &is) {
    return CollectInOrder<Item>(progress, stage, n, [&](std::size_t u, std::vector<Item> &found) {
        if (is(u))
            found.push_back(Item(u));
    });
}

/// The dual graph of groups of nodes: which groups touch, and the sum of a value over the edges between two groups.
template <class Value>
struct Quotient {
    Csr adjacency;            ///< groups joined by at least one edge, ascending
    std::vector<Value> value; ///< of each adjacency item; the same in both directions
};

/// The dual graph of groups of nodes of \p graph.
/// \param groupOf n values in [0, groups), or -1 for none
/// \param valueOf valueOf(u, v, value): sets the value (zero before) of the edge from node u to node v, whose group has
///        the larger number; returns false if the edge does not count
template <class Value, class ValueOf>
Quotient<Value> QuotientGraph(const Csr &graph, const std::vector<Index> &groupOf, Index groups, const ValueOf &valueOf,
                              const Progress &progress = {}, const char *stage = "Building the graph") {
    struct Crossing {
        std::uint64_t key; // the two groups, the smaller one in the upper half
        Value value;
        bool operator<(const Crossing &o) const { return key < o.key; }
    };
    auto merge = [](std::vector<Crossing> &list) {
        std::stable_sort(list.begin(), list.end());
        std::size_t kept = 0;
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (kept && list[kept - 1].key == list[i].key)
                list[kept - 1].value += list[i].value;
            else
                list[kept++] = list[i];
        }
        list.resize(kept);
    };
    const std::size_t grain = 1 << 14, chunks = (groupOf.size() + grain - 1) / grain;
    std::vector<std::vector<Crossing>> found(chunks);
    ParallelFor(progress, stage, groupOf.size(), grain, [&](std::size_t first, std::size_t last) {
        std::vector<Crossing> list;
        for (std::size_t u = first; u < last; ++u)
            for (Index v : graph[Index(u)]) {
                const Index a = groupOf[u], b = groupOf[v];
                if (a >= 0 && a < b) { // each edge comes twice, and counts once
                    Crossing crossing{std::uint64_t(a) << 32 | std::uint32_t(b), Value()};
                    if (valueOf(Index(u), v, crossing.value))
                        list.push_back(crossing);
                }
            }
        merge(list);
        found[first / grain] = std::move(list);
    });
    std::vector<Crossing> all = Together(found);
    merge(all);

    Quotient<Value> dual;
    dual.adjacency.begin.assign(std::size_t(groups) + 1, 0);
    for (const Crossing &c : all) {
        ++dual.adjacency.begin[(c.key >> 32) + 1];
        ++dual.adjacency.begin[std::uint32_t(c.key) + 1];
    }
    for (Index g = 0; g < groups; ++g)
        dual.adjacency.begin[g + 1] += dual.adjacency.begin[g];
    dual.adjacency.item.resize(2 * all.size());
    dual.value.resize(2 * all.size());
    std::vector<std::uint32_t> end(dual.adjacency.begin.begin(), dual.adjacency.begin.end() - 1);
    // Ascending keys: the smaller neighbours of every group come first, then its larger ones, both ascending.
    for (const Crossing &c : all) {
        const std::uint32_t b = std::uint32_t(c.key), at = end[b]++;
        dual.adjacency.item[at] = Index(c.key >> 32);
        dual.value[at] = c.value;
    }
    for (const Crossing &c : all) {
        const std::uint32_t a = std::uint32_t(c.key >> 32), at = end[a]++;
        dual.adjacency.item[at] = Index(std::uint32_t(c.key));
        dual.value[at] = c.value;
    }
    return dual;
}

/// A partition of the numbers 0 to n - 1 (union-find). The root of a set is its smallest number.
class DisjointSets {
  public:
    explicit DisjointSets(Index n) : parent(std::size_t(n)) { std::iota(parent.begin(), parent.end(), 0); }
    Index Root(Index u) {
        while (parent[u] != u)
            u = parent[u] = parent[parent[u]];
        return u;
    }
    /// \return whether they were in different sets
    bool Join(Index u, Index v) {
        const Index a = Root(u), b = Root(v);
        parent[std::max(a, b)] = std::min(a, b);
        return a != b;
    }
    /// The root of each number. Call it last.
    std::vector<Index> TakeRoots() {
        for (Index &each : parent) // ascending: the parent's root is known
            each = parent[each];
        return std::move(parent);
    }

  private:
    std::vector<Index> parent; // of each, a smaller number of its set, or itself
};

/// The connected components of the nodes with takesPart(node), by the edges with joins(u, v), numbered in the order of
/// their first nodes. \param componentOf out: of each node, -1 if it does not take part
/// \return the number of components
template <class TakesPart, class Joins>
Index ConnectedComponents(const Csr &graph, const TakesPart &takesPart, const Joins &joins,
                          std::vector<Index> &componentOf, const Progress &progress, const char *stage) {
    const Index n = graph.Size();
    DisjointSets joined(n);
    const std::size_t grain = 1 << 14;
    std::vector<std::vector<std::pair<Index, Index>>> between((std::size_t(n) + grain - 1) / grain);
    ParallelFor(progress, stage, n, grain, [&](std::size_t first, std::size_t last) {
        for (Index u = Index(first); u < Index(last); ++u) {
            if (!takesPart(u))
                continue;
            for (Index v : graph[u])
                if (v >= u)
                    break; // neighbours are ascending
                else if (!takesPart(v) || !joins(u, v))
                    continue;
                else if (v >= Index(first))
                    joined.Join(u, v);
                else
                    between[first / grain].emplace_back(u, v);
        }
    });
    for (const auto &edges : between)
        for (const auto &e : edges)
            joined.Join(e.first, e.second);
    componentOf = joined.TakeRoots();
    Index components = 0;
    for (Index u = 0; u < n; ++u) // ascending: the root's number is known
        componentOf[u] = !takesPart(u) ? -1 : componentOf[u] == u ? components++ : componentOf[componentOf[u]];
    return components;
}

/// The same for all nodes and edges.
inline Index ConnectedComponents(const Csr &graph, std::vector<Index> &componentOf, const Progress &progress = {},
                                 const char *stage = "Building the graph") {
    return ConnectedComponents(
        graph, [](Index) { return true; }, [](Index, Index) { return true; }, componentOf, progress, stage);
}

} // namespace vcg::fcd

#endif
