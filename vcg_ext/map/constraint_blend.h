// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CONSTRAINT_BLEND_H
#define VCG_FCD_CONSTRAINT_BLEND_H

#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/shape_constants.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace vcg::fcd {

/// At the free nodes of the surface near held regions: the weights by which the blend of the graph's motions passes
/// over into the motions of these regions.
class ConstraintBlend {
  public:
    /// The most regions of a node: the nearest ones. If there are more (each vertex may be a handle), shares fall to 0
    /// at the distance of the next region, so that they change continuously.
    static constexpr std::size_t most = 8;

    /// A held region near a free node.
    struct Held {
        Index index;    ///< in heldTag
        float distance; ///< to the region's border over the width of the blend, (0, 1)
        float share; ///< weight of its motion, where the graph's has 1; grows from 0 without bound towards the region
        Eigen::Vector3f away; ///< from its border, at right angles to it, distance * fade long; 0 for small parts
    };

    /// \param tag tag of each surface node: 0 fixed, 1 free, else handle
    /// \param fade greatest width along the surface, units of the positions
    ConstraintBlend(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                    const DeformationGraph &graph, double fade, const Progress &progress, const ShapeConstants &shape)
        : surface(surface), tag(tag), patches(patches), graph(graph), shape(shape) {
        FindHeldNearby(fade, progress.Slice(0, 0.9));
        FindAway(fade, progress.Slice(0.9, 1));
    }

    std::vector<Index> heldTag;     ///< the tags of the held regions that have a free neighbour, ascending
    std::vector<std::size_t> begin; ///< n + 1 offsets into held, of the nodes of the surface
    std::vector<Held> held;

  private:
    struct Border {
        Index tag, node;
    };
    struct BorderDistance {
        Index node, held;
        float distance;
    };

    /// Falls from 1 at x = 0, with derivative 0, to 0 at x = 1, with two continuous derivatives. It falls early: its
    /// factor grows with x, and so the curvature of the product stays low.
    static double Falloff(double x) {
        const double level = 0.1, y = x * x * (1 + level) / (x + level), y2 = y * y;
        return 1 - y * (15 - y2 * (10 - 3 * y2)) / 8;
    }

    /// Held nodes with a free neighbour, by tag.
    std::vector<Border> FindBorder(const Progress &progress) const {
        std::vector<Border> border =
            CollectInOrder<Border>(progress, stage, surface.Size(), [&](Index u, std::vector<Border> &found) {
                const auto isFree = [&](Index v) { return tag[v] == 1; };
                const Csr::Row beside = surface.adjacency[u];
                if (tag[u] != 1 && std::any_of(beside.begin(), beside.end(), isFree))
                    found.push_back({tag[u], u});
            });
        std::stable_sort(border.begin(), border.end(), [](const Border &a, const Border &b) { return a.tag < b.tag; });
        return border;
    }

    /// Finds the held regions within the blend's width of each free node along the surface, and their distances.
    void FindHeldNearby(double fade, const Progress &progress) {
        const std::vector<Border> border = FindBorder(progress.Slice(0, 0.1));
        std::vector<std::size_t> first; // of each tag in border
        for (std::size_t b = 0; b < border.size(); ++b)
            if (b == 0 || border[b].tag != border[b - 1].tag) {
                heldTag.push_back(border[b].tag);
                first.push_back(b);
            }
        first.push_back(border.size());
        const std::size_t tags = heldTag.size();
        // Each range has its own memory, by node and region. Few regions are divided into ranges. Many are one range,
        // since only the nearest of all are kept.
        const std::size_t ranges = 16, grain = tags <= 4 * ranges ? tags / ranges + 1 : tags;
        std::vector<std::vector<BorderDistance>> found(tags / grain + 1);
        ParallelTasks(progress.Slice(0.1, 0.9), stage, (tags + grain - 1) / grain,
                      [&](std::size_t range, const Progress &spreading) {
                          const std::size_t from = range * grain, to = std::min(tags, from + grain);
                          HeldSpread spread(*this, fade, std::min(to - from, most + 1));
                          for (std::size_t t = from; t < to; ++t)
                              for (std::size_t b = first[t]; b < first[t + 1]; ++b)
                                  spread.Begin(border[b].node, Index(t));
                          found[range] = spread.Go(spreading);
                      });
        ListByNode(found, progress.Slice(0.9, 1));
    }

    /// Finds the free nodes near held regions: hands each region's nearest border node on from neighbour to neighbour.
    class HeldSpread {
      public:
        /// \param room the most regions of a node; the nearest are kept
        HeldSpread(const ConstraintBlend &blend, double fade, std::size_t room)
            : surface(blend.surface), blend(blend), fade(fade), room(room),
              best(std::size_t(surface.Size()) * room, {std::numeric_limits<float>::infinity(), -1}), queue(classes) {}

        /// Begins at a border node of a region. Call before Go.
        void Begin(Index node, Index held) { Spread(node, node, held, 0); }

        /// \return the regions of each node, ascending
        std::vector<BorderDistance> Go(const Progress &progress) {
            for (std::size_t c = 0; c < classes; ++c) {
                for (std::size_t i = 0; i < queue[c].size(); ++i) {
                    if (i % 4096 == 0)
                        progress(double(c) / double(classes), stage);
                    LookAhead(queue[c], i);
                    const Offered o = queue[c][i];
                    const Kept *kept = KeptOf(o.node);
                    while (kept < KeptOf(o.node + 1) && kept->held != o.held)
                        ++kept;
                    if (kept < KeptOf(o.node + 1) && o.distance <= kept->distance)
                        Spread(o.node, o.source, o.held, c);
                }
                queue[c].clear();
            }
            std::vector<BorderDistance> found;
            found.reserve(touched.size());
            for (Index v : touched) {
                Kept *const kept = KeptOf(v), *end = kept;
                while (end < KeptOf(v + 1) && end->held >= 0)
                    ++end;
                std::sort(kept, end, [](const Kept &a, const Kept &b) { return a.held < b.held; });
                for (const Kept *each = kept; each < end; ++each)
                    found.push_back({v, each->held, each->distance});
            }
            return found;
        }

      private:
        struct Kept {
            float distance; // over the blend's width at the border node
            Index held;     // -1: this entry and later ones are unused
            bool operator<(const Kept &o) const {
                return distance != o.distance ? distance < o.distance : held < o.held;
            }
        };
        struct Offered {
            float distance;
            Index node, source, held;
        };
        static constexpr std::size_t classes = 256; // of distance, nearest first; the order within one does not matter

        /// Prefetches what the next offers need: they are far apart in memory.
        void LookAhead(const std::vector<Offered> &offers, std::size_t i) {
            if (i + 16 < offers.size()) {
                Prefetch(&surface.adjacency.begin[offers[i + 16].node]);
                Prefetch(KeptOf(offers[i + 16].node));
            }
            if (i + 8 < offers.size())
                Prefetch(surface.adjacency[offers[i + 8].node].first);
            if (i + 4 < offers.size())
                for (Index v : surface.adjacency[offers[i + 4].node]) {
                    Prefetch(&blend.tag[v]);
                    Prefetch(KeptOf(v));
                    Prefetch(surface.position.col(v).data());
                }
        }
        Kept *KeptOf(Index u) { return best.data() + std::size_t(u) * room; }

        float WidthAt(Index u) const {
            const Patches &all = blend.patches;
            const Index j = all.patchOf[u];
            return all.tag[j] == 1 ? float(std::min(fade, blend.shape.smallBlendWidth * std::max(all.radius[j], 1e-6f)))
                                   : float(fade);
        }

        void Spread(Index from, Index source, Index held, std::size_t current) {
            const float w = WidthAt(source);
            for (Index v : surface.adjacency[from]) {
                if (blend.tag[v] != 1)
                    continue;
                const float d = (surface.position.col(v) - surface.position.col(source)).norm() / w;
                if (d < 1 && Keep(v, {d, held}))
                    queue[std::max(current, std::size_t(classes * d))].push_back({d, v, source, held});
            }
        }

        /// \return whether the offer was kept: the region is nearer than before
        bool Keep(Index v, const Kept &offered) {
            Kept *const kept = KeptOf(v), *const end = KeptOf(v + 1), *to = kept;
            if (kept->held < 0)
                touched.push_back(v);
            while (to < end && to->held >= 0 && to->held != offered.held)
                ++to;
            if (to == end)
                to = std::max_element(kept, end);
            if (to->held >= 0 && !(to->held == offered.held ? offered.distance < to->distance : offered < *to))
                return false;
            *to = offered;
            return true;
        }

        const Graph &surface;
        const ConstraintBlend &blend;
        const double fade;
        const std::size_t room;
        std::vector<Kept> best;
        std::vector<std::vector<Offered>> queue;
        std::vector<Index> touched;
    };

    void ListByNode(const std::vector<std::vector<BorderDistance>> &found, const Progress &progress) {
        std::vector<std::size_t> all(std::size_t(surface.Size()) + 1, 0);
        for (const std::vector<BorderDistance> &some : found)
            for (const BorderDistance &f : some)
                ++all[std::size_t(f.node) + 1];
        std::partial_sum(all.begin(), all.end(), all.begin());
        std::vector<BorderDistance> ofNode(all.back());
        std::vector<std::size_t> end(all.begin(), all.end() - 1);
        for (const std::vector<BorderDistance> &some : found)
            for (const BorderDistance &f : some)
                ofNode[end[std::size_t(f.node)]++] = f;
        begin.assign(1, 0);
        begin.reserve(all.size());
        held.reserve(std::min(all.back(), std::size_t(surface.Size()) * most));
        std::vector<float> distance;
        for (std::size_t u = 0; u + 1 < all.size(); ++u) {
            float limit = 1; // the distance at which shares are 0
            if (all[u + 1] - all[u] > most) {
                distance.clear();
                for (std::size_t i = all[u]; i < all[u + 1]; ++i)
                    distance.push_back(ofNode[i].distance);
                std::nth_element(distance.begin(), distance.begin() + most, distance.end());
                limit = distance[most];
            }
            for (std::size_t i = all[u]; i < all[u + 1]; ++i) {
                if (!(ofNode[i].distance < limit))
                    continue;
                const float away = std::max(1e-4f, ofNode[i].distance),
                            along = std::max(1e-4f, ofNode[i].distance / limit);
                held.push_back({ofNode[i].held, away, along, Eigen::Vector3f::Zero()});
            }
            begin.push_back(held.size());
        }
        ParallelForEach(progress, stage, held.size(), 1 << 14, [&](std::size_t h) {
            const double s = Falloff(double(held[h].share));
            held[h].share = float(s / (1 - s));
        });
    }

    /// Sets Held::away: the direction into the free surface, blended over the held patches nearby, so that it turns
    /// smoothly along the border.
    void FindAway(double fade, const Progress &progress) {
        const Index k = graph.Size();
        std::vector<Index> border;
        Eigen::Matrix3Xf inward = Eigen::Matrix3Xf::Zero(3, k);
        for (Index r = 0; r < k; ++r) {
            if (!graph.IsHeld(r))
                continue;
            for (std::uint32_t e = graph.graph.adjacency.begin[r]; e < graph.graph.adjacency.begin[r + 1]; ++e)
                inward.col(r) -= graph.weight[e] * graph.edge.col(e);
            if (!(inward.col(r).norm() > 0))
                continue;
            inward.col(r).normalize();
            border.push_back(r);
        }
        if (border.empty() || held.empty())
            return;
        const auto tree = TreeOf(graph.graph.position, border);
        const float reach = float(2 * fade);
        std::vector<std::vector<Index>> nearby(k); // of each free patch: held patches in reach of its vertices
        const auto isBefore = [&](Index a, Index b) {
            return patches.tag[a] != patches.tag[b] ? patches.tag[a] < patches.tag[b] : a < b;
        };
        std::vector<Index> inside;
        for (Index j = 0; j < k; ++j) {
            progress(0, stage);
            if (graph.IsHeld(j))
                continue;
            tree->Within(graph.graph.position.col(j), reach + graph.radius[j], inside);
            for (Index i : inside)
                nearby[j].push_back(border[std::size_t(i)]);
            std::sort(nearby[j].begin(), nearby[j].end(), isBefore);
        }
        // Vertices of one patch and tag see the same held patches: they are computed together, in vector registers.
        constexpr std::size_t lanes = 8;
        struct Seen {
            std::uint64_t view; // patch and tag
            Index node;
            std::size_t entry; // of held
            bool operator<(const Seen &o) const { return view != o.view ? view < o.view : entry < o.entry; }
        };
        ParallelFor(progress, stage, surface.Size(), 1 << 12, [&](std::size_t first, std::size_t last) {
            std::vector<Seen> seen;
            for (std::size_t u = first; u < last; ++u)
                for (std::size_t h = begin[u]; h < begin[u + 1]; ++h)
                    seen.push_back(
                        {std::uint64_t(patches.patchOf[u]) << 32 | std::uint32_t(heldTag[held[h].index]), Index(u), h});
            std::sort(seen.begin(), seen.end());
            for (std::size_t a = 0, b; a < seen.size(); a = b) {
                for (b = a + 1; b < std::min(seen.size(), a + lanes) && seen[b].view == seen[a].view;)
                    ++b;
                const auto seenTag = Index(std::uint32_t(seen[a].view));
                float x[3][lanes], sum[3][lanes] = {};
                for (std::size_t l = 0; l < lanes; ++l)
                    for (int d = 0; d < 3; ++d)
                        x[d][l] = surface.position(d, seen[std::min(a + l, b - 1)].node);
                const std::vector<Index> &near = nearby[seen[a].view >> 32];
                auto r = std::lower_bound(near.begin(), near.end(), seenTag,
                                          [&](Index other, Index tag) { return patches.tag[other] < tag; });
                for (; r != near.end() && patches.tag[*r] == seenTag; ++r) {
                    const Eigen::Vector3f center = graph.graph.position.col(*r), in = inward.col(*r);
                    for (std::size_t l = 0; l < lanes; ++l) {
                        const float dx = center[0] - x[0][l], dy = center[1] - x[1][l], dz = center[2] - x[2][l];
                        const float t = 1 - (dx * dx + (dy * dy + dz * dz)) / (reach * reach), w = t > 0 ? t * t : 0;
                        for (int d = 0; d < 3; ++d)
                            sum[d][l] += w * in[d];
                    }
                }
                for (std::size_t l = 0; l < b - a; ++l) {
                    const Eigen::Vector3f all(sum[0][l], sum[1][l], sum[2][l]);
                    if (const auto e = seen[a + l].entry; all.norm() > 0)
                        held[e].away = all * (held[e].distance * float(fade) / all.norm());
                }
            }
        });
    }

    static constexpr const char *stage = "Preparing the mapping";

    const Graph &surface;
    const std::vector<Index> &tag;
    const Patches &patches;
    const DeformationGraph &graph;
    const ShapeConstants shape;
};

} // namespace vcg::fcd

#endif
