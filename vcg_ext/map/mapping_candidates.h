// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_CANDIDATES_H
#define VCG_FCD_MAPPING_CANDIDATES_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/map/mapping_kernel.h>
#include <vcg_ext/map/mapping_weights.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/shape_constants.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <tuple>

namespace vcg::fcd {

/// The nodes that may influence each free patch, and the balls in which their weights fall to 0.
class MappingCandidates {
  public:
    /// \param influence node radius over patch radius, > 1
    MappingCandidates(const Patches &patches, const DeformationGraph &graph, MappingWeights weights, double influence,
                      const Progress &progress, const ShapeConstants &shape)
        : patches(patches), graph(graph), shape(shape) {
        const Index k = graph.Size();
        reach.resize(k);
        for (Index j = 0; j < k; ++j) {
            // A patch of few nodes must overlap its neighbours, too.
            double spacing = 0;
            for (Index i : graph.graph.adjacency[j])
                spacing += (graph.graph.position.col(i) - graph.graph.position.col(j)).norm();
            if (graph.graph.adjacency[j].size())
                spacing /= double(graph.graph.adjacency[j].size());
            const double radius = std::max({double(graph.radius[j]), 0.5 * spacing, 1e-6}); // 1e-6: a lone node
            reach[j] = float(influence * radius);
        }
        FindCandidates(weights, influence, progress);
    }

    Csr nodes;                          ///< of each patch
    std::vector<detail::Ball> ball;     ///< of each candidate
    std::vector<std::uint32_t> partial; ///< of each patch, the first of its candidates with a share below 1
    std::vector<std::vector<detail::Ball>>
        nearby; ///< of each patch, the small balls by which shares are blended at its vertices
    std::vector<std::size_t> sharesBegin; ///< k + 1 offsets into shares
    std::vector<float> shares;            ///< of each partial candidate at each ball of nearby

  private:
    detail::Ball BallOf(Index j, float radius) const {
        const auto center = graph.graph.position.col(j);
        return {{center[0], center[1], center[2]}, 1 / (radius * radius), j};
    }

    struct Candidate {
        Index patch, node;
        bool partial;      ///< some share is less than 1
        std::size_t share; ///< if so, the first of its shares, one for each ball near the patch
    };

    /// The share of its weight that a node has at a detour: 1 half-way round a cylinder, 0 across a fold. \param path
    /// length over the surface \param straight straight distance \param radius of the node's patch; all in
    /// the same units
    float Share(double path, double straight, double radius) const {
        const double detour = path / std::max(straight, shape.nearby * radius);
        const double x = std::min(1.0, std::max(0.0, (detour - shape.detour) / (shape.longDetour - shape.detour)));
        return float(1 - x * x * (3 - 2 * x));
    }

    /// Whether the ball of radius \p reach about node j touches the patch. A ball of radius 0 touches none.
    bool Touches(Index j, float reach, Index patch) const {
        const Eigen::Matrix3Xf &x = graph.graph.position;
        return reach > 0 && (x.col(j) - x.col(patch)).norm() < reach + graph.radius[patch];
    }

    /// Sets all members. A ball that touches very many patches is made smaller, to bound the memory for any graph.
    void FindCandidates(MappingWeights weights, double influence, const Progress &progress) {
        const Index k = graph.Size();
        const std::size_t most = std::max<std::size_t>(64, (1 << 22) / std::size_t(std::max(k, 1))); // patches a ball
        std::vector<Candidate> found;
        std::vector<float> share;
        nearby.resize(k);
        if (weights == MappingWeights::Euclidean)
            FindInBalls(most, found);
        else
            FindAlongSurface(most, influence, progress, found, share);
        std::sort(found.begin(), found.end(), [](const Candidate &a, const Candidate &b) {
            return std::tie(a.patch, a.partial, a.node) < std::tie(b.patch, b.partial, b.node);
        });

        nodes.begin.assign(std::size_t(k) + 1, 0);
        nodes.item.reserve(found.size());
        ball.reserve(found.size());
        std::vector<std::uint32_t> partials(k, 0);
        for (const Candidate &c : found) {
            ++nodes.begin[c.patch + 1];
            partials[c.patch] += c.partial;
            nodes.item.push_back(c.node);
            ball.push_back(BallOf(c.node, reach[c.node]));
        }
        sharesBegin.assign(1, 0);
        for (Index j = 0; j < k; ++j) {
            nodes.begin[j + 1] += nodes.begin[j];
            partial.push_back(nodes.begin[j + 1] - partials[j]);
            sharesBegin.push_back(sharesBegin.back() + std::size_t(partials[j]) * nearby[j].size());
        }
        shares.reserve(sharesBegin.back());
        for (const Candidate &c : found)
            if (c.partial)
                shares.insert(shares.end(), share.begin() + std::ptrdiff_t(c.share),
                              share.begin() + std::ptrdiff_t(c.share + nearby[c.patch].size()));
    }

    void FindInBalls(std::size_t most, std::vector<Candidate> &found) {
        const Index k = graph.Size();
        if (std::size_t(k) > most)
            LimitReach(most);
        // Patches of similar radius at a time, so that a few large ones do not widen the search for all.
        std::map<int, std::vector<Index>> bySize;
        for (Index patch = 0; patch < k; ++patch)
            if (patches.tag[patch] == 1)
                bySize[std::ilogb(std::max(graph.radius[patch], 1e-6f))].push_back(patch);
        std::vector<Index> inside;
        for (const auto &size : bySize) {
            const auto tree = TreeOf(graph.graph.position, size.second);
            const float widest = std::ldexp(2.f, size.first);
            for (Index j = 0; j < k; ++j) {
                tree->Within(graph.graph.position.col(j), 1.001f * (reach[j] + widest), inside);
                for (Index i : inside)
                    if (Touches(j, reach[j], size.second[std::size_t(i)]))
                        found.push_back({size.second[std::size_t(i)], j, false, 0});
            }
        }
    }

    /// The patches that a node reaches over neighbouring patches, all free (or of the node's tag) and touched by its
    /// ball, and the lengths of the shortest paths from centre to centre (Dijkstra).
    class Chains {
      public:
        explicit Chains(const MappingCandidates &mapping) : mapping(mapping), cost(mapping.graph.Size(), unreached) {}

        /// Finds the patches of node j. \p reach is halved until there are at most \p most of them, none but j's with
        /// more than \p most neighbours; 0 if no ball is small enough.
        void Find(Index j, float &reach, std::size_t most) {
            if (FindInside(j, reach, most))
                return;
            reach = LargestReach(j, reach, most);
            FindInside(j, reach, most);
        }

        const std::vector<Index> &Patches() const { return patch; }
        /// Length of the path; infinite if there is none.
        float PathTo(Index there) const { return cost[there]; }

      private:
        using Step = std::pair<float, Index>;

        /// \return false if there are more than \p most, or a hub
        bool FindInside(Index j, float reach, std::size_t most) {
            const Eigen::Matrix3Xf &x = mapping.graph.graph.position;
            Start(j);
            while (!heap.empty()) {
                const Step step = Nearest();
                if (step.first > cost[step.second])
                    continue;
                if (IsHub(step.second, j, most))
                    return false;
                for (Index next : mapping.graph.graph.adjacency[step.second])
                    if (IsOpen(next, j) && (cost[next] < unreached || mapping.Touches(j, reach, next))) {
                        Offer(next, step.first + (x.col(step.second) - x.col(next)).norm());
                        if (patch.size() > most)
                            return false;
                    }
            }
            return true;
        }

        /// The largest half, quarter ... of \p reach that is small enough for Find; \p reach is not. Visits patches in
        /// the order in which a growing ball takes them in, which bounds their number.
        float LargestReach(Index j, float reach, std::size_t most) {
            Start(j);
            for (std::size_t inside = 0; !heap.empty();) {
                const Step step = Nearest();
                if (step.first > cost[step.second])
                    continue;
                if (++inside > most || IsHub(step.second, j, most))
                    return Half(step.first);
                for (Index next : mapping.graph.graph.adjacency[step.second])
                    if (step.first < cost[next] && IsOpen(next, j) && mapping.Touches(j, reach, next)) {
                        float least = reach;
                        while (mapping.Touches(j, Half(least), next))
                            least = Half(least);
                        Offer(next, std::max(step.first, least));
                    }
            }
            return reach;
        }

        static float Half(float reach) { return reach > 1e-6f ? 0.5f * reach : 0; }

        /// Whether chains of node j may pass through the patch.
        bool IsOpen(Index there, Index j) const {
            return mapping.patches.tag[there] == 1 || mapping.patches.tag[there] == mapping.patches.tag[j];
        }
        /// Whether the patch has very many neighbours, like the middle of a star: all would be visited from each.
        bool IsHub(Index there, Index j, std::size_t most) const {
            return there != j && mapping.graph.graph.adjacency[there].size() > most;
        }

        void Start(Index j) {
            for (Index there : patch)
                cost[there] = unreached;
            patch.clear();
            heap.clear();
            Offer(j, 0);
        }
        void Offer(Index there, float length) {
            if (length >= cost[there])
                return;
            if (cost[there] == unreached)
                patch.push_back(there);
            cost[there] = length;
            heap.emplace_back(length, there);
            std::push_heap(heap.begin(), heap.end(), std::greater<Step>());
        }
        Step Nearest() {
            std::pop_heap(heap.begin(), heap.end(), std::greater<Step>());
            const Step step = heap.back();
            heap.pop_back();
            return step;
        }

        static constexpr float unreached = std::numeric_limits<float>::infinity();
        const MappingCandidates &mapping;
        std::vector<Index> patch;
        std::vector<float> cost; ///< length of the path; in LargestReach, the least reach with the patch
        std::vector<Step> heap;
    };

    /// If two neighbouring vertices lie in a node's ball, their patches are both on a chain, or neither is. So the set
    /// of nodes changes only where weights are 0. Shares are computed at the patches' centres. At the vertices, they
    /// are blended by small balls, along the surface down to the size of a patch.
    void FindAlongSurface(std::size_t most, double influence, const Progress &progress, std::vector<Candidate> &found,
                          std::vector<float> &share) {
        const Index k = graph.Size();
        const Eigen::Matrix3Xf &x = graph.graph.position;
        const std::size_t grain = std::size_t(k) / 32 + 1;
        std::vector<std::vector<std::pair<Index, detail::Ball>>> small(k / grain + 1);
        ParallelFor(progress.Slice(0, 0.3), "Preparing the mapping", k, grain,
                    [&](std::size_t first, std::size_t last) {
                        Chains chains(*this);
                        for (Index j = Index(first); j < Index(last); ++j) {
                            if (patches.tag[j] != 1)
                                continue;
                            float radius = reach[j] * float(std::min(1.0, shape.shareBall / influence));
                            chains.Find(j, radius, most);
                            for (Index patch : chains.Patches())
                                small[first / grain].emplace_back(patch, BallOf(j, radius));
                        }
                    });
        for (const auto &part : small)
            for (const auto &each : part)
                nearby[each.first].push_back(each.second);
        for (std::vector<detail::Ball> &balls : nearby)
            if (balls.size() > mostNearby) // the middle of a star: candidates have no shares there
                balls.clear();

        struct Part {
            std::vector<Candidate> found;
            std::vector<float> share;
        };
        std::vector<Part> parts(k / grain + 1);
        ParallelFor(
            progress.Slice(0.3, 1), "Preparing the mapping", k, grain, [&](std::size_t first, std::size_t last) {
                Chains chains(*this);
                Part part;
                for (Index j = Index(first); j < Index(last); ++j) {
                    chains.Find(j, reach[j], most);
                    for (Index patch : chains.Patches()) {
                        if (patches.tag[patch] != 1)
                            continue;
                        float least = 1, greatest = 0;
                        const std::size_t begin = part.share.size();
                        for (const detail::Ball &near : nearby[patch]) {
                            const float path = chains.PathTo(near.node);
                            // Outside of the ball of j, its weight is 0: shares there do not matter.
                            const bool all = near.node == j || (std::isinf(path) && !Touches(j, reach[j], near.node));
                            part.share.push_back(
                                all ? 1 : Share(path, (x.col(j) - x.col(near.node)).norm(), reach[j] / influence));
                            least = std::min(least, part.share.back());
                            greatest = std::max(greatest, part.share.back());
                        }
                        if (greatest > 0 || nearby[patch].empty())
                            part.found.push_back({patch, j, least < 1, begin});
                        if (greatest == 0 || least == 1)
                            part.share.resize(begin);
                    }
                }
                parts[first / grain] = std::move(part);
            });
        std::size_t before = 0; // number of shares of earlier parts
        for (Part &part : parts) {
            for (Candidate &c : part.found)
                c.share += before;
            before += part.share.size();
        }
        found = Together(parts, &Part::found);
        share = Together(parts, &Part::share);
    }

    /// Limits the ball of each node to at most \p most other nodes.
    void LimitReach(std::size_t most) {
        const PointTree<float> tree(graph.graph.position);
        for (Index j = 0; j < graph.Size(); ++j)
            for (std::size_t wanted : {std::size_t(64), most}) { // 64 tell of most nodes that they need no limit
                const float d = tree.DistanceOf(graph.graph.position.col(j), wanted + 1);
                if (d >= reach[j])
                    break;
                if (wanted == most)
                    reach[j] = std::max(d, 1e-6f);
            }
    }

    const Patches &patches;
    const DeformationGraph &graph;
    const ShapeConstants shape;
    static constexpr std::size_t mostNearby = 64; ///< small balls near a patch
    std::vector<float> reach;                     ///< of each node's ball
};

} // namespace vcg::fcd

#endif
