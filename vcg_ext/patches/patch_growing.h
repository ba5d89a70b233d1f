// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_GROWING_H
#define VCG_FCD_PATCH_GROWING_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

namespace vcg::fcd::detail {

/// The node that a patch grows from, and the position that distances are measured to.
struct Center {
    Index node;
    Eigen::Vector3f position;
};

/// Grows patches from centres along edges, over nodes of tag 1 (without tags: all), nearest node first by straight
/// distance from the centre. Keeps its buffers between calls.
class PatchGrower {
  public:
    PatchGrower(const Graph &graph, const std::vector<Index> &tag) : graph(graph), tag(tag) {}

    std::vector<Index> patchOf; ///< the result; -1 for nodes of other tags

    bool TakesPart(Index u) const { return tag.empty() || tag[u] == 1; }

    /// Assigns every node that takes part to a patch. In a component without a centre, a node is added to \p center.
    /// \param step width of a distance class; within a class, nodes are assigned in any order
    void Grow(std::vector<Center> &center, double step, const Progress &progress = {}) {
        AssignLarge(patchOf, graph.Size(), Index(-1));
        Start(step, progress);
        for (Index c = 0; c < Index(center.size()); ++c)
            Offer(center[c].node, c, 0, 0);
        Finish(center, progress);
    }

    /// The same if patchOf is set for some nodes, which connect to the centre of their patch, and -1 for others.
    /// \param front at least all set nodes that have a neighbour which is not set
    void GrowFrom(const std::vector<Index> &front, std::vector<Center> &center, double step, const Progress &progress) {
        Start(step, progress);
        for (Index c = 0; c < Index(center.size()); ++c)
            if (patchOf[center[c].node] < 0)
                Offer(center[c].node, c, 0, 0);
        for (Index u : front)
            OfferNeighbours(u, patchOf[u], center[patchOf[u]].position, 0);
        Finish(center, progress);
    }

  private:
    static constexpr const char *stage = "Growing patches";

    struct Offered {
        Index node, patch;
    };
    struct State { // what an offer reads and writes, together in memory
        float x, y, z;
        float best; ///< squared distance of the best offer; negative once assigned
    };

    void Start(double step, const Progress &progress) {
        progress(0, stage);
        inverseStep = float(std::min(1 / step, 1e30)); // finite: 0 times it is 0
        bucket.resize(4096);
        assigned = 0;
        if (!state)
            state = LargeArray<State>(graph.Size());
        ParallelForEach(progress.threads, graph.Size(), 1 << 16, [&](std::size_t u) {
            state[u] = {graph.position(0, u), graph.position(1, u), graph.position(2, u),
                        patchOf[u] < 0 && TakesPart(Index(u)) ? std::numeric_limits<float>::infinity() : -1};
        });
        progress(0, stage);
    }

    void Offer(Index node, Index patch, float d2, std::size_t current) {
        state[node].best = d2;
        const float b = std::min(std::sqrt(d2) * inverseStep, float(bucket.size() - 1));
        const std::size_t at = std::max(std::size_t(b), current);
        bucket[at].push_back({node, patch});
        last = std::max(last, at);
    }

    void OfferNeighbours(Index u, Index patch, const Eigen::Vector3f &c, std::size_t current) {
        for (Index v : graph.adjacency[u]) {
            const State &s = state[v];
            if (s.best < 0)
                continue;
            const float d2 = (Eigen::Vector3f(s.x, s.y, s.z) - c).squaredNorm();
            if (d2 < s.best)
                Offer(v, patch, d2, current);
        }
    }

    void Empty(const std::vector<Center> &center, const Progress &progress) {
        for (std::size_t b = 0; b <= last; ++b) {
            // A bucket may grow while it is emptied.
            for (std::size_t i = 0; i < bucket[b].size(); ++i) {
                // Offers that follow each other are far apart in memory: begin to read what the next ones need.
                const std::vector<Offered> &offers = bucket[b];
                if (i + 16 < offers.size())
                    Prefetch(&graph.adjacency.begin[offers[i + 16].node]);
                if (i + 8 < offers.size())
                    Prefetch(graph.adjacency[offers[i + 8].node].first);
                if (i + 4 < offers.size())
                    for (Index v : graph.adjacency[offers[i + 4].node])
                        Prefetch(&state[v]);
                const Offered o = bucket[b][i];
                if (state[o.node].best < 0)
                    continue;
                state[o.node].best = -1;
                patchOf[o.node] = o.patch;
                if ((++assigned & 0xffff) == 0)
                    progress(double(assigned) / graph.Size(), stage);
                OfferNeighbours(o.node, o.patch, center[o.patch].position, b);
            }
            bucket[b].clear();
        }
        last = 0;
    }

    void Finish(std::vector<Center> &center, const Progress &progress) {
        Empty(center, progress);
        for (Index u = 0; u < graph.Size(); ++u)
            if (patchOf[u] < 0 && TakesPart(u)) {
                center.push_back({u, graph.position.col(u)});
                Offer(u, Index(center.size()) - 1, 0, 0);
                Empty(center, progress);
            }
    }

    const Graph &graph;
    const std::vector<Index> &tag;
    std::unique_ptr<State[]> state;
    std::vector<std::vector<Offered>> bucket;
    float inverseStep = 1;
    std::size_t last = 0;
    Index assigned = 0;
};

} // namespace vcg::fcd::detail

#endif
