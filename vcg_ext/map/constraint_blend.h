// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CONSTRAINT_BLEND_H
#define VCG_FCD_CONSTRAINT_BLEND_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/shape_constants.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace vcg {
namespace fcd {

/// Where the blend of the nodes' motions runs over into the motions of held regions: the free nodes of the surface near
/// them.
class ConstraintBlend {
  public:
    /// A held region near a free node.
    struct Held {
        Index index;          ///< in heldTag
        float distance;       ///< to the region over the fade's width, (0, 1)
        float share;          ///< of its motion, where the nodes' have 1; from 0 beyond all bounds towards the region
        Eigen::Vector3f away; ///< from its border, at right angles, as far as that; 0 for small parts
    };

    /// \param tag tag of each surface node: 0 fixed, 1 free, else handle
    /// \param fade greatest width along the surface, units of the positions
    ConstraintBlend(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                    const DeformationGraph &graph, double fade, const Progress &progress, const ShapeConstants &shape)
        : surface(surface), tag(tag), patches(patches), graph(graph), shape(shape) {
        FindHeldNearby(fade, progress.Slice(0, 0.9));
        FindWaysAway(fade, progress.Slice(0.9, 1));
    }

    std::vector<Index> heldTag;       ///< the tags of the held regions that have a free neighbour, ascending
    std::vector<std::uint32_t> begin; ///< n + 1 offsets into held, of the nodes of the surface
    std::vector<Held> held;

  private:
    struct Border {
        Index tag, node;
    };
    struct Found {
        Index node;
        Held held;
    };

    /// From 1 at x = 0, where it is level, to 0 at x = 1 with two continuous derivatives. It leaves 1 soon: what it
    /// multiplies grows with x, and this shape keeps the curvature of the product low.
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

    /// For each free node the held regions within the fade's width along the surface, and how far they are.
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
        std::vector<std::vector<Found>> found(tags);
        // Each range has room for distances of its own: a number for each node, in so many ranges at most.
        const std::size_t ranges = 16;
        ParallelFor(progress.Slice(0.1, 1), stage, tags, tags / ranges + 1, [&](std::size_t from, std::size_t to) {
            HeldSpread spread(*this, fade);
            for (std::size_t t = from; t < to; ++t)
                found[t] = spread.From(&border[first[t]], &border[first[t]] + (first[t + 1] - first[t]), Index(t));
        });
        ListByNode(found);
    }

    /// Finds the free nodes near held regions, one region after the other: the distance to the nearest border node of
    /// the region, handed on from neighbour to neighbour.
    class HeldSpread {
      public:
        HeldSpread(const ConstraintBlend &blend, double fade)
            : surface(blend.surface), blend(blend), fade(fade),
              best(std::size_t(surface.Size()), std::numeric_limits<float>::infinity()), queue(classes) {}

        std::vector<Found> From(const Border *border, const Border *end, Index held) {
            for (; border != end; ++border)
                Spread(border->node, border->node, 0);
            for (std::size_t c = 0; c < classes; ++c) {
                for (std::size_t i = 0; i < queue[c].size(); ++i)
                    if (const Offered o = queue[c][i]; o.distance <= best[o.node])
                        Spread(o.node, o.source, c);
                queue[c].clear();
            }
            std::vector<Found> found;
            found.reserve(touched.size());
            for (Index v : touched) {
                const float distance = std::max(1e-4f, best[v]);
                const double s = Falloff(distance);
                found.push_back({v, {held, distance, float(s / (1 - s)), Eigen::Vector3f::Zero()}});
                best[v] = std::numeric_limits<float>::infinity();
            }
            touched.clear();
            return found;
        }

      private:
        struct Offered {
            float distance; // over the width at the source
            Index node, source;
        };
        static constexpr std::size_t classes =
            256; // of distance; a node may be visited again when a nearer source turns up

        float WidthAt(Index u) const {
            const Patches &all = blend.patches;
            const Index j = all.patchOf[u];
            return all.tag[j] == 1 ? float(std::min(fade, blend.shape.smallBlendWidth * std::max(all.radius[j], 1e-6f)))
                                   : float(fade);
        }

        void Spread(Index from, Index source, std::size_t current) {
            const float w = WidthAt(source);
            for (Index v : surface.adjacency[from]) {
                if (blend.tag[v] != 1)
                    continue;
                const float d = (surface.position.col(v) - surface.position.col(source)).norm() / w;
                if (d < best[v] && d < 1) {
                    if (std::isinf(best[v]))
                        touched.push_back(v);
                    best[v] = d;
                    queue[std::max(current, std::size_t(classes * d))].push_back({d, v, source});
                }
            }
        }

        const Graph &surface;
        const ConstraintBlend &blend;
        const double fade;
        std::vector<float> best;
        std::vector<std::vector<Offered>> queue;
        std::vector<Index> touched;
    };

    void ListByNode(const std::vector<std::vector<Found>> &found) {
        begin.assign(std::size_t(surface.Size()) + 1, 0);
        std::size_t count = 0;
        for (const std::vector<Found> &ofTag : found)
            for (const Found &f : ofTag) {
                ++begin[f.node + 1];
                ++count;
            }
        for (Index u = 0; u < surface.Size(); ++u)
            begin[u + 1] += begin[u];
        held.resize(count);
        std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
        for (const std::vector<Found> &ofTag : found)
            for (const Found &f : ofTag)
                held[end[f.node]++] = f.held;
    }

    /// The way from the border for each entry of held: straight into the free surface, as the held patches nearby see
    /// it, blended so that it turns smoothly along the border.
    void FindWaysAway(double fade, const Progress &progress) {
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
        std::vector<std::vector<Index>> nearby(
            k); // of each free patch: the nodes of held patches that its vertices may see
        std::vector<Index> inside;
        for (Index j = 0; j < k; ++j) {
            if (graph.IsHeld(j))
                continue;
            tree->Within(graph.graph.position.col(j), reach + graph.radius[j], inside);
            for (Index i : inside)
                nearby[j].push_back(border[std::size_t(i)]);
            std::sort(nearby[j].begin(), nearby[j].end());
        }
        ParallelFor(progress, stage, surface.Size(), 1 << 12, [&](std::size_t first, std::size_t last) {
            for (std::size_t u = first; u < last; ++u)
                for (std::uint32_t h = begin[u]; h < begin[u + 1]; ++h) {
                    const Eigen::Vector3f x = surface.position.col(Eigen::Index(u));
                    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
                    for (Index r : nearby[patches.patchOf[u]]) {
                        const float t = 1 - (graph.graph.position.col(r) - x).squaredNorm() / (reach * reach);
                        if (t > 0 && patches.tag[r] == heldTag[held[h].index])
                            sum += t * t * inward.col(r);
                    }
                    const float length = sum.norm();
                    if (length > 0)
                        held[h].away = sum * (held[h].distance * float(fade) / length);
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

} // namespace fcd
} // namespace vcg

#endif
