// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_H
#define VCG_FCD_GRAPH_H

#include "progress.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace vcg {
namespace fcd {

/// Index of a vertex, node or patch; -1 means none.
using Index = std::int32_t;

/// What went wrong and what to do about it, in words for the user.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

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

/// Undirected graph with a position per node. The connectivity of a mesh and the deformation graph over it are this
/// same type at two sizes, so nothing that works on it can depend on faces.
struct Graph {
    Csr adjacency;             ///< neighbours of each node, ascending, without the node itself
    Eigen::Matrix3Xf position; ///< 3 x n

    Index Size() const { return adjacency.Size(); }
};

/// The items of each group, ascending: the inverse of \p groupOf (n values in [0, groups), or -1 for none).
inline Csr GroupMembers(const std::vector<Index> &groupOf, Index groups) {
    Csr members;
    members.begin.assign(std::size_t(groups) + 1, 0);
    for (Index g : groupOf)
        if (g >= 0)
            ++members.begin[g + 1];
    for (Index g = 0; g < groups; ++g)
        members.begin[g + 1] += members.begin[g];
    members.item.resize(members.begin.back());
    std::vector<std::uint32_t> end(members.begin.begin(), members.begin.end() - 1);
    for (std::size_t i = 0; i < groupOf.size(); ++i)
        if (groupOf[i] >= 0)
            members.item[end[groupOf[i]]++] = Index(i);
    return members;
}

/// The dual graph of a partition: groups that touch, and over how many edges they do.
struct Quotient {
    Csr adjacency;                ///< groups joined by at least one edge, ascending
    std::vector<Index> crossings; ///< for each adjacency item, the number of edges between the two groups
};

/// Builds the dual graph of the groups that \p groupOf (n values in [0, groups)) makes of \p graph's nodes.
inline Quotient QuotientGraph(const Csr &graph, const std::vector<Index> &groupOf, Index groups,
                              const Progress &progress = {}, const char *stage = "Building the graph") {
    struct Crossing {
        std::uint64_t key; // the two groups, the smaller one in the upper half
        Index count;
        bool operator<(const Crossing &o) const { return key < o.key; }
    };
    auto merge = [](std::vector<Crossing> &list) {
        std::sort(list.begin(), list.end());
        std::size_t kept = 0;
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (kept && list[kept - 1].key == list[i].key)
                list[kept - 1].count += list[i].count;
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
                if (a < b) // each edge is seen from both ends, and counted at one
                    list.push_back({std::uint64_t(a) << 32 | std::uint32_t(b), 1});
            }
        merge(list);
        found[first / grain] = std::move(list);
    });
    std::vector<Crossing> all;
    for (std::vector<Crossing> &list : found)
        all.insert(all.end(), list.begin(), list.end());
    merge(all);

    Quotient dual;
    dual.adjacency.begin.assign(std::size_t(groups) + 1, 0);
    for (const Crossing &c : all) {
        ++dual.adjacency.begin[(c.key >> 32) + 1];
        ++dual.adjacency.begin[std::uint32_t(c.key) + 1];
    }
    for (Index g = 0; g < groups; ++g)
        dual.adjacency.begin[g + 1] += dual.adjacency.begin[g];
    dual.adjacency.item.resize(2 * all.size());
    dual.crossings.resize(2 * all.size());
    std::vector<std::uint32_t> end(dual.adjacency.begin.begin(), dual.adjacency.begin.end() - 1);
    // Ascending keys: the smaller neighbours of every group come first, then its larger ones, both ascending.
    for (const Crossing &c : all) {
        const std::uint32_t b = std::uint32_t(c.key), at = end[b]++;
        dual.adjacency.item[at] = Index(c.key >> 32);
        dual.crossings[at] = c.count;
    }
    for (const Crossing &c : all) {
        const std::uint32_t a = std::uint32_t(c.key >> 32), at = end[a]++;
        dual.adjacency.item[at] = Index(std::uint32_t(c.key));
        dual.crossings[at] = c.count;
    }
    return dual;
}

/// The connected component of each node, numbered in the order of their first nodes. \return the number of components
inline Index ConnectedComponents(const Csr &graph, std::vector<Index> &componentOf) {
    componentOf.assign(graph.Size(), -1);
    Index components = 0;
    std::vector<Index> stack;
    for (Index seed = 0; seed < graph.Size(); ++seed) {
        if (componentOf[seed] >= 0)
            continue;
        componentOf[seed] = components;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const Index u = stack.back();
            stack.pop_back();
            for (Index v : graph[u])
                if (componentOf[v] < 0) {
                    componentOf[v] = components;
                    stack.push_back(v);
                }
        }
        ++components;
    }
    return components;
}

} // namespace fcd
} // namespace vcg

#endif
